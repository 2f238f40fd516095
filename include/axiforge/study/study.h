// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <axiforge/process/run.h>
#include <axiforge/study/analysis.h>
#include <axiforge/study/plan.h>

namespace axiforge::study
{
  /// What a study has found, the same on all ranks.
  struct Findings
  {
    Plan              plan;
    std::vector<Run>  runs;
    std::vector<Item> items;
  };

  /**
   * Runs the scene once for each value of its section `Study`, in folders run_1, run_2, ... of the
   * folder of results, and writes study.csv, study.md and study.svg there after each run. A run
   * that fails is recorded with its reason and the study goes on. Collective.
   * @throws InputError if the study can't begin, ComputationError if no run has reached its end
   */
  Findings run_study(const process::RunOptions &options, MPI_Comm communicator);
} // namespace axiforge::study
