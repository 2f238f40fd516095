// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <deal.II/numerics/data_out.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/background.h>
#include <axiforge/output/folder.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/checkpoint.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge::output
{
  /**
   * Writes the folder of a run: `input.prm`, `parameters.prm`, `versions.txt`, the files they name
   * in `input/`, `history.csv` (one row per accepted step), VTU files in `fields/` with
   * `fields.pvd` and `tools.pvd`. Every file appears whole or not at all; a row of the history is
   * written at once, the files of the fields beside the next steps if there is but one rank. All
   * functions are collective.
   */
  class Results
  {
  public:
    /**
     * Makes the folder and writes what is known before the first step.
     * @param resumed continue the folder from there: what was written later is taken away
     * @throws InputError if the folder does not have what it had then
     */
    Results(const scene::Scene    &scene,
            const State           &state,
            const std::string     &directory,
            const Provenance      &provenance,
            const ResultsProgress *resumed = nullptr);

    /// Writes the row of the step, and the fields if they are due.
    void write(const State &state, const StepRecord &record);

    /// Writes the fields of the present state unless they are there. On one rank the files may
    /// appear later, and @throws what went wrong with those before.
    void write_fields(const State &state);

    /// Waits for the files of the fields. @throws what went wrong with them
    void finish();

    const std::string &directory() const
    {
      return folder;
    }

    /// How far the folder has come: as far as this says, its files are there. @throws like finish()
    const ResultsProgress &progress();

  private:
    void start_folder(const Provenance &provenance);
    void continue_folder(const State &state, const Provenance &provenance);
    bool fields_due(const State &state, const StepRecord &record) const;

    const scene::Scene    &scene;
    std::string            folder;
    std::optional<CsvFile> history; ///< first rank only
    ResultsProgress        done;    ///< rows: first rank only
    Background             writer;
  };

  /// Column names of history.csv.
  std::vector<std::string> history_columns(const scene::Scene &scene);

  /// The figures of a step in the order of the columns.
  std::vector<double>
  history_row(const scene::Scene &scene, const StepRecord &record, double wall_seconds);

  /// The fields of the state in its present configuration. Nothing of the state is read any more,
  /// but this has to go before the state does. Collective.
  std::shared_ptr<dealii::DataOut<2>> collect_fields(const State &state);

  /// Writes all fields as one VTU file, without any communication: of a single rank.
  void write_vtu(const dealii::DataOut<2> &fields, const std::string &path);

  /// Writes the fields of all ranks as one VTU file. Collective.
  void write_vtu_in_parallel(const dealii::DataOut<2> &fields,
                             const std::string        &path,
                             MPI_Comm                  communicator);

  /// Writes the outlines of the tools at a time as a VTU file of lines (first rank only).
  void write_tools(const scene::Scene &scene, double time, const std::string &path);
} // namespace axiforge::output
