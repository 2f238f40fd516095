// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <mpi.h>

namespace axiforge
{
  /**
   * Runs an action on the first rank while the others wait. An InputError, a ComputationError or
   * another std::exception (as std::runtime_error) that it throws is thrown on all ranks, so that
   * none waits for ever. Collective.
   */
  void on_first_rank(MPI_Comm communicator, const std::function<void()> &action);

  /// The texts of all ranks on the first one, in the order of the ranks; nothing on the others.
  /// They may be long and hold any bytes. Collective.
  std::vector<std::string> gather_on_first_rank(MPI_Comm communicator, const std::string &mine);

  /// Replaces the text by that of the first rank. Collective.
  void share_text_of_first_rank(MPI_Comm communicator, std::string &text);
} // namespace axiforge
