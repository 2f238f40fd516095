// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <iostream>
#include <memory>
#include <new>

#include <axiforge/base/errors.h>
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/base/wording.h>
#include <axiforge/meshing/remesh.h>
#include <axiforge/process/accuracy.h>
#include <axiforge/process/end_condition.h>
#include <axiforge/process/fold_watch.h>
#include <axiforge/process/mesh_change.h>
#include <axiforge/process/operation.h>
#include <axiforge/process/progress.h>
#include <axiforge/process/scene_checks.h>
#include <axiforge/process/step.h>
#include <axiforge/process/table_watch.h>

namespace axiforge::process
{
  namespace
  {
    /// Element sizes over the usual one that are tried in turn where that one does not help.
    constexpr double size_factors[] = { 1, 0.8, 0.65, 1.25 };


    /// A new mesh and with it a new solver, if the mesh could be made.
    bool remesh(const scene::Scene                   &scene,
                State                                &state,
                std::unique_ptr<solvers::FlowSolver> &solver,
                const Progress                       &progress,
                const std::string                    &reason,
                const double                          size_factor = 1)
    {
      const Phase                 phase("remeshing");
      const meshing::RemeshResult result = meshing::remesh(scene, state, size_factor);
      progress.remeshed(state, reason, result);
      if (result.done)
        solver = std::make_unique<solvers::FlowSolver>(scene, state);
      return result.done;
    }


    std::string reason_of(const ComputationError &error)
    {
      const auto *failed = dynamic_cast<const StepError *>(&error);
      return failed ? failed->reason : error.what();
    }


    /// The step once more on new meshes, the first of the usual size, where the step has failed.
    StepRecord step_on_another_mesh(const scene::Scene                   &scene,
                                    State                                &state,
                                    std::unique_ptr<solvers::FlowSolver> &solver,
                                    const Progress                       &progress,
                                    const StepRecord                     &last,
                                    const bool                            is_fresh,
                                    const std::string                    &failure)
    {
      constexpr unsigned int repeats  = 4;
      unsigned int           n_meshes = is_fresh ? 1 : 0;
      std::string            reason   = failure;
      for (const double factor : size_factors)
        {
          if (is_fresh && factor == 1)
            continue; // it would be the same mesh
          if (!remesh(
                  scene, state, solver, progress,
                  (n_meshes == 0 ? "a step failed: " : "the step failed on the new mesh, too: ") +
                      reason,
                  factor))
            continue;
          ++n_meshes;
          try
            {
              return advance(scene, state, *solver, choose_step_size(scene, state, last), last,
                             repeats, true);
            }
          catch (const ComputationError &error)
            {
              // The next mesh, or the last one with as short steps as are allowed.
              reason = reason_of(error);
            }
        }
      try
        {
          return advance(scene, state, *solver, choose_step_size(scene, state, last), last);
        }
      catch (const ComputationError &error)
        {
          throw ComputationError(fmt::format(
              "{} {} new mesh{} of other sizes did not help.", error.what(),
              n_meshes == 0 ? "No" : std::to_string(n_meshes), n_meshes == 1 ? "" : "es"));
        }
    }


    /// A step; where it fails, and remeshing is allowed, once more with a new mesh.
    StepRecord step(const scene::Scene                   &scene,
                    State                                &state,
                    std::unique_ptr<solvers::FlowSolver> &solver,
                    const Progress                       &progress,
                    const StepRecord                     &last)
    {
      constexpr unsigned int repeats_before_remeshing = 2, repeats_on_fresh_mesh = 4;
      if constexpr (!optional_features)
        return advance(scene, state, *solver, choose_step_size(scene, state, last), last);
      if (const std::string reason = meshing::reason_to_remesh(scene, state); !reason.empty())
        for (const double factor : size_factors)
          if (remesh(scene, state, solver, progress, reason, factor))
            break;
      if (!scene.remeshing.enabled)
        return advance(scene, state, *solver, choose_step_size(scene, state, last), last);
      const bool is_fresh = state.step > 0 && state.remeshing.last_attempt == state.step;
      try
        {
          return advance(scene, state, *solver, choose_step_size(scene, state, last), last,
                         is_fresh ? repeats_on_fresh_mesh : repeats_before_remeshing, true);
        }
      catch (const ComputationError &error)
        {
          return step_on_another_mesh(scene, state, solver, progress, last, is_fresh,
                                      reason_of(error));
        }
    }


