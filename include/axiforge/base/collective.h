// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>

#include <mpi.h>

namespace axiforge
{
  /**
   * Runs an action on the first rank while the others wait. An InputError, a ComputationError or
   * another std::exception (as std::runtime_error) that it throws is thrown on all ranks, so that
   * none waits for ever. Collective.
   */
  void on_first_rank(MPI_Comm communicator, const std::function<void()> &action);
} // namespace axiforge
