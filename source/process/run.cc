// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <iostream>
#include <optional>

#include <deal.II/base/revision.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/output/results.h>
#include <axiforge/process/chain_summary.h>
#include <axiforge/process/checkpointing.h>
#include <axiforge/process/operation.h>
#include <axiforge/process/placement.h>
#include <axiforge/process/run.h>

namespace axiforge::process
{
  namespace
  {
    std::string versions(const RunOptions &options, const MPI_Comm communicator)
    {
      return fmt::format(
          "axiforge {} (revision {})\ndeal.II {} ({})\n{} ranks\ncommand: {}\n", options.version,
          options.revision, DEAL_II_PACKAGE_VERSION, DEAL_II_GIT_SHORTREV,
          dealii::Utilities::MPI::n_mpi_processes(communicator), options.command_line);
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


    /// What an earlier run has left in the folders would mix with this one.
    void start_folders(const Chain &chain, const MPI_Comm communicator)
    {
      if (!chain.several())
        return;
      on_first_rank(communicator, [&] {
        output::make_folder(chain.folder);
        output::remove_results(chain.folder);
        for (unsigned int k = 0; k < chain.operations.size(); ++k)
          output::remove_results(chain.folder_of(k));
        write_file_atomically(chain.folder + "/input.prm", chain.provenance.input);
        write_file_atomically(chain.folder + "/parameters.prm", chain.provenance.parameters);
        write_file_atomically(chain.folder + "/versions.txt", chain.provenance.versions);
      });
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
      if (chain.several() && !chain.quiet)
        std::cout << fmt::format("\nOperation {} of {}: {}\n", k + 1, chain.operations.size(),
                                 chain.operations[k].operation);
      warn(scene, chain.quiet);
      output::Results results(scene, state, chain.folder_of(k), own,
                              resumed ? &resumed->results : nullptr);
      chain.checkpoints.more_follow = k + 1 < chain.operations.size();
      run_operation(scene, state, results, chain.checkpoints,
                    resumed ? resumed->record : StepRecord(), chain.progress, chain.quiet,
                    chain.options.on_step);
    }


    /// The operations one after the other, the workpiece going through. Collective.
    void run_chain(Chain                          &chain,
                   const meshing::WorkpieceMesh   &mesh,
                   State                          &state,
                   std::optional<CheckpointExtras> resumed)
    {
      unsigned int first = 0;
      if (resumed)
        {
          chain.progress = resumed->chain;
          first          = chain.progress.finished.size();
        }
      else
        start_folders(chain, state.communicator);
      for (unsigned int k = first; k < chain.operations.size(); ++k)
        {
          const scene::SceneParameters &operation = chain.operations[k];
          const bool                    resuming  = resumed && k == first;
          scene::in_operation(operation.operation, [&] {
            if (!resuming)
              {
                const bool as_meshed = k == 0 && !operation.placement.any();
                if (!as_meshed)
                  place_workpiece(operation, state);
                chain.progress.outline =
                    as_meshed ? meshing::outline_of(mesh) : meshing::outline_of(state);
                chain.progress.present      = OperationSummary();
                chain.progress.present.name = operation.operation;
              }
            const scene::Scene scene(operation, chain.progress.outline);
            if (!resuming)
              state.time = time_of_first_contact(scene, chain.progress.outline, state);
            run_one(chain, k, scene, state, resuming ? &*resumed : nullptr);
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
        if (first)
          std::cout << print_all(operations);
        return;
      }
    const scene::SceneParameters &start = operations.front();
    meshing::WorkpieceMesh        mesh =
        meshing::read_workpiece(start.workpiece, "Workpiece", start.directory);
    meshing::share_from_first_rank(mesh, communicator);
    // A run makes the scene before it writes anything; a chain has written its folder by then.
    if (!start.placement.any() && (options.validate || !start.operation.empty()))
      scene::in_operation(start.operation,
                          [&] { const scene::Scene check(start, meshing::outline_of(mesh)); });

    const std::string               folder = results_folder(options, start);
    const std::string               all    = print_all(operations);
    State                           state(communicator);
    std::optional<CheckpointExtras> resumed;
    if (options.resume)
      resumed = resume(find_checkpoint(options.resume_from, folder), all, mesh, state);
    else
      meshing::make_initial_state(mesh, start.workpiece.refinement_levels, state);
    if (options.validate)
      {
        if (first)
          std::cout << fmt::format("{} is sound: {} cells, {} unknowns, {}.\n", file.path(),
                                   state.tables.n_global_cells, state.n_unknowns(),
                                   start.operation.empty()
                                       ? fmt::format("{} tools", start.tools.size())
                                       : fmt::format("{} operations", operations.size()));
        return;
      }
    start_phase.reset();
    Chain chain{ options, operations,
                 folder,  { file.resolved_text(), all, versions(options, communicator) },
                 quiet,   { folder, all },
                 {} };
    run_chain(chain, mesh, state, std::move(resumed));
  }
} // namespace axiforge::process
