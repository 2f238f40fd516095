// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cstdint>
#include <new>

#include <deal.II/base/mpi.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>

namespace axiforge
{
  void on_first_rank(const MPI_Comm communicator, const std::function<void()> &action)
  {
    enum Outcome
    {
      done,
      input_error,
      computation_error,
      no_memory,
      other
    };
    std::pair<int, std::string> outcome(done, "");
    if (dealii::Utilities::MPI::this_mpi_process(communicator) == 0)
      try
        {
          action();
        }
      catch (const InputError &error)
        {
          outcome = { input_error, error.what() };
        }
      catch (const ComputationError &error)
        {
          outcome = { computation_error, error.what() };
        }
      catch (const std::bad_alloc &)
        {
          outcome = { no_memory, "" };
        }
      catch (const std::exception &error)
        {
          outcome = { other, error.what() };
        }
    outcome = dealii::Utilities::MPI::broadcast(communicator, outcome, 0);
    switch (outcome.first)
      {
      case input_error:
        throw InputError(outcome.second);
      case computation_error:
        throw ComputationError(outcome.second);
      case no_memory:
        throw std::bad_alloc();
      case other:
        throw std::runtime_error(outcome.second);
      default:
        return;
      }
  }


  namespace
  {
    /// MPI counts in int: long texts go in pieces.
    template <typename Action> void in_pieces(std::string &text, const Action &action)
    {
      constexpr std::size_t piece = std::size_t(1) << 28;
      for (std::size_t begin = 0; begin < text.size(); begin += piece)
        action(text.data() + begin, static_cast<int>(std::min(piece, text.size() - begin)));
    }
  } // namespace


  std::vector<std::string> gather_on_first_rank(const MPI_Comm     communicator,
                                                const std::string &mine)
  {
    namespace MPI            = dealii::Utilities::MPI;
    const unsigned int first = 0, n_ranks = MPI::n_mpi_processes(communicator);
    const int          size_tag = 1, text_tag = 2;
    std::string        text(mine);
    if (MPI::this_mpi_process(communicator) != first)
      {
        const std::uint64_t size = text.size();
        MPI_Send(&size, 1, MPI_UINT64_T, first, size_tag, communicator);
        in_pieces(text, [&](char *data, const int n) {
          MPI_Send(data, n, MPI_CHAR, first, text_tag, communicator);
        });
        return {};
      }
    std::vector<std::string> texts = { text };
    for (unsigned int rank = 1; rank < n_ranks; ++rank)
      {
        std::uint64_t size = 0;
        MPI_Recv(&size, 1, MPI_UINT64_T, rank, size_tag, communicator, MPI_STATUS_IGNORE);
        text.resize(size);
        in_pieces(text, [&](char *data, const int n) {
          MPI_Recv(data, n, MPI_CHAR, rank, text_tag, communicator, MPI_STATUS_IGNORE);
        });
        texts.push_back(text);
      }
    return texts;
  }


  void share_text_of_first_rank(const MPI_Comm communicator, std::string &text)
  {
    std::uint64_t size = text.size();
    MPI_Bcast(&size, 1, MPI_UINT64_T, 0, communicator);
    text.resize(size);
    in_pieces(text,
              [&](char *data, const int n) { MPI_Bcast(data, n, MPI_CHAR, 0, communicator); });
  }
} // namespace axiforge
