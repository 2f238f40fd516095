// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace axiforge
{
  /**
   * Tells Open MPI that a process which nobody launched (no mpirun, no batch system) stays alone:
   * it then starts no daemon beside it and opens no drivers of networks (which takes 0.2 s). Call
   * it before MPI starts. A setting of the user wins; another MPI does not look at it.
   */
  void expect_single_process();
} // namespace axiforge
