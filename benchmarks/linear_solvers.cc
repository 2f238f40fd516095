// SPDX-License-Identifier: GPL-2.0-or-later
// linear_solvers SCENE.prm MOST_ITERATIONS ["Section/Entry = value" ...]
//
// One velocity solve of a scene in which conjugate gradients with several preconditioners meet the
// same matrices as the direct solver: CSV on standard output, one row for each matrix and
// preconditioner. The flow solver is the program's own; only its linear system is another one: this
// file has a make_linear_system(), and the linker takes no second one from the library.
#include <ctime>
#include <functional>
#include <iostream>

#include <Eigen/CholmodSupport>
#include <Eigen/IterativeLinearSolvers>
#include <Epetra_CrsMatrix.h>
#include <Epetra_Map.h>
#include <Epetra_MpiComm.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>

#include <axiforge/base/blas.h>
#include <axiforge/base/parameter_file.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/meshing/workpiece_mesh.h>
#include <axiforge/solvers/flow_solver.h>

using namespace axiforge;

namespace
{
  using Matrix         = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  using Vector         = Eigen::VectorXd;
  using Preconditioner = std::function<Vector(const Vector &)>;
  using Direct         = Eigen::CholmodSupernodalLLT<Matrix, Eigen::Lower>;

  constexpr double loose = 1e-3, tight = 1e-6; // of the residual
  int              most_iterations = 2000;

  double cpu_seconds()
  {
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
  }

  struct Convergence
  {
    int    loose_iterations = -1, tight_iterations = -1; ///< -1: not reached
    double residual = 1;                                 ///< at the end, relative
    double seconds  = 0;
  };

  /// Preconditioned conjugate gradients from 0.
  Convergence
  conjugate_gradients(const Matrix &A, const Vector &b, const Preconditioner &preconditioner)
  {
    Convergence  result;
    const double begin = cpu_seconds();
    Vector       x = Vector::Zero(b.size()), r = b, z = preconditioner(r), p = z;
    double       rz = r.dot(z);
    for (int k = 1; k <= most_iterations && result.tight_iterations < 0; ++k)
      {
        const Vector Ap    = A.selfadjointView<Eigen::Lower>() * p;
        const double alpha = rz / p.dot(Ap);
        x += alpha * p;
        r -= alpha * Ap;
        result.residual = r.norm() / b.norm();
        if (result.residual < loose && result.loose_iterations < 0)
          result.loose_iterations = k;
        if (result.residual < tight)
          result.tight_iterations = k;
        z                 = preconditioner(r);
        const double next = r.dot(z);
        p                 = z + (next / rz) * p;
        rz                = next;
      }
    result.seconds = cpu_seconds() - begin;
    return result;
  }


  /// Smoothed aggregation of Trilinos' ML, two unknowns for each node.
  class Multigrid
  {
  public:
    explicit Multigrid(const Matrix &lower)
        : map(static_cast<int>(lower.rows()), 0, communicator)
        , matrix(Copy, map, 0)
    {
      const Matrix full = lower.selfadjointView<Eigen::Lower>();
      for (int j = 0; j < full.cols(); ++j)
        matrix.InsertGlobalValues(j, full.outerIndexPtr()[j + 1] - full.outerIndexPtr()[j],
                                  full.valuePtr() + full.outerIndexPtr()[j],
                                  full.innerIndexPtr() + full.outerIndexPtr()[j]);
      matrix.FillComplete();
      Teuchos::ParameterList list;
      ML_Epetra::SetDefaults("SA", list);
      list.set("ML output", 0);
      list.set("PDE equations", 2);
      list.set("smoother: type", "symmetric Gauss-Seidel");
      list.set("smoother: sweeps", 2);
      list.set("coarse: type", "Amesos-KLU");
      multigrid = std::make_unique<ML_Epetra::MultiLevelPreconditioner>(matrix, list);
    }

    Vector operator()(const Vector &r) const
    {
      Vector        result(r.size());
      Epetra_Vector in(View, map, const_cast<double *>(r.data())), out(View, map, result.data());
      multigrid->ApplyInverse(in, out);
      return result;
    }

  private:
    Epetra_MpiComm                                       communicator{ MPI_COMM_SELF };
    Epetra_Map                                           map;
    Epetra_CrsMatrix                                     matrix;
    std::unique_ptr<ML_Epetra::MultiLevelPreconditioner> multigrid;
  };


  /// Solves directly, so that Newton's method goes its way, and lets the others try the same
  /// matrix.
  class ComparingSystem : public solvers::LinearSystem
  {
  public:
    ComparingSystem(const State &state, const solvers::SystemNodes &nodes)
        : row_of_node(state.tables.n_nodes, -1)
        , nodes(nodes)
    {
      int n = 0;
      for (const auto &cell : nodes)
        for (const unsigned int node : cell)
          if (row_of_node[node] < 0)
            row_of_node[node] = n++;
      n_rows = 2 * n;
      std::cout << "iteration,unknowns,solver,set_up_s,solve_s,iterations_1e-3,iterations_1e-6,"
                   "residual,entries,operations"
                << std::endl;
    }

    void clear() override
    {
      entries.clear();
      right_hand_side = Vector::Zero(n_rows);
    }

