// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>

#include <axiforge/output/results.h>
#include <axiforge/process/checkpointing.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/checkpoint.h>
#include <axiforge/state/state.h>

namespace axiforge::process
{
  /// Called on all ranks after every accepted step, for who repeats runs and compares them.
  using OnStep = std::function<void(const scene::Scene &, const StepRecord &)>;

  /**
   * The loop over the steps of one operation, from the present state to the end of the operation.
   * When it cannot go on, what there is is written, with a checkpoint. Collective.
   * @param record of the last step, if it goes on from a checkpoint
   * @param stop_after so many steps it is over without having come to its end; 0: it goes on
   * @param chain its member `present` grows with the steps
   * @throws ComputationError
   */
  void run_operation(const scene::Scene &scene,
                     State              &state,
                     output::Results    &results,
                     Checkpointing      &checkpoints,
                     StepRecord          record,
                     ChainProgress      &chain,
                     bool                quiet,
                     const OnStep       &on_step,
                     unsigned int        stop_after = 0);
} // namespace axiforge::process
