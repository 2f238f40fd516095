// SPDX-License-Identifier: GPL-2.0-or-later
#include <iostream>
#include <new>

#include <CLI/CLI.hpp>
#include <axiforge_revision.h>

#include <axiforge/base/blas.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/phases.h>
#include <axiforge/base/single_process.h>
#include <axiforge/process/run.h>
#include <axiforge/scene/scene.h>
#include <axiforge/study/study.h>

namespace
{
  constexpr int bad_input = 1, can_not_go_on = 2, other_failure = 3;

  /// One message, from one rank; the others have met the same.
  int report(const std::string &message, const int status)
  {
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      std::cerr << "axiforge: " << message << std::endl;
    return status;
  }


  void add_scene_options(CLI::App &app, axiforge::process::RunOptions &options)
  {
    app.add_option("FILE.prm", options.parameter_file, "The scene to run");
    app.add_option("--set", options.overrides,
                   "Set an entry over the file: --set \"Section/Entry = value\"")
        ->type_name("\"SECTION/ENTRY = VALUE\"")
        ->allow_extra_args(false)
        ->take_all();
    app.add_option("--output", options.output_directory, "Folder of the results");
    app.add_flag("--quiet", options.quiet, "No progress lines");
    app.add_flag("--timing", options.timing, "At the end, a table of where the time went");
  }

  /// Printed at the end, whichever way that comes.
  struct TimingTable
  {
    ~TimingTable()
    {
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        std::cout << axiforge::Phase::table() << std::flush;
    }
  };
} // namespace


int main(int argc, char **argv)
{
  axiforge::process::RunOptions options;
  options.version  = AXIFORGE_VERSION;
  options.revision = AXIFORGE_REVISION;
  for (int i = 0; i < argc; ++i)
    options.command_line += (i ? " " : "") + std::string(argv[i]);

  CLI::App  app("axiforge: axisymmetric forging by the viscoplastic flow formulation");
  CLI::App *study = app.add_subcommand(
      "study", "Repeat a scene for the values of its section Study and compare the results");
  // Not required() of the program itself: the scene of a study belongs to the word study.
  add_scene_options(app, options);
  add_scene_options(*study, options);
  study->add_flag("--validate", options.validate,
                  "Read and check the scene of every value, meshes included; run nothing");
  CLI::Option *resume =
      app.add_option("--resume", options.resume_from,
                     "Continue from the checkpoint in the folder of the results, or from this one")
          ->type_name("[FOLDER|FILE]")
          ->expected(0, 1);
  app.add_flag("--validate", options.validate,
               "Read and check everything, meshes included; run nothing");
  app.add_flag("--print-parameters", options.print_parameters,
               "Print all entries with their values and texts; without a file, all there are");
  app.set_version_flag("--version",
                       "axiforge " + options.version + " (revision " + options.revision + ")");
  app.footer(
      "Exit status: 0 done, 1 bad input, 2 the computation could not go on, 3 anything else.");
  try
    {
      app.parse(argc, argv);
      if (options.parameter_file.empty() && options.print_parameters && !study->parsed())
        {
          dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
          if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
            std::cout << axiforge::scene::print_all_entries();
          return 0;
        }
      if (options.parameter_file.empty())
        throw CLI::RequiredError("FILE.prm");
    }
  catch (const CLI::ParseError &error)
    {
      if (error.get_exit_code() == 0) // --help or --version
        return app.exit(error);
      const auto mpi = axiforge::start_mpi(argc, argv);
      return report(std::string(error.what()) + ". axiforge --help tells what there is.",
                    bad_input);
    }

  options.resume = resume->count() > 0;
  axiforge::use_suitable_blas();
  const auto mpi = axiforge::start_mpi(argc, argv);
  axiforge::use_one_thread();
  if (options.timing)
    axiforge::Phase::measure_phases();
  const TimingTable table;
  try
    {
      if (study->parsed())
        axiforge::study::run_study(options, MPI_COMM_WORLD);
      else
        axiforge::process::run(options, MPI_COMM_WORLD);
      return 0;
    }
  catch (const axiforge::InputError &error)
    {
      return report(error.what(), bad_input);
    }
  catch (const axiforge::ComputationError &error)
    {
      return report(error.what(), can_not_go_on);
    }
  catch (const std::bad_alloc &)
    {
      std::cerr << "axiforge: The memory of the machine is used up. Take fewer cells, or a machine "
                   "with more memory."
                << std::endl;
      // The other ranks wait for what this one will not send.
      if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) > 1)
        MPI_Abort(MPI_COMM_WORLD, can_not_go_on);
      return can_not_go_on;
    }
  catch (const std::exception &error)
    {
      return report(error.what(), other_failure);
    }
}
