// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/process/accuracy.h>
#include <axiforge/process/mesh_change.h>

namespace axiforge::process
{
  namespace
  {
    /// Divides cells where the tools' geometry and the regions ask for it.
    void adapt_to_geometry(const scene::Scene                   &scene,
                           State                                &state,
                           std::unique_ptr<solvers::FlowSolver> &solver)
    {
      constexpr unsigned int most_levels = 20;
      bool                   changed     = false;
      for (unsigned int n = 0;
           n < most_levels && meshing::adapt(scene, state, meshing::Marking()).changed; ++n)
        changed = true;
      if (changed)
        solver = std::make_unique<solvers::FlowSolver>(scene, state);
    }
  } // namespace


  void adapt_at_start(const scene::Scene                   &scene,
                      State                                &state,
                      std::unique_ptr<solvers::FlowSolver> &solver,
                      const double                          time_step)
  {
    if (!optional_features || !scene.refinement.enabled)
      return;
    const Phase phase("adaptive refinement");
    adapt_to_geometry(scene, state, solver);
    for (unsigned int cycle = 0; cycle < scene.refinement.start_cycles; ++cycle)
      {
        solvers::FlowResult result = solver->solve(time_step);
        if (!result.converged)
          return; // the step itself will say why
        take_as_start(state, result);
        if (!meshing::adapt(scene, state).changed)
          break;
        solver = std::make_unique<solvers::FlowSolver>(scene, state);
      }
    if (scene.accuracy.driven())
      drive_to_target_at_start(scene, state, solver, time_step);
  }


  void take_as_start(State &state, solvers::FlowResult &result)
  {
    state.velocity.swap(result.velocity);
    state.cell_history.swap(result.cell_history);
    state.contacts.swap(result.contacts);
    if (!result.edge_friction.empty())
      state.edge_friction.swap(result.edge_friction);
  }


  meshing::AdaptReport adapt_if_due(const scene::Scene                   &scene,
                                    State                                &state,
                                    std::unique_ptr<solvers::FlowSolver> &solver,
                                    const StepRecord                     &record)
  {
    meshing::AdaptReport report;
    if (!optional_features || !scene.refinement.enabled)
      return report;
    const Phase phase("adaptive refinement");
    if (scene.accuracy.driven())
      {
        meshing::Marking marking;
        if (!mark_for_target(scene, state, record.errors.space, marking))
          return report;
        report = meshing::adapt(scene, state, marking);
      }
    else if (state.step % scene.refinement.every_steps == 0)
      report = meshing::adapt(scene, state);
    if (report.changed)
      {
        solver                 = std::make_unique<solvers::FlowSolver>(scene, state);
        state.accuracy.checked = false;
      }
    return report;
  }
} // namespace axiforge::process
