// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/base/input_files.h>

namespace axiforge::output
{
  /// What is kept beside the results so that they can be made again.
  struct Provenance
  {
    std::string              input;       ///< the .prm as given, included files and overrides in it
    std::string              parameters;  ///< all entries in effect
    std::string              versions;    ///< program, revision, libraries, command line
    InputFiles               files;       ///< geometries and tables
    std::vector<std::string> scene_files; ///< the .prm itself and those it includes

    /// Of the copies of the files, from where input.prm is.
    std::string folder_of_files = "input";
  };

  /**
   * One run at a time writes to a folder. First rank only. A run that is killed leaves nothing that
   * keeps the next one out. Where the file system knows no locks it does nothing.
   */
  class FolderLock
  {
  public:
    /// Makes the folder if it is not there. @throws InputError if another run has it
    explicit FolderLock(const std::string &folder);
    FolderLock(const FolderLock &) = delete;
    /// Takes the folder away again if it has made it and nothing was written to it.
    ~FolderLock();

  private:
    std::vector<std::string> made; ///< folders, from the outermost
    std::string              path;
    int                      descriptor = -1;
  };

  /// Makes the folder if it is not there. First rank only. @throws InputError
  void make_folder(const std::string &folder);

  /**
   * Before a new run writes to the folder: what has the name of a result must be one.
   * First rank only.
   * @throws InputError if the folder has files with names of results but is no folder of results,
   * or if a file that the scene needs would be overwritten. input.prm and parameters.prm may be the
   * scene itself: they stay as they are.
   */
  void check_folder(const std::string &folder, const Provenance &provenance);

  /// Takes away what a run writes to its folder, as far as it is there; no other files. First rank
  /// only.
  void remove_results(const std::string &folder);

  /// Takes away the files of the fields that are not in the list, and what a killed run has left
  /// half-written. First rank only.
  void remove_fields(const std::string &folder, const std::vector<std::string> &kept);

  /// Writes input.prm and parameters.prm unless they are the scene itself, and versions.txt. First
  /// rank only.
  void write_provenance(const std::string &folder, const Provenance &provenance);

  /// The files of a scene: itself, and what its lines `include` name.
  std::vector<std::string> files_of_scene(const std::string &parameter_file);
} // namespace axiforge::output
