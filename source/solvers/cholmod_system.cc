// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <limits>
#include <new>

#include <axiforge/base/errors.h>
#include <axiforge/solvers/cholmod_system.h>
#include <axiforge/solvers/condition.h>

namespace axiforge::solvers
{
  CholmodSystem::CholmodSystem(const std::string &ordering,
                               const unsigned int n_nodes,
                               const Nodes       &nodes)
  {
    number_rows(ordering, n_nodes, nodes);
    make_pattern();

    // The rows stand in their final order: CHOLMOD then factorises the matrix as it is, without
    // a permuted copy each time.
    cholmod_common &common    = solver.cholmod();
    common.nmethods           = 1;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.postorder          = 0;
    common.print = 0; // a matrix that is not positive definite is the caller's to report
    // Supernodes are merged more readily than by default (4, 16, 48; 0.8, 0.1, 0.05): with up
    // to so many columns, or as long as this share of zeros is not passed. A fifth less time
    // for 5,000 to 40,000 unknowns.
    constexpr unsigned int columns[3] = { 16, 48, 128 };
    constexpr double       zeros[3]   = { 0.9, 0.3, 0.1 };
    std::copy_n(columns, 3, common.nrelax);
    std::copy_n(zeros, 3, common.zrelax);
    solver.analyzePattern(matrix);
    check_memory();
    if (solver.info() != Eigen::Success)
      throw ComputationError("CHOLMOD could not analyse the pattern of the matrix.");
  }


  void CholmodSystem::check_memory()
  {
    if (solver.cholmod().status == CHOLMOD_OUT_OF_MEMORY)
      throw std::bad_alloc();
  }


  void CholmodSystem::clear()
  {
    std::fill_n(matrix.valuePtr(), matrix.nonZeros(), 0.);
    right_hand_side.setZero();
  }


  void CholmodSystem::add(const unsigned int cell,
                          const double      *values,
                          const unsigned int width,
                          const double      *rhs)
  {
    const std::vector<int> &rows     = cell_rows[cell];
    const unsigned int      n        = rows.size();
    const int              *position = positions.data() + first_position[cell];
    double                 *storage  = matrix.valuePtr();
    for (unsigned int i = 0; i < n; ++i)
      {
        right_hand_side[rows[i]] += rhs[i];
        for (unsigned int j = 0; j <= i; ++j)
          storage[*position++] += values[j];
        values += width > 0 ? width : i + 1;
      }
  }


  bool CholmodSystem::factorise()
  {
    solver.factorize(matrix);
    check_memory();
    return solver.info() == Eigen::Success;
  }


  bool CholmodSystem::solve(double *solution)
  {
    const Eigen::VectorXd x = solver.solve(right_hand_side);
    check_memory();
    for (unsigned int i = 0; i < row_of_unknown.size(); ++i)
      solution[i] = row_of_unknown[i] < 0 ? 0. : x[row_of_unknown[i]];
    return x.allFinite();
  }


  double CholmodSystem::condition() const
  {
    return estimate_condition(
        matrix.diagonal(),
        [this](const Eigen::VectorXd &x) -> Eigen::VectorXd {
          return matrix.selfadjointView<Eigen::Lower>() * x;
        },
        [this](const Eigen::VectorXd &b) -> Eigen::VectorXd { return solver.solve(b); });
  }


  void CholmodSystem::number_rows(const std::string &ordering,
                                  const unsigned int n_nodes,
                                  const Nodes       &nodes)
  {
    std::vector<int> number(n_nodes, -1); // of the nodes in the system
    int              n = 0;
    for (const auto &cell : nodes)
      for (const unsigned int node : cell)
        if (number[node] < 0)
          number[node] = n++;
    n_rows = 2 * n;

    const std::vector<int> place = places(ordering, nodes, number, n);
    row_of_unknown.assign(2 * n_nodes, -1);
    for (unsigned int node = 0; node < number.size(); ++node)
      if (number[node] >= 0)
        for (unsigned int c = 0; c < 2; ++c)
          row_of_unknown[2 * node + c] = 2 * place[number[node]] + c;
    right_hand_side.setZero(n_rows);
    cell_rows.resize(nodes.size());
    for (unsigned int cell = 0; cell < nodes.size(); ++cell)
      for (const unsigned int node : nodes[cell])
        for (unsigned int c = 0; c < 2; ++c)
          cell_rows[cell].push_back(row_of_unknown[2 * node + c]);
  }


