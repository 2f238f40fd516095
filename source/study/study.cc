// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <iostream>
#include <memory>

#include <deal.II/base/timer.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/base/wording.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/output/folder.h>
#include <axiforge/output/results.h>
#include <axiforge/study/report.h>
#include <axiforge/study/study.h>

namespace axiforge::study
{
  namespace
  {
    /// Travel of the step of a single velocity solve over the height: a contact that is left or met
    /// within it does not count, and gaps are still far above rounding.
    constexpr double single_step_reduction = 1e-6;


    std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string> &b)
    {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    }


    /// What the section `Study` needs to know of a scene that can be run.
    struct Facts
    {
      std::vector<std::string> columns; ///< of history.csv
      bool                     has_stroke;
      double                   rate; ///< V/H [1/s]
    };


    /// Reads and checks a scene, its mesh included. Collective.
    Facts facts_of(const ParameterFile &file, const MPI_Comm communicator)
    {
      const scene::SceneParameters parameters(file);
      meshing::WorkpieceMesh       mesh =
          meshing::read_workpiece(parameters.workpiece, "Workpiece", parameters.directory);
      meshing::share_from_first_rank(mesh, communicator);
      State state(communicator);
      meshing::make_initial_state(mesh, parameters.workpiece.refinement_levels, state);
      const process::Start start = process::start_operation(parameters, &mesh, state);
      const scene::Scene  &scene = *start.scene;
      return { output::history_columns(scene), scene.driving_tool != no_tool,
               scene.characteristic_rate };
    }


    /// Whether a value is a list of numbers where one number was meant; empty: it is not.
    std::string advice_on_values(const Plan &plan)
    {
      for (const Variation &variation : plan.variations)
        if (const std::size_t comma = variation.label.find(','); comma != std::string::npos)
          return "\"Study/Values\": the values of a study are separated by \";\", and \"" +
                 variation.label + "\" is a single one.";
      return "";
    }


    /// An entry that no value fits is a fault of the section, not of the runs.
    void check_entry(const process::RunOptions &options, const Plan &plan)
    {
      std::string reason;
      for (const Variation &variation : plan.variations)
        try
          {
            scene::SceneParameters(ParameterFile(options.parameter_file,
                                                 joined(options.overrides, variation.overrides)));
            return;
          }
        catch (const InputError &error)
          {
            if (reason.empty())
              reason = error.what();
          }
      throw InputError::entry("Study/Entry", plan.entry,
                              "none of the values can be set (" + reason + ")", "",
                              advice_on_values(plan));
    }


    /// Facts of the first value that makes a scene.
    Facts
    first_facts(const process::RunOptions &options, const Plan &plan, const MPI_Comm communicator)
    {
      std::string reason;
      for (const Variation &variation : plan.variations)
        try
          {
            return facts_of(ParameterFile(options.parameter_file,
                                          joined(options.overrides, variation.overrides)),
                            communicator);
          }
        catch (const InputError &error)
          {
            if (reason.empty())
              reason = error.what();
          }
      const std::string advice = advice_on_values(plan);
      throw InputError(advice.empty() ? reason : reason + " " + advice);
    }


    Run run_variation(const process::RunOptions &options,
                      const Plan                &plan,
                      const Variation           &variation,
                      const std::string         &folder,
                      const MPI_Comm             communicator)
    {
      Run run;
      run.variation = variation;

      process::RunOptions own = options;
      own.overrides           = joined(options.overrides, variation.overrides);
      own.output_directory    = folder;
      own.quiet               = true;
      double wall_of_steps    = 0;
      own.on_step             = [&](const scene::Scene &scene, const StepRecord &record) {
        wall_of_steps += record.times.total;
        if (run.history.columns.empty())
          run.history.columns = output::history_columns(scene);
        run.history.rows.push_back(output::history_row(scene, record, wall_of_steps));
        run.cells    = record.cells;
        run.unknowns = record.unknowns;
        run.iterations += record.iterations;
        ++run.steps;
      };

      dealii::Timer timer(communicator, true);
      try
        {
          if (plan.single_velocity_solve)
            {
              const double rate =
                  facts_of(ParameterFile(options.parameter_file, own.overrides), communicator).rate;
              own.overrides = joined(
                  own.overrides,
                  { "Time stepping/Scheme = explicit euler", "Time stepping/Stroke per step = 0",
                    "Time stepping/Time step = " + csv_number(single_step_reduction / rate),
                    "Time stepping/Most steps = 1" });
              own.stop_after = 1;
            }
          process::run(own, communicator);
        }
      catch (const InputError &error)
        {
          run.failure = error.what();
        }
      catch (const ComputationError &error)
        {
          run.failure = error.what();
        }
      timer.stop();
      run.wall = timer.wall_time();
      run.cpu  = timer.cpu_time();
      return run;
    }


