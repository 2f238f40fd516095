// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/study/convergence.h>
#include <axiforge/study/curve.h>
#include <axiforge/study/plan.h>

namespace axiforge::study
{
  /// What a run has given and what it has cost.
  struct Run
  {
    Variation    variation;
    std::string  failure;                                            ///< empty: it reached its end
    unsigned int cells = 0, unknowns = 0, steps = 0, iterations = 0; ///< cells: of the last step
    double       wall = 0; ///< of the whole run, mesh and files included [s]
    double       cpu  = 0; ///< sum over the ranks [s]
    History      history;
  };

  /// A quantity at a place, for all runs; what a run can't tell is `nan`.
  struct Item
  {
    std::string quantity;  ///< column of history.csv
    std::string name;      ///< with the place, where there are several
    double      reference; ///< `nan`: none

    /// The quantity; with Place::whole_curve its root mean square distance to the last run.
    std::vector<double>     value;
    std::vector<double>     difference;  ///< to the run before
    std::vector<Richardson> convergence; ///< from this run and the two before
    std::vector<double>     error;       ///< relative to the reference, to the last curve's rms
    std::vector<double>     error_order; ///< from this run and the one before
  };

  /**
   * Differences, orders, limits and errors of all quantities. Orders only where three runs in a row
   * have a value; those of Place::whole_curve for the last run alone.
   */
  std::vector<Item> analyse(const Plan &plan, const std::vector<Run> &runs, bool against_time);
} // namespace axiforge::study