  /// Where each of the n nodes stands in an order with little fill, that of the graph of the
  /// nodes, which is four times smaller than that of the unknowns.
  std::vector<int> CholmodSystem::places(const std::string      &ordering,
                                         const Nodes            &nodes,
                                         const std::vector<int> &number,
                                         const int               n)
  {
    std::vector<Eigen::Triplet<double>> couplings;
    for (const auto &cell : nodes)
      for (const unsigned int a : cell)
        for (const unsigned int b : cell)
          if (number[a] >= number[b])
            couplings.emplace_back(number[a], number[b], 1.);
    SparseMatrix graph(n, n);
    graph.setFromTriplets(couplings.begin(), couplings.end());

    const bool dissection =
        ordering == "nested dissection" || (ordering == "automatic" && n > 5000);
    cholmod_common common;
    cholmod_start(&common);
    common.nmethods           = 1;
    common.method[0].ordering = dissection ? CHOLMOD_METIS : CHOLMOD_AMD;
    common.print              = 0;
    cholmod_sparse view       = Eigen::viewAsCholmod(Eigen::Ref<SparseMatrix>(graph));
    view.stype                = -1; // the lower triangle of a symmetric matrix
    cholmod_factor  *factor   = cholmod_analyze(&view, &common);
    std::vector<int> result(n);
    for (int k = 0; factor && k < n; ++k)
      result[static_cast<const int *>(factor->Perm)[k]] = k;
    const bool done = factor != nullptr, out_of_memory = common.status == CHOLMOD_OUT_OF_MEMORY;
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
    if (out_of_memory)
      throw std::bad_alloc();
    if (!done)
      throw ComputationError("CHOLMOD could not order the unknowns.");
    return result;
  }


  void CholmodSystem::make_pattern()
  {
    std::vector<std::vector<int>> columns(n_rows);
    for (const auto &rows : cell_rows)
      for (const int i : rows)
        for (const int j : rows)
          if (i >= j)
            columns[j].push_back(i);
    matrix.resize(n_rows, n_rows);
    std::size_t n_entries = 0;
    for (auto &column : columns)
      {
        std::sort(column.begin(), column.end());
        column.erase(std::unique(column.begin(), column.end()), column.end());
        n_entries += column.size();
      }
    if (n_entries > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw ComputationError("The matrix is too large for CHOLMOD's 32-bit indices: use \"Flow "
                             "solver/Linear solver = mumps\".");
    matrix.resizeNonZeros(n_entries);
    int entry = 0;
    for (std::size_t j = 0; j < n_rows; ++j)
      {
        matrix.outerIndexPtr()[j] = entry;
        for (const int i : columns[j])
          matrix.innerIndexPtr()[entry++] = i;
      }
    matrix.outerIndexPtr()[n_rows] = entry;

    for (unsigned int cell = 0; cell < cell_rows.size(); ++cell)
      {
        first_position.push_back(positions.size());
        const std::vector<int> &rows = cell_rows[cell];
        for (unsigned int i = 0; i < rows.size(); ++i)
          for (unsigned int j = 0; j <= i; ++j)
            {
              const int   row = std::max(rows[i], rows[j]), column = std::min(rows[i], rows[j]);
              const auto &list = columns[column];
              positions.push_back(matrix.outerIndexPtr()[column] +
                                  (std::lower_bound(list.begin(), list.end(), row) - list.begin()));
            }
      }
  }
} // namespace axiforge::solvers
