// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <deal.II/base/revision.h>
#include <deal.II/base/timer.h>

#include <axiforge/base/errors.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/meshing/remesh.h>
#include <axiforge/output/results.h>
#include <axiforge/process/checkpointing.h>
#include <axiforge/process/mesh_change.h>
#include <axiforge/process/run.h>
#include <axiforge/process/step.h>

namespace axiforge::process
{
  namespace
  {
    std::string duration(const double seconds)
    {
      const int whole = static_cast<int>(std::lround(seconds));
      return seconds < 60     ? fmt::format("{:.1f} s", seconds)
             : seconds < 3600 ? fmt::format("{}:{:02} min", whole / 60, whole % 60)
                              : fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
    }


    /// Lines for a log as well as for a terminal: one per step, on the first rank.
    class Progress
    {
    public:
      Progress(const scene::Scene &scene, const bool quiet)
          : scene(scene)
          , quiet(quiet)
      {
      }

      void start(const State &state)
      {
        start_time = state.time;
        start_step = state.step;
        if (quiet)
          return;
        if (state.step > 0)
          std::cout << fmt::format("resumed after step {}, time {:.6g} s\n", state.step,
                                   state.time);
        if (!scene.title.empty())
          std::cout << scene.title << '\n';
        std::cout << fmt::format(
                         "{} cells, {} unknowns, {} tools, end at {:.6g} s, stroke {:.6g} mm\n",
                         state.tables.n_global_cells, state.n_unknowns(), scene.tools.size(),
                         scene.end_time(), scene.stroke(scene.end_time()))
                  << std::flush;
      }

      void step(const StepRecord &record) const
      {
        if (quiet)
          return;
        std::string forces;
        for (unsigned int i = 0; i < record.tools.size(); ++i)
          forces += fmt::format("  {} {:.6g} N", scene.tools[i].name, record.tools[i].force);
        for (unsigned int i = 0; i < record.boundaries.size(); ++i)
          if (scene.boundaries[i].is_velocity)
            forces += fmt::format("  {} {:.6g} MPa", scene.boundaries[i].name,
                                  record.boundaries[i].pressure);
        const double left =
            timer.wall_time() / (record.time - start_time) * (scene.end_time() - record.time);
        std::cout << fmt::format(
                         "step {:4}  t {:.5g} s  stroke {:.5g} mm{}  iterations {}  cells {}  left "
                         "{}{}\n",
                         record.step, record.time, record.stroke, forces, record.iterations,
                         record.cells, duration(left),
                         record.repeats ? fmt::format("  (repeated {} times)", record.repeats) : "")
                  << std::flush;
      }

      void mesh(const meshing::AdaptReport &report) const
      {
        if (quiet || !report.changed)
          return;
        std::cout << fmt::format("mesh adapted: {} cells, estimated error of the stress {:.2g}, "
                                 "changes of volume "
                                 "{:.1e}, of the strain's integral {:.1e}{}\n",
                                 report.cells, report.estimated_error, report.volume_change,
                                 report.strain_change,
                                 report.refused ? fmt::format(", {} families kept for the outline",
                                                              report.refused)
                                                : "")
                  << std::flush;
      }

      void remeshed(const State                 &state,
                    const std::string           &reason,
                    const meshing::RemeshResult &result) const
      {
        if (!quiet)
          std::cout << fmt::format("remeshing after step {} ({}): {}\n", state.step, reason,
                                   meshing::describe(result))
                    << std::flush;
      }

      void end(const State       &state,
               const StepTimes   &sum,
               const double       analyse,
               const std::string &folder) const
      {
        if (quiet)
          return;
        const double total = timer.wall_time();
        std::cout << fmt::format("{} steps in {} ({:.1f} ms per step): cells {:.0f} %, contact and "
                                 "friction {:.0f} %, "
                                 "factorisation {:.0f} %, solve {:.0f} %, analysis {:.3f} s\n",
                                 state.step - start_step, duration(total),
                                 1e3 * total / std::max(1u, state.step - start_step),
                                 100 * (sum.assembly + sum.residual) / total,
                                 100 * sum.contact / total, 100 * sum.factor / total,
                                 100 * sum.solve / total, analyse)
                  << "Results: " << folder << '\n'
                  << std::flush;
      }

