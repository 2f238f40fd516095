// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include <axiforge/meshing/adapt.h>
#include <axiforge/scene/scene.h>
#include <axiforge/solvers/flow_solver.h>
#include <axiforge/state/state.h>

namespace axiforge::process
{
  /**
   * Before the first step: solves it on the present mesh, adapts the mesh to what came out, and so
   * on, "Refinement/Start cycles" times. Nothing moves; velocity and stresses stay as a warm start.
   * Makes the solver anew. Collective.
   */
  void adapt_at_start(const scene::Scene                   &scene,
                      State                                &state,
                      std::unique_ptr<solvers::FlowSolver> &solver,
                      double                                time_step);

  /// After an accepted step: adapts the mesh if it is due, and makes the solver anew if it changed.
  meshing::AdaptReport adapt_if_due(const scene::Scene                   &scene,
                                    State                                &state,
                                    std::unique_ptr<solvers::FlowSolver> &solver);
} // namespace axiforge::process
