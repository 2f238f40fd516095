// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <axiforge/base/atomic_file.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/checkpoint.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge::output
{
  /// What is kept beside the results so that they can be made again.
  struct Provenance
  {
    std::string input;      ///< the .prm as given, included files and overrides in their places
    std::string parameters; ///< all entries in effect
    std::string versions;   ///< program, revision, libraries, command line
  };

  /**
   * Writes the folder of a run: `input.prm`, `parameters.prm`, `versions.txt`, `history.csv` (one
   * row per accepted step), VTU files in `fields/` with `fields.pvd` and `tools.pvd`. Every file
   * appears whole or not at all; a row of the history is written at once. All functions are
   * collective.
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

    /// Writes the fields of the present state unless they are there.
    void write_fields(const State &state);

    const std::string &directory() const
    {
      return folder;
    }

    /// How far the folder has come.
    const ResultsProgress &progress() const
    {
      return done;
    }

  private:
    void start_folder(const Provenance &provenance);
    void continue_folder(const State &state, const Provenance &provenance);
    bool fields_due(const State &state, const StepRecord &record) const;
    void write_collections() const;

    const scene::Scene    &scene;
    std::string            folder;
    std::optional<CsvFile> history; ///< first rank only
    ResultsProgress        done;    ///< rows and files of the tools: first rank only
  };

  /// Makes the folder if it is not there. First rank only. @throws InputError
  void make_folder(const std::string &folder);

  /// Takes away what a run writes to its folder, as far as it is there; no other files. First rank
  /// only.
  void remove_results(const std::string &folder);

  /// Column names of history.csv.
  std::vector<std::string> history_columns(const scene::Scene &scene);

  /// The figures of a step in the order of the columns.
  std::vector<double>
  history_row(const scene::Scene &scene, const StepRecord &record, double wall_seconds);

  /// Writes the fields of the state in its present configuration as one VTU file. Collective.
  void write_vtu(const State &state, const std::string &path);

  /// Writes the outlines of the tools at a time as a VTU file of lines (first rank only).
  void write_tools(const scene::Scene &scene, double time, const std::string &path);
} // namespace axiforge::output
