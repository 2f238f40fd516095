// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

#include <axiforge/base/errors.h>
#include <axiforge/meshing/transfer.h>

namespace axiforge::meshing
{
  namespace
  {
    /// Column and row of the nodes of FE_Q(2) in the 3 x 3 grid.
    constexpr unsigned int column[9] = { 0, 2, 0, 2, 0, 2, 1, 1, 1 };
    constexpr unsigned int row[9]    = { 0, 0, 2, 2, 1, 1, 0, 2, 1 };

    /// Newton's step in reference coordinates after which, its error being squared, the next one is
    /// in the last digits.
    constexpr double converged_step = 1e-8;

    /// Farthest that a point may be outside of its cell, in reference coordinates.
    constexpr double farthest_outside = 0.05;

    struct Shape
    {
      double value[9], d_xi[9], d_eta[9];

      explicit Shape(const double (&xi)[2])
      {
        double u[2][3], du[2][3];
        for (unsigned int d = 0; d < 2; ++d)
          {
            const double t = xi[d];
            u[d][0]        = (1 - t) * (1 - 2 * t);
            u[d][1]        = 4 * t * (1 - t);
            u[d][2]        = t * (2 * t - 1);
            du[d][0]       = 4 * t - 3;
            du[d][1]       = 4 - 8 * t;
            du[d][2]       = 4 * t - 1;
          }
        for (unsigned int a = 0; a < 9; ++a)
          {
            value[a] = u[0][column[a]] * u[1][row[a]];
            d_xi[a]  = du[0][column[a]] * u[1][row[a]];
            d_eta[a] = u[0][column[a]] * du[1][row[a]];
          }
      }
    };


    Point point_at(const State &state, const unsigned int cell, const double (&xi)[2])
    {
      const Shape shape(xi);
      Point       x;
      for (unsigned int a = 0; a < 9; ++a)
        x += shape.value[a] * state.node_position(state.tables.cells[cell][a]);
      return x;
    }


    /// Solves the 3 x 3 normal equations of a fit by Cramer's rule.
    std::array<double, 3> solve(const double (&m)[3][3], const double (&b)[3])
    {
      const auto det = [](const double(&a)[3][3]) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
               a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
      };
      const double          whole = det(m);
      std::array<double, 3> x;
      for (unsigned int k = 0; k < 3; ++k)
        {
          double changed[3][3];
          for (unsigned int i = 0; i < 3; ++i)
            for (unsigned int j = 0; j < 3; ++j)
              changed[i][j] = j == k ? b[i] : m[i][j];
          x[k] = det(changed) / whole;
        }
      return x;
    }


