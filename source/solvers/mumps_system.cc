// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/timer.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/sparsity_tools.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <Amesos.h>
#include <Amesos_BaseSolver.h>
#include <Epetra_LinearProblem.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>

#include <axiforge/base/errors.h>
#include <axiforge/base/phases.h>
#include <axiforge/solvers/linear_system.h>

namespace axiforge::solvers
{
  namespace
  {
    /**
     * MUMPS through Trilinos' Amesos, on any number of ranks. The rows are those of the velocity
     * field: condensed and constrained unknowns keep a row of their own with 1 on the diagonal, so
     * that no second numbering is needed.
     */
    class MumpsSystem : public LinearSystem
    {
    public:
      MumpsSystem(const State &state, const SystemNodes &nodes)
      {
        const auto            &partitioner = *state.velocity.get_partitioner();
        const auto            &owned       = state.flow_dofs.locally_owned_dofs();
        const dealii::IndexSet relevant =
            dealii::DoFTools::extract_locally_relevant_dofs(state.flow_dofs);

        dealii::DynamicSparsityPattern pattern(relevant);
        used.assign(partitioner.locally_owned_size(), 0);
        Field touched(state.velocity);
        touched = 0;
        cell_rows.resize(nodes.size());
        for (unsigned int cell = 0; cell < nodes.size(); ++cell)
          {
            for (const unsigned int node : nodes[cell])
              for (unsigned int c = 0; c < 2; ++c)
                {
                  cell_rows[cell].push_back(partitioner.local_to_global(2 * node + c));
                  touched.local_element(2 * node + c) = 1;
                }
            for (const auto row : cell_rows[cell])
              pattern.add_entries(row, cell_rows[cell].begin(), cell_rows[cell].end());
          }
        touched.compress(dealii::VectorOperation::add);
        for (const auto row : owned)
          pattern.add(row, row);
        dealii::SparsityTools::distribute_sparsity_pattern(pattern, owned, state.communicator,
                                                           relevant);
        matrix.reinit(owned, owned, pattern, state.communicator);
        right_hand_side.reinit(state.velocity);

        first_row = partitioner.local_range().first;
        for (unsigned int i = 0; i < used.size(); ++i)
          used[i] = touched.local_element(i) > 0;
        n_rows = state.flow_dofs.n_dofs();

        x       = std::make_unique<Epetra_Vector>(matrix.trilinos_matrix().DomainMap());
        b       = std::make_unique<Epetra_Vector>(matrix.trilinos_matrix().RangeMap());
        problem = std::make_unique<Epetra_LinearProblem>(
            const_cast<Epetra_CrsMatrix *>(&matrix.trilinos_matrix()), x.get(), b.get());
        solver.reset(Amesos().Create("Amesos_Mumps", *problem));
        if (!solver)
          throw ComputationError(
              "This Trilinos has no MUMPS (Amesos): run on one rank with cholmod.");
        Teuchos::ParameterList parameters;
        // The matrix is positive definite: no pivoting, which fills in more than MUMPS has provided
        // for (INFOG(1) = -9 in short first steps) and takes half of the time.
        parameters.sublist("mumps").set("CNTL(1)", 0.);
        parameters.sublist("mumps").set("ICNTL(14)", 200);
        solver->SetParameters(parameters);
      }

      void clear() override
      {
        matrix          = 0;
        right_hand_side = 0;
      }

      void add(const unsigned int cell, const double *values, const double *rhs) override
      {
        const auto &rows = cell_rows[cell];
        for (unsigned int i = 0; i < rows.size(); ++i)
          {
            matrix.add(rows[i], rows.size(), rows.data(), values + i * rows.size(), false);
            right_hand_side(rows[i]) += rhs[i];
          }
      }

      bool solve(Field &solution) override
      {
        for (unsigned int i = 0; i < used.size(); ++i)
          if (!used[i])
            matrix.add(first_row + i, first_row + i, 1.);
        matrix.compress(dealii::VectorOperation::add);
        right_hand_side.compress(dealii::VectorOperation::add);
        for (unsigned int i = 0; i < used.size(); ++i)
          (*b)[i] = right_hand_side.local_element(i);

        dealii::Timer timer;
        if (!analysed)
          {
            const Phase phase("analysis");
            if (solver->SymbolicFactorization() != 0)
              throw ComputationError("MUMPS could not analyse the pattern of the matrix.");
            analysed = true;
            analyse_seconds += timer.wall_time();
            timer.restart();
          }
        {
          const Phase phase("factorisation");
          if (solver->NumericFactorization() != 0)
            return false;
        }
        factor_seconds += timer.wall_time();
        const Phase phase("triangular solves");
        timer.restart();
        if (solver->Solve() != 0)
          return false;
        solve_seconds += timer.wall_time();
        solution = 0;
        for (unsigned int i = 0; i < used.size(); ++i)
          solution.local_element(i) = used[i] ? (*x)[i] : 0.;
        return true;
      }

      std::string name() const override
      {
        return "mumps";
      }

    private:
      std::vector<std::vector<dealii::types::global_dof_index>> cell_rows;
      std::vector<char>                      used; ///< owned row is in the system
      dealii::types::global_dof_index        first_row;
      dealii::TrilinosWrappers::SparseMatrix matrix;
      Field                                  right_hand_side;
      std::unique_ptr<Epetra_Vector>         x, b;
      std::unique_ptr<Epetra_LinearProblem>  problem;
      std::unique_ptr<Amesos_BaseSolver>     solver;
      bool                                   analysed = false;
    };
  } // namespace


  std::unique_ptr<LinearSystem> make_mumps_system(const State &state, const SystemNodes &nodes)
  {
    return std::make_unique<MumpsSystem>(state, nodes);
  }
} // namespace axiforge::solvers
