// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>

#include <deal.II/base/revision.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/features.h>
#include <axiforge/base/notes.h>
#include <axiforge/base/phases.h>
#include <axiforge/base/wording.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/output/folder.h>
#include <axiforge/output/results.h>
#include <axiforge/process/chain_summary.h>
#include <axiforge/process/checkpointing.h>
#include <axiforge/process/operation.h>
#include <axiforge/process/placement.h>
#include <axiforge/process/run.h>
#include <axiforge/process/scene_checks.h>

namespace axiforge::process
{
  namespace
  {
    std::string versions(const RunOptions &options, const MPI_Comm communicator)
    {
      return fmt::format("axiforge {} (revision {})\ndeal.II {}{}\n{}\ncommand: {}\n",
                         options.version, options.revision, DEAL_II_PACKAGE_VERSION,
                         std::string(DEAL_II_GIT_SHORTREV).empty()
                             ? ""
                             : std::string(" (") + DEAL_II_GIT_SHORTREV + ")",
                         counted(dealii::Utilities::MPI::n_mpi_processes(communicator), "rank"),
                         options.command_line);
    }


    std::string results_folder(const RunOptions &options, const scene::SceneParameters &scene)
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
      CheckpointExtras         extras = load_checkpoint(state, path);
      std::vector<std::string> begun  = { extras.chain.present.name };
      for (const OperationSummary &operation : extras.chain.finished)
        begun.push_back(operation.name);
      check_same_scene(extras.parameters, parameters, begun, path);
      const double volume = mesh.volume();
      if (std::abs(volume / state.initial_volume - 1) > 1e-6)
        throw InputError(fmt::format(
            "The workpiece of the checkpoint \"{}\" had {:.10g} mm^3 at its start, that "
            "of the geometry file has {:.10g}: the file has changed. Put it back, or "
            "start without --resume.",
            path, state.initial_volume, volume));
      return extras;
    }


    void remember(const std::vector<std::string> &notes)
    {
      for (const std::string &text : notes)
        note(text);
    }


