// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>

#include <Eigen/Core>

namespace axiforge::solvers
{
  using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd &)>;

  /**
   * Condition number (2-norm) of a symmetric positive definite matrix A whose rows and columns are
   * scaled to a unit diagonal, D^-1/2 A D^-1/2: within a factor n of the least that any diagonal
   * scaling gives (van der Sluis 1969), and the same for Cholesky's method, which does not feel the
   * scaling. Both ends of the spectrum are Ritz values of Lanczos' method, so the estimate lies
   * below the true number, by some per cent as a rule.
   */
  double estimate_condition(const Eigen::VectorXd &diagonal,
                            const LinearMap       &multiply,
                            const LinearMap       &solve);
} // namespace axiforge::solvers