    /**
     * Axial sum of the forces of all tools over the largest of them: 0 in balance, doc/theory.md
     * (31). Where something else holds the workpiece (a symmetry line, a boundary) it is 0.
     */
    double imbalance(const scene::Scene &scene, const State &state, const StepRecord &record)
    {
      if (scene.tools.size() < 2 || !scene.boundaries.empty() ||
          state.boundary_ids.count("symmetry"))
        return 0;
      double sum = 0, largest = 0;
      for (unsigned int i = 0; i < scene.tools.size(); ++i)
        {
          // A record's force is positive against the motion, of a tool at rest upwards.
          const double middle = record.time - 0.5 * record.time_step;
          const double sign   = scene.tools[i].motion.velocity(middle)[1] < 0 ? -1 : 1;
          sum += sign * record.tools[i].force;
          largest = std::max(largest, std::abs(record.tools[i].force));
        }
      // Steps that press: before the contact closes on both sides there is nothing to balance.
      return largest > least_force(scene) ? std::abs(sum) / largest : 0;
    }


    void add_step(const scene::Scene &scene,
                  const State        &state,
                  const StepRecord   &record,
                  OperationSummary   &summary)
    {
      summary.steps  = record.step;
      summary.time   = record.time;
      summary.stroke = record.stroke;
      summary.height = record.height;
      summary.fill   = record.fill;
      if (scene.driving_tool != no_tool)
        {
          summary.force         = record.end_force;
          summary.largest_force = std::max(
              { summary.largest_force, record.end_force, record.tools[scene.driving_tool].force });
        }
      summary.work += record.time_step * (record.power_tools + record.power_boundaries);
      summary.imbalance      = std::max(summary.imbalance, imbalance(scene, state, record));
      summary.volume_change  = record.relative_volume_change;
      summary.largest_strain = record.largest_strain;
      summary.largest_radius = record.largest_radius;
      summary.cells          = record.cells;
      summary.wall_seconds += record.times.total;
    }
    /// The last good state and its fields. @return a sentence on how to continue
    std::string keep_what_there_is(const State      &state,
                                   const StepRecord &record,
                                   output::Results  &results,
                                   Checkpointing    &checkpoints)
    {
      const std::string advice = checkpoints.rescue(state, record);
      try
        {
          results.write_fields(state); // what there is stays, up to the last good step
          results.finish();
        }
      catch (const std::exception &)
        {
          // What went wrong first is what has to be told.
        }
      return advice;
    }
  } // namespace


  namespace
  {
    /// Of any tool in a step [N].
    double largest_force_of(const StepRecord &record)
    {
      double largest = 0;
      for (const ToolRecord &tool : record.tools)
        largest = std::max({ largest, std::abs(tool.force), std::abs(tool.radial_force) });
      return largest;
    }


    void throw_out_of_steps(const scene::Scene &scene, const State &state)
    {
      throw ComputationError(fmt::format(
          "The run has stopped after {} (\"Time stepping/Most steps\" = {}) at time {:.6g} of "
          "{:.6g} "
          "s, stroke {:.6g} of {:.6g} mm: it has not come to its end. Allow more steps, or longer "
          "ones.",
          counted(state.step, "step"), scene.time.most_steps, state.time, scene.end_time(),
          scene.stroke(state.time), scene.stroke(scene.end_time())));
    }


    void tell_full(const scene::Scene &scene, const State &state, const bool quiet)
    {
      if (dealii::Utilities::MPI::this_mpi_process(state.communicator) == 0)
        (quiet ? std::cerr : std::cout)
            << fmt::format("Warning: the die is full at stroke {:.6g} mm: the tools can't close "
                           "further, and the operation ends there, before stroke {:.6g} mm.\n",
                           scene.stroke(state.time), scene.stroke(scene.end_time()));
    }


    /// What plastic flow cannot do: rigid-plastic metal keeps its volume.
    void tell_volume(const State &state, const StepRecord &record, const bool quiet)
    {
      constexpr double worth_telling = 1e-3;
      if (std::abs(record.relative_volume_change) > worth_telling &&
          dealii::Utilities::MPI::this_mpi_process(state.communicator) == 0)
        (quiet ? std::cerr : std::cout)
            << fmt::format("Warning: the volume has changed by {:.2g} % in the run. Nodes go "
                           "straight in a step: take shorter ones, or smaller cells.\n",
                           100 * record.relative_volume_change)
            << std::flush;
    }


    /// Sees the steps in which contacts pull, see StepRecord::tension, and says so at the end.
    class TensionWatch
    {
    public:
      void after_step(const StepRecord &record)
      {
        ++all;
        if (!(record.tension > 0))
          return;
        ++steps;
        const double share = record.tension / std::max(largest_force_of(record), record.tension);
        if (share > largest_share)
          {
            largest_share = share;
            stroke        = record.stroke;
          }
      }

