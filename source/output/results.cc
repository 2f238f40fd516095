// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/mpi.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/phases.h>
#include <axiforge/output/results.h>

namespace axiforge::output
{
  static void write_collections(const std::string &folder, const ResultsProgress &done)
  {
    std::ostringstream fields, tools;
    if (!done.field_files.empty() || std::filesystem::exists(folder + "/fields.pvd"))
      {
        dealii::DataOutBase::write_pvd_record(fields, done.field_files);
        write_file_atomically(folder + "/fields.pvd", fields.str());
      }
    if (!done.tool_files.empty() || std::filesystem::exists(folder + "/tools.pvd"))
      {
        dealii::DataOutBase::write_pvd_record(tools, done.tool_files);
        write_file_atomically(folder + "/tools.pvd", tools.str());
      }
  }


  Results::Results(const scene::Scene    &scene,
                   const State           &state,
                   const std::string     &directory,
                   const Provenance      &provenance,
                   const ResultsProgress *resumed)
      : scene(scene)
      , folder(directory)
  {
    if (resumed)
      done = *resumed;
    on_first_rank(state.communicator, [&] {
      make_folder(folder + "/fields");
      if (resumed)
        continue_folder(state, provenance);
      else
        start_folder(provenance);
    });
    if (!resumed && scene.output.format == "vtu")
      write_fields(state);
  }


  void Results::start_folder(const Provenance &provenance)
  {
    check_folder(folder, provenance);
    remove_results(folder); // what an earlier run has left here would mix with ours
    write_provenance(folder, provenance);
    if (provenance.folder_of_files == "input")
      provenance.files.write(folder + "/input");
    history.emplace(CsvFile::create(folder + "/history.csv", history_columns(scene)));
  }


  void Results::continue_folder(const State &state, const Provenance &provenance)
  {
    history.emplace(CsvFile::resume(folder + "/history.csv", history_columns(scene), done.n_rows));

    std::vector<std::string> kept;
    std::size_t              n_missing = 0;
    for (auto *list : { &done.field_files, &done.tool_files })
      {
        const auto missing = std::remove_if(list->begin(), list->end(), [&](const auto &file) {
          return !std::filesystem::exists(folder + "/" + file.second);
        });
        n_missing += list->end() - missing;
        list->erase(missing, list->end());
        for (const auto &file : *list)
          kept.push_back(std::filesystem::path(file.second).filename().string());
      }
    if (n_missing > 0)
      std::cerr << fmt::format(
          "Note: {} files of the fields that the run had written are no longer "
          "in \"{}/fields\": they are taken out of its lists.\n",
          n_missing, folder);
    write_collections(folder, done);
    remove_fields(folder, kept);

    std::ostringstream before;
    before << std::ifstream(folder + "/versions.txt").rdbuf();
    Provenance whole = provenance;
    whole.versions =
        before.str() + fmt::format("\nresumed after step {}:\n", state.step) + provenance.versions;
    write_provenance(folder, whole);
    if (provenance.folder_of_files == "input")
      provenance.files.write(folder + "/input");
  }


  bool Results::fields_due(const State &state, const StepRecord &record) const
  {
    const scene::OutputParameters &when = scene.output;
    if (when.interval_steps > 0 && state.step % when.interval_steps == 0)
      return true;
    if (when.interval_stroke > 0)
      return record.stroke >= done.last_fields_stroke + when.interval_stroke * (1 - 1e-9);
    return when.interval_steps == 0 &&
           record.time >= done.last_fields_time + scene.end_time() / 20 * (1 - 1e-9);
  }


  void Results::write(const State &state, const StepRecord &record)
  {
    const Phase phase("output");
    done.wall_seconds += record.times.total;
    on_first_rank(state.communicator, [&] {
      history->write_row(history_row(scene, record, done.wall_seconds));
      done.n_rows = history->n_rows();
    });
    done.last_step = state.step;
    if (scene.output.format == "vtu" && fields_due(state, record))
      write_fields(state);
  }


  void Results::write_fields(const State &state)
  {
    if (scene.output.format != "vtu" || done.last_fields_step == state.step)
      return;
    const Phase phase("fields");
    // What went wrong with the files before is told, but these are written first.
    std::exception_ptr earlier;
    try
      {
        finish();
      }
    catch (...)
      {
        earlier = std::current_exception();
      }
    done.last_fields_step    = state.step;
    done.last_fields_stroke  = scene.stroke(state.time);
    done.last_fields_time    = state.time;
    const std::string fields = fmt::format("fields/workpiece_{:05}.vtu", state.step);
    const std::string tools =
        scene.tools.empty() ? "" : fmt::format("fields/tools_{:05}.vtu", state.step);
    const auto collected = collect_fields(state);
    const auto now_done  = [&] {
      done.field_files.emplace_back(state.time, fields);
      if (!tools.empty())
        done.tool_files.emplace_back(state.time, tools);
    };
    const auto write_rest = [&scene = scene, folder = folder, tools,
                             time = state.time](const ResultsProgress &list) {
      if (!tools.empty())
        write_tools(scene, time, folder + "/" + tools);
      write_collections(folder, list);
    };
    if (dealii::Utilities::MPI::n_mpi_processes(state.communicator) == 1)
      {
        now_done();
        writer.start("files of the fields",
                     [collected, path = folder + "/" + fields, write_rest, list = done] {
                       write_vtu(*collected, path);
                       write_rest(list);
                     });
      }
    else
      {
        write_vtu_in_parallel(*collected, folder + "/" + fields, state.communicator);
        now_done();
        on_first_rank(state.communicator, [&] { write_rest(done); });
      }
    if (earlier)
      std::rethrow_exception(earlier);
  }


  void Results::finish()
  {
    try
      {
        writer.wait();
      }
    catch (...)
      {
        // One job at most is under way, and its files are the last of the lists.
        done.field_files.pop_back();
        if (!scene.tools.empty())
          done.tool_files.pop_back();
        done.last_fields_step = ResultsProgress().last_fields_step; // they may be tried again
        throw;
      }
  }


  const ResultsProgress &Results::progress()
  {
    finish();
    return done;
  }
} // namespace axiforge::output
