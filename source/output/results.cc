// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <sstream>

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/mpi.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/output/results.h>

namespace axiforge::output
{
  Results::Results(const scene::Scene &scene,
                   const State        &state,
                   const std::string  &directory,
                   const Provenance   &provenance)
      : scene(scene)
      , folder(directory)
  {
    on_first_rank(state.communicator, [&] {
      std::error_code error;
      std::filesystem::create_directories(folder + "/fields", error);
      if (error)
        throw InputError::entry("Output/Directory", folder,
                                "the folder can't be made (" + error.message() + ")",
                                "a folder that you may write to", "Choose another with --output");
      // What an earlier run has left here would mix with ours.
      for (const auto &entry : std::filesystem::directory_iterator(folder + "/fields"))
        if (entry.path().extension() == ".vtu" || entry.path().extension() == ".part")
          std::filesystem::remove(entry.path(), error);
      for (const char *name : { "fields.pvd", "tools.pvd", "history.csv" })
        std::filesystem::remove(folder + "/" + name, error);
      write_file_atomically(folder + "/input.prm", provenance.input);
      write_file_atomically(folder + "/parameters.prm", provenance.parameters);
      write_file_atomically(folder + "/versions.txt", provenance.versions);
      history.emplace(CsvFile::create(folder + "/history.csv", history_columns(scene)));
    });
    if (scene.output.format == "vtu")
      write_fields(state);
  }


  bool Results::fields_due(const State &state, const StepRecord &record) const
  {
    const scene::OutputParameters &when = scene.output;
    if (when.interval_steps > 0 && state.step % when.interval_steps == 0)
      return true;
    if (when.interval_stroke > 0)
      return record.stroke >= last_fields_stroke + when.interval_stroke * (1 - 1e-9);
    return when.interval_steps == 0 &&
           record.time >= last_fields_time + scene.end_time() / 20 * (1 - 1e-9);
  }


  void Results::write(const State &state, const StepRecord &record)
  {
    wall_seconds += record.times.total;
    on_first_rank(state.communicator,
                  [&] { history->write_row(history_row(scene, record, wall_seconds)); });
    if (scene.output.format == "vtu" && fields_due(state, record))
      write_fields(state);
  }


  void Results::write_fields(const State &state)
  {
    if (scene.output.format != "vtu" || last_fields_step == state.step)
      return;
    last_fields_step         = state.step;
    last_fields_stroke       = scene.stroke(state.time);
    last_fields_time         = state.time;
    const std::string fields = fmt::format("fields/workpiece_{:05}.vtu", state.step);
    write_vtu(state, folder + "/" + fields);
    field_files.emplace_back(state.time, fields);
    on_first_rank(state.communicator, [&] {
      if (!scene.tools.empty())
        {
          const std::string tools = fmt::format("fields/tools_{:05}.vtu", state.step);
          write_tools(scene, state.time, folder + "/" + tools);
          tool_files.emplace_back(state.time, tools);
        }
      write_collections();
    });
  }


  void Results::write_collections() const
  {
    std::ostringstream fields, tools;
    dealii::DataOutBase::write_pvd_record(fields, field_files);
    write_file_atomically(folder + "/fields.pvd", fields.str());
    if (!tool_files.empty())
      {
        dealii::DataOutBase::write_pvd_record(tools, tool_files);
        write_file_atomically(folder + "/tools.pvd", tools.str());
      }
  }
} // namespace axiforge::output
