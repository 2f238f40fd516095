// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <axiforge/state/state.h>

namespace axiforge::solvers
{
  /// The nodes (local numbers) that the matrix of one locally owned cell is assembled to.
  using SystemNodes = std::vector<std::vector<unsigned int>>;

  /**
   * The symmetric positive definite system of one Newton iteration. Its pattern is made once per
   * mesh; the symbolic factorisation is kept while the pattern stands.
   */
  class LinearSystem
  {
  public:
    virtual ~LinearSystem() = default;

    /// Sets matrix and right-hand side to zero.
    virtual void clear() = 0;

    /**
     * Adds the matrix (2m x 2m, rows one after the other, symmetric) and right-hand side of a cell
     * whose m system nodes were given at the start.
     */
    virtual void add(unsigned int cell, const double *matrix, const double *rhs) = 0;

    /// Factorises and solves; the solution has its owned entries set, those of condensed or
    /// constrained nodes zero. Returns false if the matrix is not positive definite.
    virtual bool solve(Field &solution) = 0;

    virtual std::string name() const = 0;

    /// Estimated condition number of the last matrix, scaled to a unit diagonal; nan: not known.
    virtual double condition() const
    {
      return std::numeric_limits<double>::quiet_NaN();
    }

    double      factor_seconds  = 0; ///< numeric factorisation, summed over all calls
    double      solve_seconds   = 0;
    double      analyse_seconds = 0;
    std::size_t n_rows          = 0; ///< unknowns of the system
  };

  /**
   * @param kind "cholmod", "mumps" or "automatic"
   * @param ordering "amd", "nested dissection" or "automatic" (cholmod only)
   */
  std::unique_ptr<LinearSystem> make_linear_system(const std::string &kind,
                                                   const std::string &ordering,
                                                   const State       &state,
                                                   const SystemNodes &nodes);
} // namespace axiforge::solvers
