// SPDX-License-Identifier: GPL-2.0-or-later
#include <chrono>
#include <cstring>
#include <ctime>
#include <list>
#include <mutex>
#include <vector>

#include <fmt/format.h>

#include <axiforge/base/phases.h>

namespace axiforge
{
  namespace
  {
    struct Seconds
    {
      double wall = 0, cpu = 0;
    };

    /// Of the process: threads of libraries count.
    Seconds now(const clockid_t clock = CLOCK_PROCESS_CPUTIME_ID)
    {
      timespec cpu;
      clock_gettime(clock, &cpu);
      const auto wall = std::chrono::steady_clock::now().time_since_epoch();
      return { std::chrono::duration<double>(wall).count(), cpu.tv_sec + 1e-9 * cpu.tv_nsec };
    }
  } // namespace


  struct Phase::Beside::Row
  {
    const char   *name;
    Seconds       sum, begun;
    unsigned long calls;
    clockid_t     clock;
  };


  namespace
  {
    // What ran and runs beside the program: both threads read and write it.
    std::mutex                    beside;
    std::list<Phase::Beside::Row> rows;
    Phase::Beside::Row           *running = nullptr;


    /// Without what runs beside.
    Seconds now_here()
    {
      const std::lock_guard<std::mutex> lock(beside);
      Seconds                           seconds = now();
      for (const Phase::Beside::Row &row : rows)
        seconds.cpu -= row.sum.cpu;
      if (running)
        seconds.cpu -= now(running->clock).cpu - running->begun.cpu;
      return seconds;
    }

    /// The phases are few and change seldom: a tree of indices, searched by name.
    struct Node
    {
      const char              *name;
      std::size_t              parent;
      std::vector<std::size_t> inside;
      Seconds                  sum, begun;
      unsigned long            calls;
    };

    std::vector<Node> nodes; ///< the first is the whole run
    std::size_t       present = 0;


    std::string table_row(const std::string  &name,
                          const unsigned long calls,
                          const Seconds      &seconds,
                          const double        own)
    {
      return fmt::format("| {:<38} | {:>8} | {:>9.3f} | {:>9.3f} | {:>5.1f} % | {:>9.3f} |\n", name,
                         calls, seconds.wall, seconds.cpu, 100 * seconds.wall / nodes[0].sum.wall,
                         own);
    }


    void add_rows(const std::size_t n, const unsigned int depth, std::string &text)
    {
      const Node &node = nodes[n];
      Seconds     own  = node.sum;
      for (const std::size_t i : node.inside)
        own.wall -= nodes[i].sum.wall;
      text += table_row(std::string(2 * depth, ' ') + node.name, node.calls, node.sum, own.wall);
      for (const std::size_t i : node.inside)
        add_rows(i, depth + 1, text);
    }
  } // namespace

  bool Phase::measured = false;


  void Phase::measure_phases()
  {
    measured = true;
    present  = 0;
    nodes    = { Node{ "whole run", 0, {}, {}, now(), 1 } };
  }


  void Phase::enter(const char *name)
  {
    std::size_t child = 0;
    for (const std::size_t i : nodes[present].inside)
      if (std::strcmp(nodes[i].name, name) == 0)
        child = i;
    if (child == 0)
      {
        child = nodes.size();
        nodes.push_back({ name, present, {}, {}, {}, 0 });
        nodes[present].inside.push_back(child);
      }
    present            = child;
    nodes[child].begun = now_here();
    ++nodes[child].calls;
  }


  void Phase::leave()
  {
    const Seconds end  = now_here();
    Node         &node = nodes[present];
    node.sum.wall += end.wall - node.begun.wall;
    node.sum.cpu += end.cpu - node.begun.cpu;
    present = node.parent;
  }


  Phase::Beside::Beside(const char *name)
  {
    if (!measured)
      return;
    const std::lock_guard<std::mutex> lock(beside);
    for (Row &known : rows)
      if (std::strcmp(known.name, name) == 0)
        row = &known;
    if (!row)
      row = &rows.emplace_back(Row{ name, {}, {}, 0, {} });
    pthread_getcpuclockid(pthread_self(), &row->clock);
    row->begun = now(row->clock);
    ++row->calls;
    running = row;
  }


  Phase::Beside::~Beside()
  {
    if (!row)
      return;
    const std::lock_guard<std::mutex> lock(beside);
    const Seconds                     end = now(row->clock);
    row->sum.wall += end.wall - row->begun.wall;
    row->sum.cpu += end.cpu - row->begun.cpu;
    running = nullptr;
  }


  std::string Phase::table()
  {
    if (!measured)
      return "";
    const Seconds end = now();
    nodes[0].sum      = { end.wall - nodes[0].begun.wall, end.cpu - nodes[0].begun.cpu };
    std::string text  = fmt::format("| {:<38} | {:>8} | {:>9} | {:>9} | {:>7} | {:>9} |\n", "phase",
                                    "calls", "wall [s]", "CPU [s]", "share", "own [s]");
    text += fmt::format("|:{:-<38}-|-{:->8}:|-{:->9}:|-{:->9}:|-{:->7}:|-{:->9}:|\n", "", "", "",
                        "", "", "");
    add_rows(0, 0, text);
    const std::lock_guard<std::mutex> lock(beside);
    for (const Beside::Row &row : rows)
      text += table_row(std::string("beside: ") + row.name, row.calls, row.sum, row.sum.wall);
    return text;
  }
} // namespace axiforge
