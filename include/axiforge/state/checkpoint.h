// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <axiforge/scene/scene.h>
#include <axiforge/state/operation_summary.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge
{
  /// How far the folder of results had come: what has to be known to continue it.
  struct ResultsProgress
  {
    unsigned long                               n_rows    = 0; ///< of history.csv, first rank only
    unsigned int                                last_step = 0; ///< whose row is written
    std::vector<std::pair<double, std::string>> field_files, tool_files; ///< time, name
    unsigned int                                last_fields_step   = static_cast<unsigned int>(-1);
    double                                      last_fields_stroke = 0; ///< [mm]
    double                                      last_fields_time   = 0; ///< [s]
    double                                      wall_seconds       = 0; ///< of all steps so far
  };

  /// How far a chain of operations has come.
  struct ChainProgress
  {
    scene::WorkpieceOutline       outline; ///< at the start of the present operation
    std::vector<OperationSummary> finished;
    OperationSummary              present; ///< of the steps so far
  };

  /// What a checkpoint holds beside the state.
  struct CheckpointExtras
  {
    std::string     parameters; ///< all entries in effect, as in parameters.prm
    StepRecord      record;     ///< of the last step: the length of the next one depends on it
    ResultsProgress results;
    ChainProgress   chain;
  };

  /**
   * Writes the state and what goes with it to a file: coarse mesh, refinement by the cells' ids,
   * nodal values, history of the cells, contacts and friction, time. The first rank writes all of
   * it, whole or not at all. Nothing in the file depends on how the cells were shared out, so that
   * any number of ranks can read it. doc/theory.md, "Checkpoints". Collective.
   *
   * What is added to State and has to survive goes to the functions visit() in checkpoint.cc.
   *
   * @throws ComputationError if the file cannot be written
   */
  void save_checkpoint(const State &state, const CheckpointExtras &extras, const std::string &path);

  /// Fills an empty state with all of another one, without a file: for what-if computations. On the
  /// same ranks the copy goes on bit for bit. Collective.
  void copy_state(const State &from, State &to);

  /**
   * Fills an empty state from a file. On as many ranks as have written it the state continues bit
   * for bit, else as far as the linear solvers agree. Collective.
   *
   * @throws InputError that says what is wrong with the file: missing, no checkpoint, of another
   * version, cut off, damaged
   */
  CheckpointExtras load_checkpoint(State &state, const std::string &path);
} // namespace axiforge
