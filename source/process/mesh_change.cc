// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/process/mesh_change.h>

namespace axiforge::process
{
  void adapt_at_start(const scene::Scene                   &scene,
                      State                                &state,
                      std::unique_ptr<solvers::FlowSolver> &solver,
                      const double                          time_step)
  {
    if (!scene.refinement.enabled)
      return;
    for (unsigned int cycle = 0; cycle < scene.refinement.start_cycles; ++cycle)
      {
        solvers::FlowResult result = solver->solve(time_step);
        if (!result.converged)
          return; // the step itself will say why
        state.velocity.swap(result.velocity);
        state.cell_history.swap(result.cell_history);
        state.contacts.swap(result.contacts);
        if (!meshing::adapt(scene, state).changed)
          return;
        solver = std::make_unique<solvers::FlowSolver>(scene, state);
      }
  }


  meshing::AdaptReport adapt_if_due(const scene::Scene                   &scene,
                                    State                                &state,
                                    std::unique_ptr<solvers::FlowSolver> &solver)
  {
    meshing::AdaptReport report;
    if (!scene.refinement.enabled || state.step % scene.refinement.every_steps != 0)
      return report;
    report = meshing::adapt(scene, state);
    if (report.changed)
      solver = std::make_unique<solvers::FlowSolver>(scene, state);
    return report;
  }
} // namespace axiforge::process
