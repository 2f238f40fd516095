// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/meshing/adapt.h>
#include <axiforge/scene/scene.h>
#include <axiforge/solvers/flow_solver.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

/**
 * The estimated error of the tool force and what follows from it; doc/theory.md, section 18. The
 * parts of regularisation and solver are the flow solver's own (FlowSolver::solve). All functions
 * are collective.
 */
namespace axiforge::process
{
  /**
   * The part of the mesh, measured: the velocity is solved for at the state as it stands, on its
   * mesh and on one whose cells are all halved. The state stays as it is.
   * @return relative difference of the force, extrapolated; negative if a solution failed
   */
  double measured_space_error(const scene::Scene &scene, const State &state, double time_step);

  /// The recovery estimate of the part of the mesh: the excess of the dissipation, half the square
  /// of error_indicators()'s error. @p indicators: set to those of the cells
  double recovered_space_error(const scene::Scene    &scene,
                               const State           &state,
                               dealii::Vector<float> &indicators);

  /**
   * The part of the time step: what the power would be in the geometry and with the strains that a
   * step of vanishing length has at its middle.
   * @param state before the step, @param result of the step, not yet accepted
   */
  double time_error(const scene::Scene        &scene,
                    const State               &state,
                    solvers::FlowSolver       &solver,
                    const solvers::FlowResult &result,
                    double                     time_step);

  /// After an accepted step: completes its estimates, checks the mesh's part by measuring it when
  /// that is due, and takes the summary along. Does nothing if the scene wants no estimates.
  void estimate_errors(const scene::Scene &scene, State &state, StepRecord &record);

  /// The longest step whose error is within its share of the target [s]; infinite without one.
  double step_for_target(const scene::Scene &scene, const StepRecord &last);

  /// Cells to divide and join so that the part of the mesh comes near its share of the target.
  /// @return false: nothing is to be done
  bool mark_for_target(const scene::Scene &scene,
                       const State        &state,
                       double              space_error,
                       meshing::Marking   &marking);

  /// Before the first step: adapts the mesh until the target is reached or nothing changes any
  /// more.
  void drive_to_target_at_start(const scene::Scene                   &scene,
                                State                                &state,
                                std::unique_ptr<solvers::FlowSolver> &solver,
                                double                                time_step);

  /// For the line of the step; empty without estimates.
  std::string describe_errors(const scene::Scene &scene, const StepRecord &record);

  /// Lines for the end of the run; empty without estimates.
  std::string summary_of_errors(const scene::Scene &scene, const State &state);
} // namespace axiforge::process
