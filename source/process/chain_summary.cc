// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include <fmt/format.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/process/chain_summary.h>

namespace axiforge::process
{
  namespace
  {
    using Texts = std::vector<std::string>;

    const Texts table_head = { "operation",   "ended by",    "steps",      "time [s]",
                               "stroke [mm]", "height [mm]", "fill",       "end force [kN]",
                               "max [kN]",    "work [kJ]",   "imbalance",  "volume change",
                               "max strain",  "cells",       "remeshings", "wall [s]" };


    Texts table_row(const OperationSummary &o)
    {
      return { o.name,
               o.ended_by,
               fmt::format("{}", o.steps),
               fmt::format("{:.4g}", o.time),
               fmt::format("{:.5g}", o.stroke),
               fmt::format("{:.5g}", o.height),
               o.fill > 0 ? fmt::format("{:.4f}", o.fill) : "",
               fmt::format("{:.5g}", 1e-3 * o.force),
               fmt::format("{:.5g}", 1e-3 * o.largest_force),
               fmt::format("{:.4g}", 1e-6 * o.work),
               fmt::format("{:.1e}", o.imbalance),
               fmt::format("{:+.1e}", o.volume_change),
               fmt::format("{:.3g}", o.largest_strain),
               fmt::format("{}", o.cells),
               fmt::format("{}", o.remeshings),
               fmt::format("{:.1f}", o.wall_seconds) };
    }


    const Texts csv_head = { "operation",
                             "ended_by",
                             "start_s",
                             "end_s",
                             "steps",
                             "stroke_mm",
                             "height_mm",
                             "fill",
                             "end_force_N",
                             "largest_force_N",
                             "work_mJ",
                             "force_imbalance",
                             "relative_volume_change",
                             "largest_strain",
                             "largest_radius_mm",
                             "cells",
                             "remeshings",
                             "wall_s" };


    Texts csv_row(const OperationSummary &o, const double start)
    {
      Texts row = { o.name, o.ended_by };
      for (const double value :
           { start, start + o.time, 1. * o.steps, o.stroke, o.height, o.fill, o.force,
             o.largest_force, o.work, o.imbalance, o.volume_change, o.largest_strain,
             o.largest_radius, 1. * o.cells, 1. * o.remeshings, o.wall_seconds })
        row.push_back(csv_number(value));
      return row;
    }
  } // namespace


  std::string summary_table(const std::vector<OperationSummary> &operations)
  {
    std::vector<Texts> rows = { table_head };
    for (const OperationSummary &operation : operations)
      rows.push_back(table_row(operation));
    std::vector<std::size_t> width(table_head.size(), 0);
    for (const Texts &row : rows)
      for (std::size_t c = 0; c < row.size(); ++c)
        width[c] = std::max(width[c], row[c].size());
    std::string text;
    for (std::size_t r = 0; r < rows.size(); ++r)
      {
        for (std::size_t c = 0; c < width.size(); ++c)
          text += fmt::format("| {:>{}} ", rows[r][c], width[c]);
        text += "|\n";
        if (r == 0)
          {
            for (const std::size_t w : width)
              text += "|" + std::string(w + 1, '-') + ":";
            text += "|\n";
          }
      }
    return text;
  }


  void write_summary(const std::string                         &folder,
                     const std::vector<scene::SceneParameters> &parameters,
                     const std::vector<OperationSummary>       &operations)
  {
    write_file_atomically(folder + "/chain.md", summary_table(operations));
    CsvFile table = CsvFile::create(folder + "/chain.csv", csv_head);
    double  clock = 0;
    for (std::size_t k = 0; k < operations.size(); ++k)
      {
        table.write_row(csv_row(operations[k], clock));
        clock += operations[k].time + parameters[k].process.dwell;
      }
  }
} // namespace axiforge::process
