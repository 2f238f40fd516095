// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/base/errors.h>
#include <axiforge/scene/scene.h>
#include <axiforge/solvers/flow_solver.h>
#include <axiforge/state/measures.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge::process
{
  /**
   * Length of the next step [s]: as given in the scene, or from the reduction, the strain increment
   * and the motion of the nodes; never beyond the end of the run or a jump of a tool's velocity.
   * Collective.
   * @throws StepError if a step would have to be shorter than is allowed
   */
  double choose_step_size(const scene::Scene &scene, const State &state, const StepRecord &last);

  /// A step that can't be made, not even a short one: the reason alone, without place and advice.
  struct StepError : public ComputationError
  {
    StepError(const std::string &message, std::string reason)
        : ComputationError(message)
        , reason(std::move(reason))
    {
    }
    std::string reason;
  };

  /**
   * One accepted step: solves the flow, moves the state, returns the figures. A step that fails (no
   * convergence, a cell that would turn over) is repeated with half its length; the step is at most
   * half as long again as the last one.
   * @param most_repeats fewer than usual if there is something else to try, like a new mesh
   * @param keep_sound the step fails, too, if it spoils the mesh (meshing::Soundness)
   * @throws StepError that says where, at which time and stroke, and what to try
   */
  StepRecord advance(const scene::Scene  &scene,
                     State               &state,
                     solvers::FlowSolver &solver,
                     double               time_step,
                     const StepRecord    &last         = StepRecord(),
                     unsigned int         most_repeats = 40,
                     bool                 keep_sound   = false);
} // namespace axiforge::process
