// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include <axiforge/solvers/condition.h>

namespace axiforge::solvers
{
  namespace
  {
    constexpr unsigned int lanczos_steps = 40;

    /// Largest eigenvalue by Lanczos' method with full orthogonalisation.
    double largest_eigenvalue(const Eigen::Index n, const LinearMap &apply)
    {
      const unsigned int steps = std::min<Eigen::Index>(lanczos_steps, n);
      Eigen::VectorXd    q(n), diagonal(steps), beside(steps);
      for (Eigen::Index i = 0; i < n; ++i)
        q[i] = 1 + 0.5 * std::sin(12.9898 * (i + 1.)); // no symmetry of the mesh in it
      q.normalize();
      std::vector<Eigen::VectorXd> basis;
      unsigned int                 k = 0;
      while (k < steps)
        {
          basis.push_back(q);
          Eigen::VectorXd w = apply(q);
          diagonal[k]       = q.dot(w);
          for (unsigned int pass = 0; pass < 2; ++pass)
            for (const Eigen::VectorXd &b : basis)
              w -= b.dot(w) * b;
          beside[k] = w.norm();
          if (!(beside[k++] > 1e-14 * std::abs(diagonal[0])))
            break; // an invariant subspace
          q = w / beside[k - 1];
        }
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
      ritz.computeFromTridiagonal(diagonal.head(k), beside.head(k - 1), Eigen::EigenvaluesOnly);
      return ritz.eigenvalues()[k - 1];
    }
  } // namespace


  double estimate_condition(const Eigen::VectorXd &diagonal,
                            const LinearMap       &multiply,
                            const LinearMap       &solve)
  {
    const Eigen::ArrayXd root = diagonal.array().sqrt();
    const double         largest =
        largest_eigenvalue(diagonal.size(), [&](const Eigen::VectorXd &x) -> Eigen::VectorXd {
          return multiply((x.array() / root).matrix()).array() / root;
        });
    const double inverse =
        largest_eigenvalue(diagonal.size(), [&](const Eigen::VectorXd &x) -> Eigen::VectorXd {
          return solve((x.array() * root).matrix()).array() * root;
        });
    return largest * inverse;
  }
} // namespace axiforge::solvers
