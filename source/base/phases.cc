// SPDX-License-Identifier: GPL-2.0-or-later
#include <chrono>
#include <cstring>
#include <ctime>
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

    /// CPU time is that of the whole process: threads of libraries count.
    Seconds now()
    {
      timespec cpu;
      clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
      const auto wall = std::chrono::steady_clock::now().time_since_epoch();
      return { std::chrono::duration<double>(wall).count(), cpu.tv_sec + 1e-9 * cpu.tv_nsec };
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


    void add_rows(const std::size_t n, const unsigned int depth, std::string &text)
    {
      const Node &node = nodes[n];
      Seconds     own  = node.sum;
      for (const std::size_t i : node.inside)
        own.wall -= nodes[i].sum.wall;
      text += fmt::format("| {:<38} | {:>8} | {:>9.3f} | {:>9.3f} | {:>5.1f} % | {:>9.3f} |\n",
                          std::string(2 * depth, ' ') + node.name, node.calls, node.sum.wall,
                          node.sum.cpu, 100 * node.sum.wall / nodes[0].sum.wall, own.wall);
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
    nodes[child].begun = now();
    ++nodes[child].calls;
  }


  void Phase::leave()
  {
    const Seconds end  = now();
    Node         &node = nodes[present];
    node.sum.wall += end.wall - node.begun.wall;
    node.sum.cpu += end.cpu - node.begun.cpu;
    present = node.parent;
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
    return text;
  }
} // namespace axiforge