    /// Notes are told in any case: with --quiet apart from what a script reads.
    void tell_notes(const bool quiet, const MPI_Comm communicator)
    {
      if (dealii::Utilities::MPI::this_mpi_process(communicator) != 0)
        take_notes();
      else
        print_notes(quiet ? std::cerr : std::cout);
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


    /// A scene that asks for what the build does not have is refused.
    void check_features(const std::vector<scene::SceneParameters> &operations)
    {
      if constexpr (!optional_features)
        for (const scene::SceneParameters &operation : operations)
          {
            std::string asked;
            if (operation.refinement.enabled)
              asked = "\"Refinement/Enabled\"";
            if (operation.remeshing.enabled)
              asked = "\"Remeshing/Enabled\"";
            if (operation.accuracy.estimate_errors || operation.accuracy.target != "none")
              asked = "\"Accuracy\"";
            if (operation.folding.when_found != "off")
              asked = "\"Folding/When found\"";
            if (!operation.gauges.empty())
              asked = "\"Gauges\"";
            for (const scene::ToolParameters &tool : operation.tools)
              if (tool.friction.law != "none" && tool.friction.law != "sticking")
                asked = "\"Tool " + tool.name + "/Friction/Law\"";
            if (!asked.empty())
              throw InputError(
                  "This build was made with AXIFORGE_CORE_ONLY, for a benchmark: the scene's " +
                  asked + " is not in it. Build without that option.");
          }
    }


    /// All entries of all operations, as sections if there are several.
    std::string print_all(const std::vector<scene::SceneParameters> &operations)
    {
      if (operations.front().operation.empty())
        return operations.front().print();
      std::string text;
      for (const scene::SceneParameters &operation : operations)
        text +=
            "subsection Operation " + operation.operation + "\n" + operation.print() + "\nend\n\n";
      return text;
    }


    /// Everything that the operations of a run share.
    struct Chain
    {
      const RunOptions                          &options;
      const std::vector<scene::SceneParameters> &operations;
      std::string                                folder;
      output::Provenance                         provenance;
      bool                                       quiet;
      Checkpointing                              checkpoints;
      ChainProgress                              progress;

      bool several() const
      {
        return !operations.front().operation.empty();
      }

      /// Folder of the results of an operation: 1_upset, 2_block, ... within that of the chain.
      std::string folder_of(const unsigned int k) const
      {
        return several() ? fmt::format("{}/{}_{}", folder, k + 1, operations[k].operation) : folder;
      }
    };


    /// How the whole chain was made; those of the operations are beside their results.
    void write_chain_provenance(const Chain       &chain,
                                const std::string &resumed_in,
                                const MPI_Comm     communicator)
    {
      on_first_rank(communicator, [&] {
        output::Provenance provenance = chain.provenance;
        if (!resumed_in.empty())
          {
            std::ostringstream before;
            before << std::ifstream(chain.folder + "/versions.txt").rdbuf();
            provenance.versions =
                before.str() + "\nresumed in operation " + resumed_in + ":\n" + provenance.versions;
          }
        output::write_provenance(chain.folder, provenance);
        chain.provenance.files.write(chain.folder + "/input");
      });
    }


    /// What an earlier run has left in the folders would mix with this one.
    void start_folders(const Chain &chain, const MPI_Comm communicator)
    {
      if (!chain.several())
        return;
      on_first_rank(communicator, [&] {
        output::check_folder(chain.folder, chain.provenance);
        for (unsigned int k = 0; k < chain.operations.size(); ++k)
          output::check_folder(chain.folder_of(k), chain.provenance);
        output::remove_results(chain.folder);
        for (unsigned int k = 0; k < chain.operations.size(); ++k)
          output::remove_results(chain.folder_of(k));
      });
      write_chain_provenance(chain, "", communicator);
    }


    /// One operation, from its first step or from a checkpoint.
    void run_one(Chain              &chain,
                 const unsigned int  k,
                 const scene::Scene &scene,
                 State              &state,
                 CheckpointExtras   *resumed)
    {
      output::Provenance own = chain.provenance;
      own.parameters         = chain.operations[k].print();
      if (chain.several())
        own.folder_of_files = "../input";
      if (chain.several() && !chain.quiet)
        std::cout << fmt::format("\nOperation {} of {}: {}\n", k + 1, chain.operations.size(),
                                 chain.operations[k].operation);
      warn(scene, chain.quiet);
      tell_notes(chain.quiet, state.communicator);
      output::Results results(scene, state, chain.folder_of(k), own,
                              resumed ? &resumed->results : nullptr);
      chain.checkpoints.more_follow = k + 1 < chain.operations.size();
      run_operation(scene, state, results, chain.checkpoints,
                    resumed ? resumed->record : StepRecord(), chain.progress, chain.quiet,
                    chain.options.on_step, chain.options.stop_after);
    }


    /// The operations one after the other, the workpiece going through. Collective.
    void run_chain(Chain                          &chain,
                   State                          &state,
                   std::optional<CheckpointExtras> resumed,
                   std::unique_ptr<scene::Scene>   first_scene)
    {
      unsigned int first = 0;
      if (resumed)
        {
          chain.progress = resumed->chain;
          first          = chain.progress.finished.size();
          if (chain.several()) // operations to come may have got other files
            write_chain_provenance(chain, chain.progress.present.name, state.communicator);
        }
      else
        start_folders(chain, state.communicator);
      for (unsigned int k = first; k < chain.operations.size(); ++k)
        {
          const scene::SceneParameters &operation = chain.operations[k];
          const bool                    resuming  = resumed && k == first;
          scene::in_operation(operation.operation, [&] {
            std::unique_ptr<scene::Scene> scene = std::move(first_scene);
            if (resuming)
              {
                scene = std::make_unique<scene::Scene>(operation, chain.progress.outline);
                if (state.time > scene->end_time() * (1 + 1e-9))
                  throw InputError(fmt::format(
                      "The checkpoint is at time {:.6g} s, stroke {:.6g} mm, beyond the end of the "
                      "operation ({:.6g} s, {:.6g} mm): there is nothing to go on with. Give a "
                      "later end, or start without --resume.",
                      state.time, scene->stroke(state.time), scene->end_time(),
                      scene->stroke(scene->end_time())));
              }
            else
              {
                if (!scene)
                  {
                    Start start = start_operation(operation, nullptr, state);
                    remember(start.notes);
                    tell_notes(chain.quiet, state.communicator);
                    scene                  = std::move(start.scene);
                    chain.progress.outline = start.outline;
                  }
                chain.progress.present      = OperationSummary();
                chain.progress.present.name = operation.operation;
              }
            run_one(chain, k, *scene, state, resuming ? &*resumed : nullptr);
          });
          chain.progress.finished.push_back(chain.progress.present);
          if (chain.several())
            {
              on_first_rank(state.communicator, [&] {
                write_summary(chain.folder, chain.operations, chain.progress.finished);
              });
              if (!chain.quiet && k + 1 == chain.operations.size())
                std::cout << '\n' << summary_table(chain.progress.finished) << std::flush;
            }
        }
    }
  } // namespace