    /// Reads and checks the scene of every value; runs nothing.
    void validate_variations(const process::RunOptions &options,
                             const Plan                &plan,
                             const MPI_Comm             communicator,
                             const bool                 quiet)
    {
      unsigned int number = 0, n_faulty = 0;
      std::string  first_fault;
      for (const Variation &variation : plan.variations)
        {
          process::RunOptions own = options;
          own.overrides           = joined(options.overrides, variation.overrides);
          own.quiet               = true;
          std::string said        = "sound";
          try
            {
              process::run(own, communicator);
            }
          catch (const InputError &error)
            {
              said = error.what();
              if (n_faulty++ == 0)
                first_fault = said;
            }
          if (!quiet)
            std::cout << fmt::format("run {} of {}: {} = {}: {}\n", ++number,
                                     plan.variations.size(), plan.entry, variation.label, said)
                      << std::flush;
        }
      if (n_faulty > 0)
        throw InputError(fmt::format("{} of {} of the study can't be run. The first: {}", n_faulty,
                                     counted(plan.variations.size(), "run"), first_fault));
    }


    void write_files(const std::string &folder, const std::string &title, const Findings &study)
    {
      write_file_atomically(folder + "/study.md",
                            markdown_report(title, study.plan, study.runs, study.items));
      write_file_atomically(folder + "/study.svg",
                            plot(title, study.plan, study.runs, study.items));
      CsvFile table = CsvFile::create(folder + "/study.csv", csv_columns(study.items));
      for (unsigned int i = 0; i < study.runs.size(); ++i)
        table.write_row(csv_row(i + 1, study.runs[i], study.items));
    }
  } // namespace


  Findings run_study(const process::RunOptions &options, const MPI_Comm communicator)
  {
    const bool first = dealii::Utilities::MPI::this_mpi_process(communicator) == 0;
    const bool quiet = options.quiet || !first;

    const ParameterFile file(options.parameter_file, options.overrides);
    if (const auto operations = file.sections_of_family("Operation"); !operations.empty())
      throw InputError(
          "A study repeats a scene of one operation, and this one has the sections \"Operation " +
          operations.front() +
          "\" and so on. Make a scene of the operation that matters, or run the chain several "
          "times "
          "with --set.");
    const scene::SceneParameters parameters(file);
    Findings                     study;
    study.plan = make_plan(parameters);
    check_entry(options, study.plan);
    if (!quiet)
      print_notes(std::cout);
    const Facts facts = first_facts(options, study.plan, communicator);
    choose_quantities(parameters, facts.columns, study.plan);
    if (study.plan.at == Place::strokes && !facts.has_stroke)
      throw InputError::entry("Study/At", parameters.study.at,
                              "no tool of the scene moves, so there is no stroke", "end, all");

    if (options.validate)
      {
        validate_variations(options, study.plan, communicator, quiet);
        return study;
      }

    std::string folder =
        options.output_directory.empty() ? parameters.output.directory : options.output_directory;
    if (folder.empty())
      folder = "results/" + std::filesystem::path(file.path()).stem().string();
    const std::string title = parameters.title.empty()
                                  ? std::filesystem::path(file.path()).stem().string()
                                  : parameters.title;

    std::unique_ptr<output::FolderLock> lock;
    on_first_rank(communicator, [&] { lock = std::make_unique<output::FolderLock>(folder); });
    unsigned int n_failed = 0;
    bool         stopped  = false;
    for (const Variation &variation : study.plan.variations)
      {
        const unsigned int number = study.runs.size() + 1;
        study.runs.push_back(run_variation(options, study.plan, variation,
                                           fmt::format("{}/run_{}", folder, number), communicator));
        const Run &run = study.runs.back();
        n_failed += run.failure.empty() ? 0 : 1;
        study.items = analyse(study.plan, study.runs, !facts.has_stroke);
        if (!quiet)
          std::cout << fmt::format("run {} of {}: {} = {}: {}\n", number,
                                   study.plan.variations.size(), study.plan.entry, variation.label,
                                   run.failure.empty()
                                       ? fmt::format("{} steps in {:.1f} s", run.steps, run.wall)
                                       : "failed. " + run.failure)
                    << std::flush;
        on_first_rank(communicator, [&] { write_files(folder, title, study); });
      }
    if (!quiet)
      print_notes(std::cout); // those of the meshes
    if (!quiet)
      std::cout << text_report(study.plan, study.runs, study.items) << "\nResults: " << folder
                << "/study.csv, study.md, study.svg, run_1 ...\n"
                << std::flush;
    if (stopped)
      throw ComputationError(fmt::format("The study ends with its run {}: {}", study.runs.size(),
                                         study.runs.back().failure));
    if (n_failed == study.runs.size())
      throw ComputationError("None of the runs of the study has reached its end. The first: " +
                             study.runs.front().failure);
    return study;
  }
} // namespace axiforge::study
