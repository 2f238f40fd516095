// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/meshing/carried_cell.h>

namespace axiforge::meshing
{
  using dealii::GeometryInfo;

  namespace
  {
    enum Quantity
    {
      strain,
      stress, // four
      mean_stress = 5,
      strain_rate,
      flow_stress
    };


    const Point &gauss_point(const State &state, const unsigned int q)
    {
      return state.history_element.get_unit_support_points()[q];
    }


    /// The polynomial of the cell at a reference point, kept in the range of its nine values.
    double continued(const State &state, const std::array<double, 9> &values, const Point &at)
    {
      double sum = 0;
      for (unsigned int q = 0; q < 9; ++q)
        sum += state.history_element.shape_value(q, at) * values[q];
      const auto range = std::minmax_element(values.begin(), values.end());
      return std::clamp(sum, *range.first, *range.second);
    }


    /// Centre of the pressure's basis and its size, as the solver has them (flow_cell.cc).
    double pressure_size(const State &state, const unsigned int cell)
    {
      const auto &nodes = state.tables.cells[cell];
      const auto  span  = [&](const unsigned int a, const unsigned int b) {
        const Vector2 d = state.node_position(nodes[a]) - state.node_position(nodes[b]);
        return std::abs(d[0]) + std::abs(d[1]);
      };
      return std::max({ span(1, 0), span(2, 0), span(3, 1) });
    }


    /// Weights of the nodes (end, end, middle) of a side at its place s in [0, 1].
    std::array<double, 3> weights_at(const double s)
    {
      return { { (1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s) } };
    }


    double in_range(const std::array<double, 3> &values, const std::array<double, 3> &weights)
    {
      double sum = 0;
      for (unsigned int a = 0; a < 3; ++a)
        sum += weights[a] * values[a];
      const auto range = std::minmax_element(values.begin(), values.end());
      return std::clamp(sum, *range.first, *range.second);
    }


    /// Half of a side: nodes at the places of its ends and its middle.
    CarriedSide half_of(const CarriedSide &side, const unsigned int half)
    {
      CarriedSide  result    = side;
      const double places[3] = { 0.5 * half, 0.5 * half + 0.5, 0.5 * half + 0.25 };
      for (unsigned int a = 0; a < 3; ++a)
        {
          const std::array<double, 3> w = weights_at(places[a]);
          result.traction[a]            = in_range(side.traction, w);
          result.strain_rate[a]         = in_range(side.strain_rate, w);
          result.earlier_rate[a]        = in_range(side.earlier_rate, w);
          // Four points of the layer stand at each node.
          for (unsigned int i = 0; i < 4; ++i)
            for (unsigned int c = 0; c < 4; ++c)
              result.layer[4 * a + i][c] =
                  in_range({ { side.layer[i][c], side.layer[4 + i][c], side.layer[8 + i][c] } }, w);
        }
      result.tool[0] = half == 0 ? side.tool[0] : side.tool[2];
      result.tool[1] = half == 0 ? side.tool[2] : side.tool[1];
      result.tool[2] = new_node;
      return result;
    }


    /// A side in place of its halves: its ends are their outer ends, its middle is what they share.
    CarriedSide joined(const CarriedSide &first, const CarriedSide &second)
    {
      CarriedSide result = first;
      result.has_layer   = first.has_layer && second.has_layer;
      const auto combine = [](auto &values, const auto &other) {
        values[2] = 0.5 * (values[1] + other[0]);
        values[1] = other[1];
      };
      combine(result.traction, second.traction);
      combine(result.strain_rate, second.strain_rate);
      combine(result.earlier_rate, second.earlier_rate);
      for (unsigned int i = 0; i < 4; ++i)
        for (unsigned int c = 0; c < 4; ++c)
          {
            result.layer[8 + i][c] = 0.5 * (first.layer[4 + i][c] + second.layer[i][c]);
            result.layer[4 + i][c] = second.layer[4 + i][c];
          }
      result.tool = { { first.tool[0], second.tool[1], first.tool[1] } };
      return result;
    }


    unsigned int child_at(const unsigned int side, const unsigned int half)
    {
      return GeometryInfo<2>::child_cell_on_face(dealii::RefinementCase<2>::isotropic_refinement,
                                                 side, half);
    }
  } // namespace


  std::vector<std::array<unsigned int, 4>> edges_of_cells(const State &state)
  {
    std::vector<std::array<unsigned int, 4>> edges(state.tables.cells.size(),
                                                   { { no_tool, no_tool, no_tool, no_tool } });
    for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
      if (const BoundaryEdge &edge = state.tables.edges[e]; edge.owned)
        edges[edge.cell][edge.side] = e;
    return edges;
  }