  Start start_operation(const scene::SceneParameters &operation,
                        const meshing::WorkpieceMesh *fresh,
                        State                        &state)
  {
    const bool as_meshed = fresh && !operation.placement.any();
    if (!as_meshed)
      place_workpiece(operation, state);
    Start start;
    start.outline = as_meshed ? meshing::outline_of(*fresh) : meshing::outline_of(state);
    start.scene   = std::make_unique<scene::Scene>(operation, start.outline);
    start.notes   = check_before_run(*start.scene, start.outline, state);
    state.time    = time_of_first_contact(*start.scene, start.outline, state);
    return start;
  }


  void check_later_operations(const std::vector<scene::SceneParameters> &operations,
                              scene::WorkpieceOutline                    outline)
  {
    // The shape that the workpiece will have is not known: no points, no placing against it.
    outline.boundary_points.clear();
    for (unsigned int k = 1; k < operations.size(); ++k)
      scene::in_operation(operations[k].operation, [&] {
        check_placement(operations[k]);
        const scene::Scene check(operations[k], outline);
      });
  }


  void run(const RunOptions &options, const MPI_Comm communicator)
  {
    std::optional<Phase> start_phase(std::in_place, "start");
    const bool           first = dealii::Utilities::MPI::this_mpi_process(communicator) == 0;
    const bool           quiet = options.quiet || !first;
    const ParameterFile  file(options.parameter_file, options.overrides);

    const std::vector<scene::SceneParameters> operations = scene::read_operations(file);
    check_features(operations);
    if (options.print_parameters)
      {
        if (!quiet)
          print_notes(std::cerr);
        if (first)
          std::cout << print_all(operations);
        return;
      }
    const scene::SceneParameters &start = operations.front();
    meshing::WorkpieceMesh        mesh =
        meshing::read_workpiece(start.workpiece, "Workpiece", start.directory);
    meshing::share_from_first_rank(mesh, communicator);

    const std::string               folder = results_folder(options, start);
    const std::string               all    = print_all(operations);
    const InputFiles                files(all, file.directory());
    const std::string               entries = all + files.fingerprints();
    State                           state(communicator);
    std::optional<CheckpointExtras> resumed;
    // Held until the run has ended; a folder that is not there has no checkpoint either.
    std::unique_ptr<output::FolderLock> lock;
    const auto                          lock_folder = [&] {
      on_first_rank(communicator, [&] { lock = std::make_unique<output::FolderLock>(folder); });
    };
    if (options.resume)
      {
        const std::string checkpoint = find_checkpoint(options.resume_from, folder);
        if (!options.validate && std::filesystem::exists(checkpoint))
          lock_folder();
        resumed = resume(checkpoint, entries, mesh, state);
      }
    else
      meshing::make_initial_state(mesh, start.workpiece.refinement_levels, state);
    // All operations are checked before anything is written.
    Start ready;
    if (!options.resume)
      {
        remember(mesh.notes);
        remember(check_curves(operations, mesh.boundary_ids));
        scene::in_operation(start.operation, [&] { ready = start_operation(start, &mesh, state); });
        remember(ready.notes);
      }
    check_later_operations(operations, meshing::outline_of(mesh));
    tell_notes(quiet, communicator);
    if (options.validate)
      {
        if (first && !quiet)
          std::cout << fmt::format("{} is sound: {} cells, {} unknowns, {}.\n", file.path(),
                                   state.tables.n_global_cells, state.n_unknowns(),
                                   start.operation.empty()
                                       ? counted(start.tools.size(), "tool")
                                       : counted(operations.size(), "operation"));
        return;
      }
    start_phase.reset();
    if (!options.resume)
      lock_folder();
    const output::Provenance provenance{ file.resolved_text(), all, versions(options, communicator),
                                         files, output::files_of_scene(options.parameter_file) };
    Chain chain{ options, operations, folder, provenance, quiet, { folder, entries }, {} };
    chain.progress.outline = ready.outline;
    run_chain(chain, state, std::move(resumed), std::move(ready.scene));
  }
} // namespace axiforge::process
