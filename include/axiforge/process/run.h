// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <deal.II/base/mpi.h>

#include <axiforge/process/operation.h>

namespace axiforge::process
{
  /// What the command line says.
  struct RunOptions
  {
    std::string              parameter_file;
    std::vector<std::string> overrides;        ///< "Section/Entry = value"
    std::string              output_directory; ///< empty: as the scene says
    bool                     resume = false;   ///< continue from a checkpoint
    std::string              resume_from;      ///< folder or file; empty: the folder of the results
    bool                     validate         = false; ///< read and check everything, run nothing
    bool                     print_parameters = false;
    bool                     quiet            = false; ///< no progress lines
    bool                     timing           = false; ///< a table of where the time went
    std::string              version, revision, command_line;

    OnStep on_step;
  };

  /**
   * Reads the scene and runs it: its operations one after the other. Collective.
   * @throws InputError, ComputationError
   */
  void run(const RunOptions &options, MPI_Comm communicator);
} // namespace axiforge::process