  CarriedCell
  carry(const State &state, const unsigned int cell, const std::array<unsigned int, 4> &edges)
  {
    const CellHistory &history = state.cell_history[cell];
    CarriedCell        carried{};
    for (unsigned int q = 0; q < 9; ++q)
      {
        carried.points[strain][q] =
            state.strain.local_element(state.tables.first_strain_dof[cell] + q);
        for (unsigned int c = 0; c < 4; ++c)
          carried.points[stress + c][q] = history.stress[q][c];
        carried.points[mean_stress][q] = history.mean_stress[q];
        carried.points[strain_rate][q] = history.strain_rate[q];
        carried.points[flow_stress][q] = history.flow_stress[q];
      }
    const Point  centre = state.node_position(state.tables.cells[cell][8]);
    const double size   = pressure_size(state, cell);
    carried.pressure    = history.pressure[0];
    for (unsigned int c = 0; c < 2; ++c)
      {
        carried.centre[c] = centre[c];
        carried.slope[c]  = history.pressure[1 + c] / size;
      }
    for (unsigned int s = 0; s < 4; ++s)
      if (edges[s] != no_tool)
        {
          CarriedSide        &side     = carried.sides[s];
          const EdgeFriction &friction = state.edge_friction[edges[s]];
          side.on_boundary             = true;
          side.traction                = friction.traction;
          side.strain_rate             = friction.strain_rate;
          side.earlier_rate            = friction.earlier_rate;
          side.has_layer               = !friction.layer.empty();
          if (side.has_layer)
            side.layer = friction.layer[0];
          for (unsigned int a = 0; a < 3; ++a)
            side.tool[a] = state.contacts[state.tables.edges[edges[s]].boundary_nodes[a]].tool[0];
        }
    return carried;
  }


  CarriedCell child_of(const State &state, const CarriedCell &cell, const unsigned int c)
  {
    CarriedCell child = cell;
    for (unsigned int q = 0; q < 9; ++q)
      {
        const Point at = GeometryInfo<2>::child_to_cell_coordinates(gauss_point(state, q), c);
        for (unsigned int i = 0; i < CarriedCell::n_quantities; ++i)
          child.points[i][q] = continued(state, cell.points[i], at);
      }
    for (unsigned int s = 0; s < 4; ++s)
      {
        child.sides[s].on_boundary = false;
        for (unsigned int half = 0; half < 2; ++half)
          if (cell.sides[s].on_boundary && child_at(s, half) == c)
            child.sides[s] = half_of(cell.sides[s], half);
      }
    return child;
  }


  CarriedCell parent_of(const State &state, const std::array<CarriedCell, 4> &children)
  {
    CarriedCell parent{};
    for (unsigned int q = 0; q < 9; ++q)
      {
        const Point       &at     = gauss_point(state, q);
        const unsigned int child  = GeometryInfo<2>::child_cell_from_point(at);
        const Point        inside = GeometryInfo<2>::cell_to_child_coordinates(at, child);
        for (unsigned int i = 0; i < CarriedCell::n_quantities; ++i)
          parent.points[i][q] = continued(state, children[child].points[i], inside);
      }
    // Mean value and mean slope at the mean of the centres: exact for a linear pressure.
    for (const CarriedCell &child : children)
      {
        parent.pressure += 0.25 * child.pressure;
        for (unsigned int c = 0; c < 2; ++c)
          {
            parent.centre[c] += 0.25 * child.centre[c];
            parent.slope[c] += 0.25 * child.slope[c];
          }
      }
    for (unsigned int s = 0; s < 4; ++s)
      if (children[child_at(s, 0)].sides[s].on_boundary)
        parent.sides[s] =
            joined(children[child_at(s, 0)].sides[s], children[child_at(s, 1)].sides[s]);
    return parent;
  }


  void put_down(const CarriedCell                 &carried,
                State                             &state,
                const unsigned int                 cell,
                const std::array<unsigned int, 4> &edges)
  {
    CellHistory &history = state.cell_history[cell];
    for (unsigned int q = 0; q < 9; ++q)
      {
        state.strain.local_element(state.tables.first_strain_dof[cell] + q) =
            carried.points[strain][q];
        for (unsigned int c = 0; c < 4; ++c)
          history.stress[q][c] = carried.points[stress + c][q];
        history.mean_stress[q] = carried.points[mean_stress][q];
        history.strain_rate[q] = carried.points[strain_rate][q];
        history.flow_stress[q] = carried.points[flow_stress][q];
      }
    // The same linear function about this cell's centre, in units of its size.
    const Point  centre = state.node_position(state.tables.cells[cell][8]);
    const double size   = pressure_size(state, cell);
    history.pressure[0] = carried.pressure;
    for (unsigned int c = 0; c < 2; ++c)
      {
        history.pressure[0] += carried.slope[c] * (centre[c] - carried.centre[c]);
        history.pressure[1 + c] = carried.slope[c] * size;
      }
    for (unsigned int s = 0; s < 4; ++s)
      if (edges[s] != no_tool && carried.sides[s].on_boundary)
        {
          const CarriedSide &side     = carried.sides[s];
          EdgeFriction      &friction = state.edge_friction[edges[s]];
          friction.traction           = side.traction;
          friction.strain_rate        = side.strain_rate;
          friction.earlier_rate       = side.earlier_rate;
          if (side.has_layer)
            friction.layer.assign(1, side.layer);
        }
  }
} // namespace axiforge::meshing
