// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>

namespace axiforge::solvers
{
  /**
   * CHOLMOD's supernodal Cholesky factorisation, assembled straight into its storage. Knows nodes
   * with two unknowns each and cells that couple them, and nothing else of the mesh; lives on one
   * rank.
   */
  class CholmodSystem
  {
  public:
    using Nodes = std::vector<std::vector<unsigned int>>; ///< of each cell

    /**
     * Makes the pattern and analyses it. Throws ComputationError if it is too large.
     * @param ordering "amd", "nested dissection" or "automatic"
     * @param nodes of each cell, numbers below n_nodes; nodes in no cell are not in the system
     */
    CholmodSystem(const std::string &ordering, unsigned int n_nodes, const Nodes &nodes);

    CholmodSystem(const CholmodSystem &) = delete;

    /// Sets matrix and right-hand side to zero.
    void clear();

    /// Adds the lower triangle of a cell's symmetric matrix, rows one after the other with @p width
    /// entries from one to the next, or packed (row i has i + 1 entries) if that is 0.
    void add(unsigned int cell, const double *matrix, unsigned int width, const double *rhs);

    /// False: the matrix is not positive definite.
    bool factorise();

    /// Solves into @p solution [2 n_nodes]; unknowns that are not in the system are 0. False if it
    /// is not finite.
    bool solve(double *solution);

    /// Estimated condition number of the last matrix, scaled to a unit diagonal.
    double condition() const;

    unsigned int rows() const
    {
      return n_rows;
    }

  private:
    using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

    void number_rows(const std::string &ordering, unsigned int n_nodes, const Nodes &nodes);
    static std::vector<int>
    places(const std::string &ordering, const Nodes &nodes, const std::vector<int> &number, int n);
    void make_pattern();

    /// @throws std::bad_alloc if CHOLMOD has run out of memory
    void check_memory();

    unsigned int                  n_rows;
    std::vector<int>              row_of_unknown; ///< -1: not in the system
    std::vector<std::vector<int>> cell_rows;
    std::vector<int>              positions; ///< in the matrix' values, lower triangle of each cell
    std::vector<std::size_t>      first_position;
    SparseMatrix                  matrix; ///< lower triangle
    Eigen::VectorXd               right_hand_side;
    Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> solver;
  };
} // namespace axiforge::solvers