    private:
      const scene::Scene &scene;
      bool                quiet;
      double              start_time = 0; ///< of this run, which may continue another [s]
      unsigned int        start_step = 0;
      dealii::Timer       timer;
    };


    std::string versions(const RunOptions &options, const MPI_Comm communicator)
    {
      return fmt::format(
          "axiforge {} (revision {})\ndeal.II {} ({})\n{} ranks\ncommand: {}\n", options.version,
          options.revision, DEAL_II_PACKAGE_VERSION, DEAL_II_GIT_SHORTREV,
          dealii::Utilities::MPI::n_mpi_processes(communicator), options.command_line);
    }


    std::string results_folder(const RunOptions &options, const scene::Scene &scene)
    {
      namespace fs = std::filesystem;
      if (!options.output_directory.empty())
        return options.output_directory;
      if (!options.resume_from.empty() && fs::exists(options.resume_from))
        {
          const fs::path from = options.resume_from;
          return fs::is_directory(from)   ? from.string()
                 : from.has_parent_path() ? from.parent_path().string()
                                          : ".";
        }
      if (!scene.output.directory.empty())
        return scene.output.directory;
      return "results/" + fs::path(options.parameter_file).stem().string();
    }


    /// Fills the state from the checkpoint and checks that this is the same workpiece.
    CheckpointExtras resume(const std::string            &path,
                            const std::string            &parameters,
                            const meshing::WorkpieceMesh &mesh,
                            State                        &state)
    {
      CheckpointExtras extras = load_checkpoint(state, path);
      check_same_scene(extras.parameters, parameters, path);
      const double volume = mesh.volume();
      if (std::abs(volume / state.initial_volume - 1) > 1e-6)
        throw InputError(fmt::format(
            "The workpiece of the checkpoint \"{}\" had {:.10g} mm^3 at its start, that "
            "of the geometry file has {:.10g}: the file has changed. Put it back, or "
            "start without --resume.",
            path, state.initial_volume, volume));
      return extras;
    }


    void warn(const scene::Scene &scene, const bool quiet)
    {
      if (quiet)
        return;
      const double           rate  = scene.characteristic_rate;
      const laws::FlowStress sigma = scene.material.flow_stress(0.1, rate);
      for (const scene::Tool &tool : scene.tools)
        if (tool.friction.kind() == laws::FrictionKind::smm &&
            tool.friction.workpiece_viscosity() && sigma.d_strain_rate * rate < 0.02 * sigma.value)
          std::cout << "Note: tool \"" << tool.name
                    << "\" has an SMM layer with the viscosity of the workpiece, and the "
                       "material hardly depends on the strain rate: the lagged viscosity often "
                       "does not converge "
                       "there. \"Layer viscosity = layer\" does.\n";
    }


    /// A new mesh and with it a new solver, if the mesh could be made.
    bool remesh(const scene::Scene                   &scene,
                State                                &state,
                std::unique_ptr<solvers::FlowSolver> &solver,
                const Progress                       &progress,
                const std::string                    &reason)
    {
      const meshing::RemeshResult result = meshing::remesh(scene, state);
      progress.remeshed(state, reason, result);
      if (result.done)
        solver = std::make_unique<solvers::FlowSolver>(scene, state);
      return result.done;
    }


