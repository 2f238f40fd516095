// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <deal.II/base/mpi.h>

#include <axiforge/meshing/workpiece_mesh.h>
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
    unsigned int             stop_after       = 0;     ///< steps, for who wants no more; 0: the end
    std::string              version, revision, command_line;

    OnStep on_step;
  };

  /// A workpiece in its place and all that is known and checked before the first step.
  struct Start
  {
    std::unique_ptr<scene::Scene> scene;
    scene::WorkpieceOutline       outline;
    std::vector<std::string>      notes; ///< what is allowed but doubtful
  };

  /**
   * Places the workpiece for an operation, makes its scene and checks one against the other; the
   * time of the state becomes that of the first contact. Collective.
   * @param fresh the mesh that the state has been made of, null for a workpiece that has been
   * formed
   * @throws InputError
   */
  Start start_operation(const scene::SceneParameters &operation,
                        const meshing::WorkpieceMesh *fresh,
                        State                        &state);

  /**
   * Everything about the operations after the first that does not take the shape of the workpiece
   * by then: laws, tables, profiles, ends, names. @param outline of the workpiece at the start
   * @throws InputError
   */
  void check_later_operations(const std::vector<scene::SceneParameters> &operations,
                              scene::WorkpieceOutline                    outline);

  /**
   * Reads the scene and runs it: its operations one after the other. Collective.
   * @throws InputError, ComputationError
   */
  void run(const RunOptions &options, MPI_Comm communicator);
} // namespace axiforge::process
