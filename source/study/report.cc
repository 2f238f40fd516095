// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/study/plot.h>
#include <axiforge/study/report.h>

namespace axiforge::study
{
  namespace
  {
    using Table = std::vector<std::vector<std::string>>; // the first row has the names


    std::string cell(const double value, const char *format)
    {
      return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
    }


    Table run_table(const Plan &plan, const std::vector<Run> &runs, const std::vector<Item> &items)
    {
      Table table = { { "run", plan.entry, "cells", "unknowns", "steps", "iterations", "wall s",
                        "CPU s" } };
      for (const Item &item : items)
        table[0].push_back(item.name);
      for (unsigned int i = 0; i < runs.size(); ++i)
        {
          const Run &run = runs[i];
          table.push_back({ fmt::format("{}", i + 1), run.variation.label,
                            fmt::format("{}", run.cells), fmt::format("{}", run.unknowns),
                            fmt::format("{}", run.steps), fmt::format("{}", run.iterations),
                            fmt::format("{:.2f}", run.wall), fmt::format("{:.2f}", run.cpu) });
          for (const Item &item : items)
            table.back().push_back(run.failure.empty() || std::isfinite(item.value[i])
                                       ? cell(item.value[i], "{:.8g}")
                                       : "failed");
        }
      return table;
    }


    Table item_table(const Plan &plan, const std::vector<Run> &runs, const Item &item)
    {
      const bool curves = plan.at == Place::whole_curve;
      const bool errors = curves || std::isfinite(item.reference);
      Table      table  = { { plan.entry, curves ? "rms from the last run" : "value" } };
      if (!curves)
        table[0].push_back("difference");
      if (plan.ratio > 0)
        table[0].insert(table[0].end(), { "order", "limit", "estimated error" });
      if (errors)
        table[0].push_back(curves ? "relative" : "error");
      if (errors && !curves && plan.ratio > 0)
        table[0].push_back("order of error");
      for (unsigned int i = 0; i < runs.size(); ++i)
        {
          std::vector<std::string> row = { runs[i].variation.label, cell(item.value[i], "{:.8g}") };
          if (!curves)
            row.push_back(cell(item.difference[i], "{:.4g}"));
          if (plan.ratio > 0)
            row.insert(row.end(), { cell(item.convergence[i].order, "{:.2f}"),
                                    cell(item.convergence[i].limit, "{:.8g}"),
                                    cell(item.convergence[i].error, "{:.3g}") });
          if (errors)
            row.push_back(cell(item.error[i], "{:.3g}"));
          if (errors && !curves && plan.ratio > 0)
            row.push_back(cell(item.error_order[i], "{:.2f}"));
          table.push_back(row);
        }
      return table;
    }


    std::string as_text(const Table &table)
    {
      std::vector<std::size_t> width(table[0].size());
      for (const auto &row : table)
        for (unsigned int c = 0; c < row.size(); ++c)
          width[c] = std::max(width[c], row[c].size());
      std::string text;
      for (const auto &row : table)
        {
          for (unsigned int c = 0; c < row.size(); ++c)
            text += fmt::format("{}{:>{}}", c ? "  " : "", row[c], width[c]);
          text += "\n";
        }
      return text;
    }


    std::string as_markdown(const Table &table)
    {
      const auto line = [](const std::vector<std::string> &row) {
        std::string text = "|";
        for (std::string field : row)
          {
            for (std::size_t i = field.find('|'); i != std::string::npos;
                 i             = field.find('|', i + 2))
              field.insert(i, "\\"); // the values of several entries have bars
            text += " " + field + " |";
          }
        return text + "\n";
      };
      std::string text = line(table[0]) + "|";
      for (std::size_t c = 0; c < table[0].size(); ++c)
        text += "--:|";
      text += "\n";
      for (std::size_t r = 1; r < table.size(); ++r)
        text += line(table[r]);
      return text;
    }


    std::string failures(const std::vector<Run> &runs)
    {
      std::string text;
      for (unsigned int i = 0; i < runs.size(); ++i)
        if (!runs[i].failure.empty())
          text += fmt::format("Run {} ({}) failed: {}\n", i + 1, runs[i].variation.label,
                              runs[i].failure);
      return text;
    }


    /// All positive and far enough apart.
    bool suits_logarithm(const std::vector<double> &values)
    {
      const auto [low, high] = std::minmax_element(values.begin(), values.end());
      return !values.empty() && *low > 0 && *high >= 6 * *low;
    }


    Panel error_panel(const std::string         &title,
                      const std::string         &x_label,
                      const std::vector<double> &x,
                      const std::vector<Item>   &items)
    {
      Panel panel;
      panel.title   = title;
      panel.x_label = x_label;
      panel.y_label = "magnitude of the relative error";
      panel.log_x = panel.log_y = true;
      for (const Item &item : items)
        if (std::isfinite(item.reference))
          {
            Series series;
            series.label = item.name;
            for (std::size_t i = 0; i < x.size(); ++i)
              series.points.emplace_back(x[i], std::abs(item.error[i]));
            panel.series.push_back(series);
          }
      return panel;
    }
  } // namespace