    void add(const unsigned int cell, const double *values, const double *rhs) override
    {
      const unsigned int m   = nodes[cell].size();
      const auto         row = [&](const unsigned int i) {
        return 2 * row_of_node[nodes[cell][i / 2]] + static_cast<int>(i % 2);
      };
      for (unsigned int i = 0; i < 2 * m; ++i)
        {
          right_hand_side[row(i)] += rhs[i];
          for (unsigned int j = 0; j < 2 * m; ++j)
            if (row(i) >= row(j))
              entries.emplace_back(row(i), row(j), values[2 * m * i + j]);
        }
    }

    bool solve(Field &solution) override
    {
      Matrix A(n_rows, n_rows);
      A.setFromTriplets(entries.begin(), entries.end());
      ++iteration;

      // One factor for the first iteration, which is kept, and one for all others.
      std::unique_ptr<Direct> &direct = iteration == 1 ? old : present;
      if (!direct)
        {
          direct                 = std::make_unique<Direct>();
          cholmod_common &common = direct->cholmod();

          common.nmethods           = 1;
          common.method[0].ordering = CHOLMOD_METIS;
          direct->analyzePattern(A);
        }
      double begin = cpu_seconds();
      direct->factorize(A);
      if (direct->info() != Eigen::Success)
        return false;
      const double factor_s = cpu_seconds() - begin;
      begin                 = cpu_seconds();
      const Vector x        = direct->solve(right_hand_side);
      std::cout << iteration << ',' << n_rows << ",direct," << factor_s << ','
                << cpu_seconds() - begin << ",,,"
                << (A.selfadjointView<Eigen::Lower>() * x - right_hand_side).norm() /
                       right_hand_side.norm()
                << ',' << direct->cholmod().lnz << ',' << direct->cholmod().fl << std::endl;
      if (iteration == 4)
        compare(A);

      solution = 0;
      for (unsigned int node = 0; node < row_of_node.size(); ++node)
        if (row_of_node[node] >= 0)
          for (unsigned int c = 0; c < 2; ++c)
            solution.local_element(2 * node + c) = x[2 * row_of_node[node] + c];
      return true;
    }

    std::string name() const override
    {
      return "comparison";
    }

  private:
    void compare(const Matrix &A)
    {
      const Vector diagonal = A.diagonal();
      attempt("jacobi", A, [&]() -> Preconditioner {
        return [&](const Vector &r) -> Vector { return r.cwiseQuotient(diagonal); };
      });
      attempt("incomplete cholesky", A, [&]() -> Preconditioner {
        const auto ic = std::make_shared<Eigen::IncompleteCholesky<double, Eigen::Lower>>(A);
        if (ic->info() != Eigen::Success)
          return {};
        return [ic](const Vector &r) -> Vector { return ic->solve(r); };
      });
      attempt("multigrid", A, [&]() -> Preconditioner {
        const auto multigrid = std::make_shared<Multigrid>(A);
        return [multigrid](const Vector &r) { return (*multigrid)(r); };
      });
      attempt("factor of the first iteration", A, [&]() -> Preconditioner {
        return [&](const Vector &r) -> Vector { return old->solve(r); };
      });
    }

    void attempt(const std::string                     &name,
                 const Matrix                          &A,
                 const std::function<Preconditioner()> &make) const
    {
      const double         begin          = cpu_seconds();
      const Preconditioner preconditioner = make();
      const double         set_up         = cpu_seconds() - begin;
      Convergence          c;
      if (preconditioner)
        c = conjugate_gradients(A, right_hand_side, preconditioner);
      std::cout << iteration << ',' << n_rows << ',' << name << ',' << set_up << ',' << c.seconds
                << ',' << c.loose_iterations << ',' << c.tight_iterations << ',' << c.residual
                << ",," << std::endl;
    }

    std::vector<int>                    row_of_node;
    solvers::SystemNodes                nodes;
    std::vector<Eigen::Triplet<double>> entries;
    Vector                              right_hand_side;
    int                                 iteration = 0;
    std::unique_ptr<Direct>             old, present;
  };
} // namespace


std::unique_ptr<solvers::LinearSystem> axiforge::solvers::make_linear_system(
    const std::string &, const std::string &, const State &state, const SystemNodes &nodes)
{
  return std::make_unique<ComparingSystem>(state, nodes);
}


int main(int argc, char **argv)
{
  if (argc < 3)
    {
      std::cerr << "linear_solvers SCENE.prm MOST_ITERATIONS [\"Section/Entry = value\" ...]\n";
      return 1;
    }
  use_suitable_blas();
  int                                      one = 1;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(one, argv, 1);
  use_one_thread();
  most_iterations = std::stoi(argv[2]);
  try
    {
      const scene::SceneParameters parameters(
          ParameterFile(argv[1], std::vector<std::string>(argv + 3, argv + argc)));
      meshing::WorkpieceMesh mesh =
          meshing::read_workpiece(parameters.workpiece, "Workpiece", parameters.directory);
      const scene::Scene scene(parameters, meshing::outline_of(mesh));
      State              state(MPI_COMM_WORLD);
      meshing::make_initial_state(mesh, parameters.workpiece.refinement_levels, state);
      solvers::FlowSolver       solver(scene, state);
      const solvers::FlowResult result = solver.solve(0.04); // a hundredth of a millimetre
      std::cerr << (result.converged ? "converged" : "failed: " + result.failure) << " in "
                << result.record.iterations << " iterations\n";
    }
  catch (const std::exception &error)
    {
      std::cerr << error.what() << '\n';
      return 1;
    }
}