      void tell(const State &state, const bool quiet) const
      {
        if (steps > 0 && dealii::Utilities::MPI::this_mpi_process(state.communicator) == 0)
          (quiet ? std::cerr : std::cout)
              << fmt::format("Warning: in {} of {} contacts pull on the workpiece, with up to "
                             "{:.2g} % of the die force (at stroke {:.6g} mm; \"tension_N\" in "
                             "history.csv). Friction that does not vanish with the pressure has no "
                             "other solution there; with \"Law = coulomb\" it does.\n",
                             steps, counted(all, "step"), 100 * largest_share, stroke)
              << std::flush;
      }

    private:
      unsigned int all = 0, steps = 0;
      double       largest_share = 0, stroke = 0;
    };


    /// A run in which nothing was formed is no result.
    void check_formed(const scene::Scene &scene, const State &state, const double largest_force)
    {
      if (scene.driving_tool == no_tool || !scene.boundaries.empty() ||
          largest_force > least_force(scene))
        return;
      throw ComputationError(fmt::format("Nothing has been formed up to stroke {:.6g} mm: no tool "
                                         "ever bore a force, tool \"{}\" has "
                                         "moved without resistance. The workpiece was not reached, "
                                         "or was carried along as a rigid "
                                         "body: it needs tools that reach it and something that "
                                         "holds it (a tool on the other side, "
                                         "a symmetry line).",
                                         scene.stroke(state.time),
                                         scene.tools[scene.driving_tool].name));
    }
  } // namespace


  void run_operation(const scene::Scene &scene,
                     State              &state,
                     output::Results    &results,
                     Checkpointing      &checkpoints,
                     StepRecord          record,
                     ChainProgress      &chain,
                     const bool          quiet,
                     const OnStep       &on_step,
                     const unsigned int  stop_after)
  {
    const unsigned int remeshings_before = state.remeshing.count - chain.present.remeshings;
    auto               solver            = std::make_unique<solvers::FlowSolver>(scene, state);
    double       largest_force = std::max(chain.present.largest_force, largest_force_of(record));
    StepTimes    sum;
    Progress     progress(scene, quiet);
    FoldWatch    folds(scene, quiet);
    TableWatch   table(scene, quiet);
    TensionWatch tension;
    progress.start(state);
    checkpoints.enter(scene, chain, results);
    try
      {
        if (state.step == 0)
          adapt_at_start(scene, state, solver, choose_step_size(scene, state, record));
        while (ended_by(scene, record).empty() && (stop_after == 0 || record.step < stop_after))
          {
            const Phase phase("steps");
            try
              {
                record = step(scene, state, solver, progress, record);
              }
            catch (const StepError &)
              {
                if (!is_full(scene, record, nearly_filled))
                  throw;
                record.time_to_fill = 0;
                break;
              }
            estimate_errors(scene, state, record);
            record.remeshings            = state.remeshing.count;
            record.remeshing_volume_jump = state.remeshing.volume_jump;
            record.remeshing_strain_jump = state.remeshing.strain_jump;
            add_step(scene, state, record, chain.present);
            largest_force            = std::max(largest_force, largest_force_of(record));
            chain.present.remeshings = state.remeshing.count - remeshings_before;
            results.write(state, record);
            progress.step(record);
            sum.add(record.times);
            if (on_step)
              on_step(scene, record);
            table.after_step(state, record.time_step);
            tension.after_step(record);
            folds.after_step(state, record);
            progress.mesh(adapt_if_due(scene, state, solver, record));
            if (checkpoints.after_step(state, record))
              progress.say(fmt::format("checkpoint after step {}", state.step));
          }
        chain.present.ended_by = ended_by(scene, record);
        if (chain.present.ended_by == "steps" && stop_after == 0)
          throw_out_of_steps(scene, state);
        if (chain.present.ended_by == "full")
          tell_full(scene, state, quiet);
        checkpoints.at_end(state, record);
        results.write_fields(state);
        results.finish();
        table.tell(state);
        tension.tell(state, quiet);
        tell_volume(state, record, quiet);
      }
    catch (const ComputationError &error)
      {
        table.tell(state);
        tension.tell(state, quiet);
        tell_volume(state, record, quiet);
        throw ComputationError(error.what() +
                               keep_what_there_is(state, record, results, checkpoints));
      }
    catch (const std::bad_alloc &)
      {
        // It may have met one rank of several, and nothing that all take part in can be done then.
        if (dealii::Utilities::MPI::n_mpi_processes(state.communicator) > 1)
          throw;
        solver.reset(); // which has the most of it
        throw ComputationError(
            fmt::format(
                "The memory of the machine is used up at time {:.6g} s, after step {}, with "
                "{} cells. Take fewer cells, or a machine with more memory.",
                state.time, state.step, state.tables.n_global_cells) +
            keep_what_there_is(state, record, results, checkpoints));
      }
    check_formed(scene, state, largest_force);
    progress.end(state, sum, solver->linear_system().analyse_seconds, results.directory());
  }
} // namespace axiforge::process
