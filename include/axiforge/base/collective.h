// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <string>
#include <type_traits>
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

  /// The rows of all ranks on all of them, one rank after the other. (deal.II's all_gather
  /// compresses what it sends, which takes longer than all else here.) Collective.
  template <typename Row>
  std::vector<Row> gather_rows(const MPI_Comm communicator, const std::vector<Row> &mine)
  {
    static_assert(std::is_trivially_copyable<Row>::value, "rows are sent as they lie in memory");
    int n_ranks = 1, n_mine = mine.size(), n_all = 0;
    MPI_Comm_size(communicator, &n_ranks);
    std::vector<int> counts(n_ranks), begins(n_ranks);
    MPI_Allgather(&n_mine, 1, MPI_INT, counts.data(), 1, MPI_INT, communicator);
    for (int rank = 0; rank < n_ranks; ++rank)
      {
        begins[rank] = n_all;
        n_all += counts[rank];
      }
    std::vector<Row> all(n_all);
    MPI_Datatype     row;
    MPI_Type_contiguous(sizeof(Row), MPI_BYTE, &row);
    MPI_Type_commit(&row);
    MPI_Allgatherv(mine.data(), n_mine, row, all.data(), counts.data(), begins.data(), row,
                   communicator);
    MPI_Type_free(&row);
    return all;
  }

  /// Replaces the text by that of the first rank. Collective.
  void share_text_of_first_rank(MPI_Comm communicator, std::string &text);
} // namespace axiforge
