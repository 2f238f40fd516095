// SPDX-License-Identifier: GPL-2.0-or-later
#include <numeric>

#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/phases.h>
#include <axiforge/solvers/cholmod_system.h>
#include <axiforge/solvers/linear_system.h>

namespace axiforge::solvers
{
  std::unique_ptr<LinearSystem> make_mumps_system(const State &state, const SystemNodes &nodes);

  namespace
  {
    namespace MPI = dealii::Utilities::MPI;

    /**
     * CHOLMOD on the first rank. The others keep the matrices of their cells (lower triangle, then
     * right-hand side), send them there and get their part of the solution back.
     */
    class FirstRankSystem : public LinearSystem
    {
    public:
      FirstRankSystem(const std::string &ordering, const State &state, const SystemNodes &nodes)
          : communicator(state.communicator)
          , is_first(MPI::this_mpi_process(communicator) == 0)
          , is_alone(MPI::n_mpi_processes(communicator) == 1)
      {
        const Phase   phase("analysis");
        dealii::Timer timer;
        const auto   &partitioner = *state.velocity.get_partitioner();

        std::vector<unsigned int> sizes, numbers; // of the nodes of all cells, in global numbers
        for (const auto &cell : nodes)
          {
            sizes.push_back(cell.size());
            for (const unsigned int node : cell)
              numbers.push_back(partitioner.local_to_global(2 * node) / 2);
          }
        rows_of_cell                  = gather_rows(communicator, sizes);
        numbers                       = gather_rows(communicator, numbers);
        n_own_cells                   = nodes.size();
        const unsigned int n_unknowns = state.n_unknowns();
        on_first_rank(communicator, [&] {
          CholmodSystem::Nodes all(rows_of_cell.size());
          auto                 next = numbers.begin();
          for (unsigned int cell = 0; cell < all.size(); ++cell)
            {
              all[cell].assign(next, next + rows_of_cell[cell]);
              next += rows_of_cell[cell];
            }
          solver = std::make_unique<CholmodSystem>(ordering, n_unknowns / 2, all);
          n_rows = solver->rows();
        });
        for (unsigned int &rows : rows_of_cell)
          rows *= 2;
        n_rows = MPI::max(n_rows, communicator);

        // What goes to and fro between the first rank and the others.
        const auto own = [&](const unsigned int n) {
          return gather_rows(communicator, std::vector<int>{ static_cast<int>(n) });
        };
        unknowns_of_rank = own(partitioner.locally_owned_size());
        first_unknown    = begins(unknowns_of_rank);
        solution_of_all.resize(is_first ? n_unknowns : 0);
        solution_of_rank.resize(partitioner.locally_owned_size());
        const unsigned int first_cell =
            begins(own(n_own_cells))[MPI::this_mpi_process(communicator)];
        if (!is_first)
          rows_of_cell = { rows_of_cell.begin() + first_cell,
                           rows_of_cell.begin() + first_cell + n_own_cells };
        unsigned int n_entries = 0;
        for (const unsigned int n : rows_of_cell)
          {
            first_entry.push_back(n_entries);
            n_entries += is_first && first_entry.size() <= n_own_cells ? 0 : n * (n + 3) / 2;
          }
        entries.resize(n_entries);
        entries_of_rank = own(is_first ? 0 : n_entries);
        analyse_seconds += timer.wall_time();
      }

      void clear() override
      {
        if (is_first)
          solver->clear();
      }

      void add(const unsigned int cell, const double *values, const double *rhs) override
      {
        const unsigned int n = rows_of_cell[cell];
        if (is_first)
          {
            solver->add(cell, values, n, rhs);
            return;
          }
        double *entry = entries.data() + first_entry[cell];
        for (unsigned int i = 0; i < n; ++i)
          entry = std::copy_n(values + i * n, i + 1, entry);
        std::copy_n(rhs, n, entry);
      }

      bool solve(Field &solution) override
      {
        dealii::Timer timer;
        int           done = 1;
        {
          const Phase phase("factorisation");
          gather_cells();
          if (is_first)
            done = solver->factorise();
        }
        factor_seconds += timer.wall_time();
        const Phase phase("triangular solves");
        timer.restart();
        if (is_first && done)
          done = solver->solve(solution_of_all.data());
        if (!is_alone)
          MPI_Bcast(&done, 1, MPI_INT, 0, communicator);
        if (done)
          share_solution(solution);
        solve_seconds += timer.wall_time();
        return done;
      }

      std::string name() const override
      {
        return "cholmod";
      }

      double condition() const override
      {
        // Nothing has been factorised yet, or it is elsewhere
        return is_first && factor_seconds > 0 ? solver->condition() : LinearSystem::condition();
      }

    private:
      static std::vector<int> begins(const std::vector<int> &counts)
      {
        std::vector<int> sums(counts.size(), 0);
        std::partial_sum(counts.begin(), counts.end() - 1, sums.begin() + 1);
        return sums;
      }

      /// Adds the cells of the other ranks to the matrix of the first one.
      void gather_cells()
      {
        if (is_alone)
          return;
        const std::vector<int> first = begins(entries_of_rank);
        MPI_Gatherv(is_first ? nullptr : entries.data(), is_first ? 0 : entries.size(), MPI_DOUBLE,
                    entries.data(), entries_of_rank.data(), first.data(), MPI_DOUBLE, 0,
                    communicator);
        if (!is_first)
          return;
        for (unsigned int cell = n_own_cells; cell < rows_of_cell.size(); ++cell)
          {
            const unsigned int n      = rows_of_cell[cell];
            const double      *packed = entries.data() + first_entry[cell];
            solver->add(cell, packed, 0, packed + n * (n + 1) / 2);
          }
      }

      void share_solution(Field &solution)
      {
        const double *mine = solution_of_all.data();
        if (!is_alone)
          {
            MPI_Scatterv(solution_of_all.data(), unknowns_of_rank.data(), first_unknown.data(),
                         MPI_DOUBLE, solution_of_rank.data(), solution_of_rank.size(), MPI_DOUBLE,
                         0, communicator);
            mine = solution_of_rank.data();
          }
        solution = 0;
        for (unsigned int i = 0; i < solution_of_rank.size(); ++i)
          solution.local_element(i) = mine[i];
      }

      MPI_Comm                       communicator;
      bool                           is_first, is_alone;
      std::unique_ptr<CholmodSystem> solver; ///< on the first rank

      // Of the own cells; on the first rank those of the others stand behind them.
      unsigned int              n_own_cells;
      std::vector<unsigned int> rows_of_cell, first_entry;
      std::vector<double>       entries; ///< of the cells that do not belong to the first rank

      std::vector<int>    entries_of_rank, unknowns_of_rank, first_unknown;
      std::vector<double> solution_of_all, solution_of_rank;
    };
  } // namespace


  std::unique_ptr<LinearSystem> make_linear_system(const std::string &kind,
                                                   const std::string &ordering,
                                                   const State       &state,
                                                   const SystemNodes &nodes)
  {
    // Beyond that the factor outgrows 32-bit indices and, before long, one machine.
    constexpr unsigned int most_on_one_rank = 3'000'000;
    if (kind == "cholmod" || (kind == "automatic" && state.n_unknowns() <= most_on_one_rank) ||
        (kind == "automatic" && MPI::n_mpi_processes(state.communicator) == 1))
      return std::make_unique<FirstRankSystem>(ordering, state, nodes);
    return make_mumps_system(state, nodes);
  }
} // namespace axiforge::solvers
