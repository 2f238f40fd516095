// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include <deal.II/base/mpi.h>

namespace axiforge
{
  /**
   * Tells Open MPI that a process which nobody launched (no mpirun, no batch system) stays alone:
   * it then starts no daemon beside it, opens no drivers of networks (which takes 0.2 s), and makes
   * no session folder. All single processes of a user would share that folder, and whoever ends
   * takes it away under the feet of those that start: one start in a hundred fails for it on a busy
   * machine. Without it TMPDIR need not be writable either. Call it before MPI starts. A setting of
   * the user wins; another MPI does not look at it.
   */
  void expect_single_process();

  /**
   * Starts MPI with one thread, for as long as what it returns is there. What the caller had set
   * for SIGHUP and SIGPIPE stays: PETSc, which deal.II starts, puts them back to their defaults,
   * and a run under nohup would end with its terminal. A pipe that nobody reads any more does not
   * end the program; who wants to know sets a handler of its own.
   *
   * Where MPI itself fails it ends the process with status 1, which here means bad input: that
   * becomes status 3, with a message.
   */
  std::unique_ptr<dealii::Utilities::MPI::MPI_InitFinalize> start_mpi(int &argc, char **&argv);
} // namespace axiforge
