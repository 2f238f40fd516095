// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/study/analysis.h>
#include <axiforge/study/plan.h>

namespace axiforge::study
{
  /// The study as plain text for the screen.
  std::string
  text_report(const Plan &plan, const std::vector<Run> &runs, const std::vector<Item> &items);

  /// The same for study.md, with @p title as its heading and the plot in it.
  std::string markdown_report(const std::string       &title,
                              const Plan              &plan,
                              const std::vector<Run>  &runs,
                              const std::vector<Item> &items);

  /// One line that says what the last runs tell of a quantity: order, limit, estimated error.
  std::string verdict(const Plan &plan, const Item &item);

  /// Column names of study.csv.
  std::vector<std::string> csv_columns(const std::vector<Item> &items);

  /// The row of a run in study.csv.
  std::vector<std::string>
  csv_row(unsigned int number, const Run &run, const std::vector<Item> &items);

  /**
   * The plot: each quantity against the value and, where there are references, errors against
   * unknowns (steps, if the unknowns are the same in all runs) and CPU time.
   */
  std::string plot(const std::string       &title,
                   const Plan              &plan,
                   const std::vector<Run>  &runs,
                   const std::vector<Item> &items);
} // namespace axiforge::study
