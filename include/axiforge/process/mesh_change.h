// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include <axiforge/meshing/adapt.h>
#include <axiforge/scene/scene.h>
#include <axiforge/solvers/flow_solver.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge::process
{
  /**
   * Before the first step: divides the cells where geometry and regions ask for it, then solves the
   * step on the present mesh, adapts the mesh to what came out, and so on, "Refinement/Start
   * cycles" times, or until a target accuracy is reached. Nothing moves; velocity and stresses stay
   * as a warm start. Makes the solver anew. Collective.
   */
  void adapt_at_start(const scene::Scene                   &scene,
                      State                                &state,
                      std::unique_ptr<solvers::FlowSolver> &solver,
                      double                                time_step);

  /// Velocity, stresses and contacts of a step that is not accepted, for the next solution to start
  /// from.
  void take_as_start(State &state, solvers::FlowResult &result);

  /// After an accepted step: adapts the mesh if it is due, or if the target accuracy asks for it,
  /// and makes the solver anew if it changed.
  meshing::AdaptReport adapt_if_due(const scene::Scene                   &scene,
                                    State                                &state,
                                    std::unique_ptr<solvers::FlowSolver> &solver,
                                    const StepRecord                     &record = StepRecord());
} // namespace axiforge::process
