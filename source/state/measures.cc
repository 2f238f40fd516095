// SPDX-License-Identifier: GPL-2.0-or-later
#include <tuple>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

#include <axiforge/state/measures.h>

namespace axiforge
{
  namespace
  {
    /// Shape functions and derivatives of the cell at Gauss points (first nine) and vertices.
    struct Tables
    {
      double shape[13][9], derivative[13][9][2], weight[13];

      static const Tables &get()
      {
        static const Tables tables{ dealii::FE_Q<2>(2) };
        return tables;
      }

      explicit Tables(const dealii::FiniteElement<2> &element)
      {
        const dealii::QGauss<2> gauss(3);
        for (unsigned int q = 0; q < 13; ++q)
          {
            const Point x = q < 9 ? gauss.point(q) : Point((q - 9) % 2, (q - 9) / 2);
            weight[q]     = q < 9 ? gauss.weight(q) : 0;
            for (unsigned int a = 0; a < 9; ++a)
              {
                shape[q][a]         = element.shape_value(a, x);
                const Vector2 slope = element.shape_grad(a, x);
                derivative[q][a][0] = slope[0];
                derivative[q][a][1] = slope[1];
              }
          }
      }
    };


    /// Largest radius on the parabola through the nodes (end, end, middle) of an edge.
    double largest_on_edge(const double a, const double b, const double middle)
    {
      double       largest   = std::max({ a, b, middle });
      const double curvature = a + b - 2 * middle; // r = middle + (b-a)/2 s + curvature/2 s^2
      if (curvature < 0)
        if (const double s = -0.5 * (b - a) / curvature; std::abs(s) < 1)
          largest = std::max(largest, middle + 0.5 * (b - a) * s + 0.5 * curvature * s * s);
      return largest;
    }
  } // namespace


  std::pair<double, double> vertical_extent(const State &state)
  {
    double lowest = 1e300, highest = -1e300;
    for (const auto &nodes : state.tables.cells)
      for (const unsigned int node : nodes)
        {
          const double z = state.node_position(node)[1];
          lowest         = std::min(lowest, z);
          highest        = std::max(highest, z);
        }
    return { dealii::Utilities::MPI::min(lowest, state.communicator),
             dealii::Utilities::MPI::max(highest, state.communicator) };
  }


  Measures measure(const State &state, const Field *places)
  {
    const Tables &tables = Tables::get();
    Measures      result{};
    std::tie(result.lowest, result.highest) = vertical_extent(state);
    result.largest_radius                   = 0;
    result.smallest_jacobian = result.smallest_vertex_jacobian = 1e300;

    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        double x[9][2], smallest = 1e300, corner = 1e300, area = 0;
        for (unsigned int a = 0; a < 9; ++a)
          {
            const Point p = state.node_position(state.tables.cells[cell][a]);
            x[a][0]       = p[0];
            x[a][1]       = p[1];
          }
        for (unsigned int q = 0; q < 13; ++q)
          {
            double radius = 0, J[2][2] = { { 0, 0 }, { 0, 0 } };
            for (unsigned int a = 0; a < 9; ++a)
              {
                radius += tables.shape[q][a] * x[a][0];
                for (unsigned int i = 0; i < 2; ++i)
                  for (unsigned int j = 0; j < 2; ++j)
                    J[i][j] += x[a][i] * tables.derivative[q][a][j];
              }
            const double jacobian = J[0][0] * J[1][1] - J[0][1] * J[1][0];
            double      &least    = q < 9 ? smallest : corner;
            least                 = std::min(least, jacobian);
            area += jacobian * tables.weight[q];
            result.volume += 2 * M_PI * radius * jacobian * tables.weight[q];
          }
        const double scaled = smallest / std::abs(area);
        result.smallest_vertex_jacobian =
            std::min(result.smallest_vertex_jacobian, corner / std::abs(area));
        if (!(scaled >= result.smallest_jacobian))
          {
            result.smallest_jacobian = scaled;
            const Field &named       = places ? *places : state.position;
            for (unsigned int c = 0; c < 2; ++c)
              result.worst_place[c] = named.local_element(2 * state.tables.cells[cell][8] + c);
          }
      }
    for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
      if (const BoundaryEdge &edge = state.tables.edges[e]; edge.owned)
        result.largest_radius =
            std::max(result.largest_radius, largest_on_edge(state.node_position(edge.nodes[0])[0],
                                                            state.node_position(edge.nodes[1])[0],
                                                            state.node_position(edge.nodes[2])[0]));

    namespace MPI                   = dealii::Utilities::MPI;
    const MPI_Comm comm             = state.communicator;
    const double   mine             = result.smallest_jacobian;
    result.volume                   = MPI::sum(result.volume, comm);
    result.largest_radius           = MPI::max(result.largest_radius, comm);
    result.smallest_jacobian        = MPI::min(mine, comm);
    result.smallest_vertex_jacobian = MPI::min(result.smallest_vertex_jacobian, comm);
    for (unsigned int c = 0; c < 2; ++c)
      result.worst_place[c] =
          MPI::max(mine == result.smallest_jacobian ? result.worst_place[c] : -1e300, comm);
    return result;
  }


  std::array<double, 9> volumes_of_points(const State &state, const unsigned int cell)
  {
    const Tables         &tables = Tables::get();
    std::array<double, 9> volumes;
    for (unsigned int q = 0; q < 9; ++q)
      {
        double radius = 0, J[2][2] = { { 0, 0 }, { 0, 0 } };
        for (unsigned int a = 0; a < 9; ++a)
          {
            const Point x = state.node_position(state.tables.cells[cell][a]);
            radius += tables.shape[q][a] * x[0];
            for (unsigned int i = 0; i < 2; ++i)
              for (unsigned int j = 0; j < 2; ++j)
                J[i][j] += x[i] * tables.derivative[q][a][j];
          }
        volumes[q] = 2 * M_PI * radius * (J[0][0] * J[1][1] - J[0][1] * J[1][0]) * tables.weight[q];
      }
    return volumes;
  }


  double integral(const State                                     &state,
                  const unsigned int                               cell,
                  const std::function<double(unsigned int point)> &quantity)
  {
    const std::array<double, 9> volumes = volumes_of_points(state, cell);
    double                      sum     = 0;
    for (unsigned int q = 0; q < 9; ++q)
      sum += volumes[q] * quantity(q);
    return sum;
  }


  double largest_strain(const State &state)
  {
    double largest = 0;
    for (std::size_t i = 0; i < state.strain.locally_owned_size(); ++i)
      largest = std::max(largest, state.strain.local_element(i));
    return dealii::Utilities::MPI::max(largest, state.communicator);
  }
} // namespace axiforge
