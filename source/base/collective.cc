// SPDX-License-Identifier: GPL-2.0-or-later
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
      case other:
        throw std::runtime_error(outcome.second);
      default:
        return;
      }
  }
} // namespace axiforge
