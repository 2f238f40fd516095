// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/lac/full_matrix.h>

#include <axiforge/state/recovery.h>

namespace axiforge
{
  using namespace dealii;

  namespace
  {
    /// Values of the polynomial through the 3 x 3 Gauss points at the nodes of FE_Q(2).
    FullMatrix<double> points_to_nodes(const State &state)
    {
      FullMatrix<double> matrix(9, 9);
      const FE_Q<2>      nodes(2);
      for (unsigned int a = 0; a < 9; ++a)
        for (unsigned int q = 0; q < 9; ++q)
          matrix(a, q) = state.history_element.shape_value(q, nodes.unit_support_point(a));
      return matrix;
    }
  } // namespace


  Field
  recover(const State                                                                   &state,
          const std::function<std::array<double, 2>(unsigned int cell, unsigned int q)> &value)
  {
    const FullMatrix<double> continuation = points_to_nodes(state);
    Field                    sum(state.velocity), count(state.velocity);
    sum   = 0;
    count = 0;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        double at[2][9], low[2] = { 1e300, 1e300 }, high[2] = { -1e300, -1e300 };
        for (unsigned int q = 0; q < 9; ++q)
          {
            const std::array<double, 2> v = value(cell, q);
            for (unsigned int c = 0; c < 2; ++c)
              {
                at[c][q] = v[c];
                low[c]   = std::min(low[c], v[c]);
                high[c]  = std::max(high[c], v[c]);
              }
          }
        for (unsigned int a = 0; a < 9; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            {
              double node = 0;
              for (unsigned int q = 0; q < 9; ++q)
                node += continuation(a, q) * at[c][q];
              const unsigned int i = 2 * state.tables.cells[cell][a] + c;
              sum.local_element(i) += std::clamp(node, low[c], high[c]);
              count.local_element(i) += 1;
            }
      }
    sum.compress(VectorOperation::add);
    count.compress(VectorOperation::add);
    for (unsigned int i = 0; i < sum.locally_owned_size(); ++i)
      sum.local_element(i) /= count.local_element(i);
    sum.zero_out_ghost_values();
    state.hanging_nodes.distribute(sum);
    sum.update_ghost_values();
    return sum;
  }
} // namespace axiforge