    /// A step; where it fails, and remeshing is allowed, once more with a new mesh.
    StepRecord step(const scene::Scene                   &scene,
                    State                                &state,
                    std::unique_ptr<solvers::FlowSolver> &solver,
                    const Progress                       &progress,
                    const StepRecord                     &last)
    {
      constexpr unsigned int repeats_before_remeshing = 2;
      if (const std::string reason = meshing::reason_to_remesh(scene, state); !reason.empty())
        remesh(scene, state, solver, progress, reason);
      if (scene.remeshing.enabled && state.step > 0 && state.remeshing.last_attempt < state.step)
        try
          {
            return advance(scene, state, *solver, choose_step_size(scene, state, last), last,
                           repeats_before_remeshing);
          }
        catch (const ComputationError &)
          {
            remesh(scene, state, solver, progress, "a step failed");
          }
      return advance(scene, state, *solver, choose_step_size(scene, state, last), last);
    }
  } // namespace


  void run(const RunOptions &options, const MPI_Comm communicator)
  {
    const bool          first = dealii::Utilities::MPI::this_mpi_process(communicator) == 0;
    const bool          quiet = options.quiet || !first;
    const ParameterFile file(options.parameter_file, options.overrides);

    const scene::SceneParameters parameters(file);
    if (options.print_parameters)
      {
        if (first)
          std::cout << parameters.print();
        return;
      }
    meshing::WorkpieceMesh mesh =
        meshing::read_workpiece(parameters.workpiece, "Workpiece", parameters.directory);
    meshing::share_from_first_rank(mesh, communicator);
    const scene::Scene scene(parameters, meshing::outline_of(mesh));
    if (scene.flow.linear_solver == "cholmod" &&
        dealii::Utilities::MPI::n_mpi_processes(communicator) > 1)
      throw InputError::entry(
          "Flow solver/Linear solver", "cholmod", "CHOLMOD works on one rank only",
          "'automatic' or 'mumps' on several ranks", "Or start the program without mpirun");

    const std::string               folder = results_folder(options, scene);
    State                           state(communicator);
    std::optional<CheckpointExtras> resumed;
    if (options.resume)
      resumed =
          resume(find_checkpoint(options.resume_from, folder), parameters.print(), mesh, state);
    else
      meshing::make_initial_state(mesh, parameters.workpiece.refinement_levels, state);
    if (options.validate)
      {
        if (first)
          std::cout << fmt::format("{} is sound: {} cells, {} unknowns, {} tools.\n", file.path(),
                                   state.tables.n_global_cells, state.n_unknowns(),
                                   scene.tools.size());
        return;
      }
    warn(scene, quiet);

    Progress        progress(scene, quiet);
    output::Results results(
        scene, state, folder,
        { file.resolved_text(), parameters.print(), versions(options, communicator) },
        resumed ? &resumed->results : nullptr);
    auto          solver = std::make_unique<solvers::FlowSolver>(scene, state);
    StepRecord    record = resumed ? resumed->record : StepRecord();
    StepTimes     sum;
    Checkpointing checkpoints(scene, folder, parameters.print());
    progress.start(state);
    try
      {
        if (!resumed)
          adapt_at_start(scene, state, solver, choose_step_size(scene, state, record));
        while (state.time < scene.end_time() * (1 - 1e-12) && state.step < scene.time.most_steps)
          {
            record                       = step(scene, state, solver, progress, record);
            record.remeshings            = state.remeshing.count;
            record.remeshing_volume_jump = state.remeshing.volume_jump;
            record.remeshing_strain_jump = state.remeshing.strain_jump;
            results.write(state, record);
            progress.step(record);
            sum.add(record.times);
            if (options.on_step)
              options.on_step(scene, record);
            progress.mesh(adapt_if_due(scene, state, solver));
            if (checkpoints.after_step(state, record, results) && !quiet)
              std::cout << "checkpoint after step " << state.step << std::endl;
          }
        checkpoints.at_end(state, record, results);
      }
    catch (const ComputationError &error)
      {
        const std::string advice = checkpoints.rescue(state, record, results);
        results.write_fields(state); // what there is stays, up to the last good step
        throw ComputationError(error.what() + advice);
      }
    results.write_fields(state);
    progress.end(state, sum, solver->linear_system().analyse_seconds, folder);
  }
} // namespace axiforge::process