    /// The pressure's coefficients in the basis of the flow cell (1, r and z about the centre in
    /// units of the size) that fit the mean stress at the Gauss points best.
    void fit_pressure(const State &state, const unsigned int cell, CellHistory &history)
    {
      const auto &nodes = state.tables.cells[cell];
      const Point c     = state.node_position(nodes[8]);
      const auto  span  = [&](const unsigned int a, const unsigned int b) {
        const Vector2 d = state.node_position(nodes[a]) - state.node_position(nodes[b]);
        return std::abs(d[0]) + std::abs(d[1]);
      };
      const double            size = std::max({ span(1, 0), span(2, 0), span(3, 1) });
      const dealii::QGauss<2> gauss(3);
      double                  m[3][3] = {}, b[3] = {};
      for (unsigned int q = 0; q < 9; ++q)
        {
          const double xi[2]    = { gauss.point(q)[0], gauss.point(q)[1] };
          const Point  x        = point_at(state, cell, xi);
          const double basis[3] = { 1, (x[0] - c[0]) / size, (x[1] - c[1]) / size };
          for (unsigned int i = 0; i < 3; ++i)
            {
              b[i] += basis[i] * history.mean_stress[q];
              for (unsigned int j = 0; j < 3; ++j)
                m[i][j] += basis[i] * basis[j];
            }
        }
      history.pressure = solve(m, b);
    }
  } // namespace


  OldFields::OldFields(const Snapshot &snapshot)
      : snapshot(snapshot)
      , lower(1e300, 1e300)
  {
    const dealii::QGauss<1> quadrature(3);
    for (unsigned int q = 0; q < 3; ++q)
      gauss[q] = quadrature.point(q)[0];

    Point upper(-1e300, -1e300);
    for (const CellSnapshot &cell : snapshot.cells)
      for (const auto &x : cell.position)
        for (unsigned int c = 0; c < 2; ++c)
          {
            lower[c] = std::min(lower[c], x[c]);
            upper[c] = std::max(upper[c], x[c]);
          }
    const Vector2 extent = upper - lower;
    bin_size =
        std::max(std::sqrt(extent[0] * extent[1] / snapshot.cells.size()), 1e-3 * extent.norm());
    for (unsigned int c = 0; c < 2; ++c)
      bins[c] = 1 + static_cast<unsigned int>(extent[c] / bin_size);
    cells_of_bin.resize(bins[0] * bins[1]);
    for (unsigned int cell = 0; cell < snapshot.cells.size(); ++cell)
      {
        // The box of the nodes, a quarter larger: curved edges reach beyond the nodes.
        double least[2] = { 1e300, 1e300 }, most[2] = { -1e300, -1e300 };
        for (const auto &x : snapshot.cells[cell].position)
          for (unsigned int c = 0; c < 2; ++c)
            {
              least[c] = std::min(least[c], x[c]);
              most[c]  = std::max(most[c], x[c]);
            }
        const double margin = 0.25 * std::max(most[0] - least[0], most[1] - least[1]);
        boxes.push_back({ { Point(least[0] - margin, least[1] - margin),
                            Point(most[0] + margin, most[1] + margin) } });
        const auto &[low, high] = boxes.back().get_boundary_points();
        for (unsigned int j = bin(low, 1); j <= bin(high, 1); ++j)
          for (unsigned int i = bin(low, 0); i <= bin(high, 0); ++i)
            cells_of_bin[j * bins[0] + i].push_back(cell);
      }
  }


  unsigned int OldFields::bin(const Point &x, const unsigned int c) const
  {
    return std::clamp(static_cast<int>(std::floor((x[c] - lower[c]) / bin_size)), 0,
                      static_cast<int>(bins[c]) - 1);
  }


  double OldFields::try_cell(const unsigned int cell, const Point &x, double (&xi)[2]) const
  {
    const auto &nodes = snapshot.cells[cell].position;
    const auto  miss  = [&](const Shape &shape, double(&d)[2]) {
      d[0] = x[0];
      d[1] = x[1];
      for (unsigned int a = 0; a < 9; ++a)
        for (unsigned int c = 0; c < 2; ++c)
          d[c] -= shape.value[a] * nodes[a][c];
      return std::sqrt(d[0] * d[0] + d[1] * d[1]);
    };
    const auto diagonal = [&](const unsigned int a, const unsigned int b) {
      return Vector2({ nodes[b][0] - nodes[a][0], nodes[b][1] - nodes[a][1] }).norm();
    };
    const double size = diagonal(0, 3) + diagonal(1, 2);
    xi[0] = xi[1] = 0.5;
    double d[2];
    for (unsigned int iteration = 0; iteration < 25; ++iteration)
      {
        const Shape shape(xi);
        if (miss(shape, d) < 1e-15 * size)
          break;
        double J[2][2] = {};
        for (unsigned int a = 0; a < 9; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            {
              J[c][0] += shape.d_xi[a] * nodes[a][c];
              J[c][1] += shape.d_eta[a] * nodes[a][c];
            }
        const double det = J[0][0] * J[1][1] - J[0][1] * J[1][0];
        if (det == 0)
          break;
        const double step[2] = { (d[0] * J[1][1] - d[1] * J[0][1]) / det,
                                 (d[1] * J[0][0] - d[0] * J[1][0]) / det };
        double       largest = 0;
        for (unsigned int c = 0; c < 2; ++c)
          {
            const double next = std::clamp(xi[c] + std::clamp(step[c], -0.5, 0.5), -0.5, 1.5);
            largest           = std::max(largest, std::abs(next - xi[c]));
            xi[c]             = next;
          }
        if (largest < converged_step)
          break;
      }
    // How far the point is from the cell: outside of its unit cell, or not met at all.
    const double missed  = miss(Shape(xi), d) / size;
    double       outside = 0;
    for (const double t : xi)
      outside = std::max({ outside, -t, t - 1 });
    return outside + (missed < 1e-10 ? 0 : 10 * missed);
  }


  OldFields::Place OldFields::find(const Point &x) const
  {
    Place      best{ 0, { 0.5, 0.5 } };
    double     least = std::numeric_limits<double>::max();
    const auto look  = [&](const unsigned int cell) {
      double       xi[2];
      const double outside = try_cell(cell, x, xi);
      if (outside < least)
        {
          least = outside;
          best  = { cell, { xi[0], xi[1] } };
        }
      return outside < 1e-12;
    };
    for (const unsigned int cell : cells_of_bin[bin(x, 1) * bins[0] + bin(x, 0)])
      if (boxes[cell].point_inside(x) && look(cell))
        break;
    if (least > farthest_outside)
      for (unsigned int cell = 0; cell < snapshot.cells.size(); ++cell)
        if (look(cell))
          break;
    for (double &t : best.xi)
      t = std::clamp(t, -farthest_outside, 1 + farthest_outside);
    return best;
  }


  Vector2 OldFields::velocity(const Place &place) const
  {
    const Shape shape(place.xi);
    Vector2     v;
    for (unsigned int a = 0; a < 9; ++a)
      for (unsigned int c = 0; c < 2; ++c)
        v[c] += shape.value[a] * snapshot.cells[place.cell].velocity[a][c];
    return v;
  }


  double OldFields::at_gauss_points(const double (&values)[9], const Place &place) const
  {
    double weight[2][3];
    for (unsigned int d = 0; d < 2; ++d)
      for (unsigned int i = 0; i < 3; ++i)
        {
          const double a = gauss[(i + 1) % 3], b = gauss[(i + 2) % 3];
          weight[d][i] = (place.xi[d] - a) * (place.xi[d] - b) / ((gauss[i] - a) * (gauss[i] - b));
        }
    double value = 0;
    for (unsigned int q = 0; q < 9; ++q)
      value += weight[0][q % 3] * weight[1][q / 3] * values[q];
    const auto [least, most] = std::minmax_element(values, values + 9);
    return std::clamp(value, *least, *most);
  }


  double OldFields::strain(const Place &place) const
  {
    return at_gauss_points(snapshot.cells[place.cell].strain, place);
  }


  void OldFields::history(const Place &place, CellHistory &history, const unsigned int q) const
  {
    const CellSnapshot &cell = snapshot.cells[place.cell];
    for (unsigned int c = 0; c < 4; ++c)
      {
        double values[9];
        for (unsigned int p = 0; p < 9; ++p)
          values[p] = cell.stress[p][c];
        history.stress[q][c] = at_gauss_points(values, place);
      }
    history.mean_stress[q] = at_gauss_points(cell.mean_stress, place);
    history.strain_rate[q] = at_gauss_points(cell.strain_rate, place);
    history.flow_stress[q] = at_gauss_points(cell.flow_stress, place);
  }


  void transfer(const Snapshot &old, const std::vector<CarriedEdge> &boundary, State &state)
  {
    const OldFields         fields(old);
    const dealii::QGauss<2> gauss(3);
    std::vector<bool>       done(state.tables.n_owned_nodes, false);
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        for (const unsigned int node : state.tables.cells[cell])
          if (node < done.size() && !done[node])
            {
              const Vector2 v = fields.velocity(fields.find(state.node_position(node)));
              for (unsigned int c = 0; c < 2; ++c)
                state.velocity.local_element(2 * node + c) = v[c];
              done[node] = true;
            }
        CellHistory &history = state.cell_history[cell];
        for (unsigned int q = 0; q < 9; ++q)
          {
            const double xi[2] = { gauss.point(q)[0], gauss.point(q)[1] };
            const auto   place = fields.find(point_at(state, cell, xi));
            state.strain.local_element(state.tables.first_strain_dof[cell] + q) =
                fields.strain(place);
            fields.history(place, history, q);
          }
        fit_pressure(state, cell, history);
      }
    state.velocity.update_ghost_values();

    // Nodes of the boundary are looked up by the position of the middles, which are the same to
    // the last bit.
    std::map<std::pair<double, double>, const CarriedEdge *> by_middle;
    for (const CarriedEdge &edge : boundary)
      by_middle[{ edge.position[2][0], edge.position[2][1] }] = &edge;
    for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
      {
        const BoundaryEdge &edge   = state.tables.edges[e];
        const Point         middle = state.node_position(edge.nodes[2]);
        const auto          found  = by_middle.find({ middle[0], middle[1] });
        AssertThrow(found != by_middle.end(),
                    dealii::ExcMessage("The mesh was not made with this boundary."));
        const CarriedEdge &carried = *found->second;
        const Point        start   = state.node_position(edge.nodes[0]);
        const bool         turned  = start != Point(carried.position[0][0], carried.position[0][1]);
        for (unsigned int a = 0; a < 3; ++a)
          {
            const SurfaceNode &node    = carried.node[a < 2 && turned ? 1 - a : a];
            NodeContact       &contact = state.contacts[edge.boundary_nodes[a]];
            if (node.tool[0] < 0)
              continue;
            for (unsigned int i = 0; i < 2; ++i)
              contact.tool[i] =
                  node.tool[i] < 0 ? no_tool : static_cast<unsigned int>(node.tool[i]);
            contact.pressure          = node.pressure;
            contact.slip              = node.slip;
            contact.traction          = node.traction;
            EdgeFriction &friction    = state.edge_friction[e];
            friction.traction[a]      = node.stored_traction;
            friction.strain_rate[a]   = node.strain_rate;
            friction.earlier_rate[a]  = node.earlier_rate;
            friction.previous_slip[a] = node.previous_slip;
            friction.has_previous[a]  = node.has_previous > 0;
          }
      }
  }


  double strain_integral(const State &state)
  {
    const dealii::QGauss<2> gauss(3);
    double                  sum = 0;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      for (unsigned int q = 0; q < 9; ++q)
        {
          const double xi[2] = { gauss.point(q)[0], gauss.point(q)[1] };
          const Shape  shape(xi);
          double       J[2][2] = {}, radius = 0;
          for (unsigned int a = 0; a < 9; ++a)
            {
              const Point x = state.node_position(state.tables.cells[cell][a]);
              radius += shape.value[a] * x[0];
              for (unsigned int c = 0; c < 2; ++c)
                {
                  J[c][0] += shape.d_xi[a] * x[c];
                  J[c][1] += shape.d_eta[a] * x[c];
                }
            }
          sum += 2 * M_PI * radius * (J[0][0] * J[1][1] - J[0][1] * J[1][0]) * gauss.weight(q) *
                 state.strain.local_element(state.tables.first_strain_dof[cell] + q);
        }
    return dealii::Utilities::MPI::sum(sum, state.communicator);
  }
} // namespace axiforge::meshing