  std::string verdict(const Plan &plan, const Item &item)
  {
    if (plan.ratio == 0)
      return "";
    if (item.value.size() < 3)
      return item.name + ": three values are needed for an order.";
    const Richardson &last = item.convergence.back();
    if (!last.remark.empty())
      return item.name + ": no order can be given: " + last.remark + ".";
    if (plan.at == Place::whole_curve)
      return fmt::format("{}: observed order {:.2f}, estimated error of the last curve {:.3g} rms.",
                         item.name, last.order, last.error);
    const double share = 100 * last.error / std::abs(last.limit);
    return fmt::format("{}: observed order {:.2f}, extrapolated limit {:.8g}, estimated error of "
                       "the last value {:.3g}{}.",
                       item.name, last.order, last.limit, last.error,
                       share < 100 ? fmt::format(" ({:.2g} %)", share) : "");
  }


  std::string
  text_report(const Plan &plan, const std::vector<Run> &runs, const std::vector<Item> &items)
  {
    std::string text = "\n" + as_text(run_table(plan, runs, items));
    for (const Item &item : items)
      {
        text += "\n" + item.name + "\n" + as_text(item_table(plan, runs, item));
        const std::string line = verdict(plan, item);
        text += line.empty() ? "" : line + "\n";
      }
    const std::string failed = failures(runs);
    return failed.empty() ? text : text + "\n" + failed;
  }


  std::string markdown_report(const std::string       &title,
                              const Plan              &plan,
                              const std::vector<Run>  &runs,
                              const std::vector<Item> &items)
  {
    std::string text = "# Study: " + title + "\n\n" + as_markdown(run_table(plan, runs, items));
    for (const Item &item : items)
      {
        text += "\n## " + item.name + "\n\n" + as_markdown(item_table(plan, runs, item));
        const std::string line = verdict(plan, item);
        text += line.empty() ? "" : "\n" + line + "\n";
      }
    const std::string failed = failures(runs);
    if (!failed.empty())
      text += "\n## Runs that failed\n\n" + failed;
    return text + "\n![Plot](study.svg)\n\nWall and CPU seconds are of the whole run, mesh and "
                  "files included; CPU of all ranks together.\n";
  }


  std::vector<std::string> csv_columns(const std::vector<Item> &items)
  {
    std::vector<std::string> columns = { "run",   "value",      "cells",  "unknowns",
                                         "steps", "iterations", "wall_s", "cpu_s" };
    for (const Item &item : items)
      for (const char *suffix :
           { "", "_difference", "_order", "_limit", "_estimated_error", "_error", "_error_order" })
        columns.push_back(item.name + suffix);
    columns.push_back("failure");
    return columns;
  }


  std::vector<std::string>
  csv_row(const unsigned int number, const Run &run, const std::vector<Item> &items)
  {
    const unsigned int       i   = number - 1;
    std::vector<std::string> row = {
      fmt::format("{}", number),    run.variation.label,
      fmt::format("{}", run.cells), fmt::format("{}", run.unknowns),
      fmt::format("{}", run.steps), fmt::format("{}", run.iterations),
      csv_number(run.wall),         csv_number(run.cpu)
    };
    for (const Item &item : items)
      for (const double number : { item.value[i], item.difference[i], item.convergence[i].order,
                                   item.convergence[i].limit, item.convergence[i].error,
                                   item.error[i], item.error_order[i] })
        row.push_back(csv_number(number));
    row.push_back(run.failure);
    return row;
  }


  std::string plot(const std::string       &title,
                   const Plan              &plan,
                   const std::vector<Run>  &runs,
                   const std::vector<Item> &items)
  {
    std::vector<double> values, unknowns, steps, cpu;
    bool                numbers = true;
    for (const Run &run : runs)
      {
        numbers = numbers && std::isfinite(run.variation.number);
        values.push_back(run.variation.number);
        unknowns.push_back(run.unknowns);
        steps.push_back(run.steps);
        cpu.push_back(run.cpu);
      }
    if (!numbers)
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = i + 1;

    std::vector<Panel> panels;
    for (const Item &item : items)
      {
        Panel panel;
        panel.title   = item.name;
        panel.x_label = numbers ? plan.entry : "run";
        panel.y_label = item.name;
        panel.log_x   = suits_logarithm(values);
        panel.log_y   = plan.at == Place::whole_curve;
        Series series;
        series.label = item.name;
        for (std::size_t i = 0; i < values.size(); ++i)
          series.points.emplace_back(values[i], item.value[i]);
        panel.series.push_back(series);
        const auto [low, high] = std::minmax_element(values.begin(), values.end());
        const auto add_level   = [&](const std::string &label, const double level) {
          if (std::isfinite(level))
            panel.series.push_back({ label, { { *low, level }, { *high, level } }, true });
        };
        add_level("extrapolated limit", item.convergence.back().limit);
        add_level("reference", item.reference);
        panels.push_back(panel);
      }
    if (std::any_of(items.begin(), items.end(),
                    [](const Item &item) { return std::isfinite(item.reference); }))
      {
        const bool one_mesh = std::all_of(unknowns.begin(), unknowns.end(),
                                          [&](const double n) { return n == unknowns.front(); });
        panels.push_back(one_mesh
                             ? error_panel("Error against steps", "steps", steps, items)
                             : error_panel("Error against unknowns", "unknowns", unknowns, items));
        panels.push_back(error_panel("Error against CPU time", "CPU time [s]", cpu, items));
      }
    return svg(title, panels);
  }
} // namespace axiforge::study
