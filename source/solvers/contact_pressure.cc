// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/solvers/contact_pressure.h>

namespace axiforge::solvers
{
  namespace
  {
    constexpr double simpson[3] = { 1. / 6, 1. / 6, 4. / 6 };


    /// Tangents of an edge at its nodes end, end, middle, times half its length in the parameter
    /// [mm]; from the first end to the second.
    std::array<Vector2, 3> tangents(const Field &position, const BoundaryEdge &edge)
    {
      std::array<Vector2, 3> x;
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int c = 0; c < 2; ++c)
          x[a][c] = position.local_element(2 * edge.nodes[a] + c);
      const Vector2 chord = x[1] - x[0];
      return { { 4 * (x[2] - x[0]) - chord, 4 * (x[1] - x[2]) - chord, chord } };
    }


    bool same_tool(const NodeContact &a, const NodeContact &b)
    {
      return a.active() && (b.tool[0] == a.tool[0] || b.tool[1] == a.tool[0]);
    }


    /// Unit tangent of the tool at a node, in the direction of its touching edges where one of them
    /// ends here: so that an edge that folds back covers nothing.
    Field outward_tangents(const State                    &state,
                           const Field                    &position,
                           const std::vector<NodeContact> &contacts,
                           Field                          &n_touching)
    {
      Field direction(state.velocity);
      direction  = 0;
      n_touching = 0;
      for (const BoundaryEdge &edge : state.tables.edges)
        {
          const NodeContact &middle = contacts[edge.boundary_nodes[2]];
          if (!edge.owned || !middle.active())
            continue;
          const auto along = tangents(position, edge);
          for (unsigned int a = 0; a < 2; ++a)
            if (same_tool(contacts[edge.boundary_nodes[a]], middle))
              {
                n_touching.local_element(2 * edge.nodes[a]) += 1;
                for (unsigned int c = 0; c < 2; ++c)
                  direction.local_element(2 * edge.nodes[a] + c) +=
                      (a == 0 ? -1 : 1) * along[a][c] / along[a].norm();
              }
        }
      direction.compress(dealii::VectorOperation::add);
      direction.update_ghost_values();
      n_touching.compress(dealii::VectorOperation::add);
      n_touching.update_ghost_values();
      return direction;
    }


    bool on_surface(const State &state, const BoundaryEdge &edge)
    {
      return state.tables.boundary_nodes[edge.boundary_nodes[2]].free_surface;
    }


    /// Area that the edges at each touching node turn towards its tool [mm^2].
    Field areas(const State                    &state,
                const Field                    &position,
                const std::vector<NodeContact> &contacts,
                const Field                    &outward,
                const Field                    &n_touching)
    {
      Field area(state.velocity);
      area = 0;
      for (const BoundaryEdge &edge : state.tables.edges)
        {
          if (!edge.owned || !on_surface(state, edge))
            continue;
          const auto         along  = tangents(position, edge);
          const NodeContact &middle = contacts[edge.boundary_nodes[2]];
          for (unsigned int a = 0; a < 3; ++a)
            {
              const NodeContact &node = contacts[edge.boundary_nodes[a]];
              if (!node.active())
                continue;
              const Vector2 t({ -node.normal[0][1], node.normal[0][0] });
              double        length = std::abs(along[a] * t);
              if (a < 2 && !same_tool(node, middle) &&
                  n_touching.local_element(2 * edge.nodes[a]) > 0)
                {
                  // A free edge past the end of the contact; away from the end of the other edge.
                  const Vector2 way = (a == 0 ? 1 : -1) * along[a];
                  const double  d   = outward.local_element(2 * edge.nodes[a]) * t[0] +
                                   outward.local_element(2 * edge.nodes[a] + 1) * t[1];
                  length = std::max(0., (d > 0 ? 1 : d < 0 ? -1 : 0) * (way * t));
                }
              area.local_element(2 * edge.nodes[a]) +=
                  simpson[a] * length * 2 * M_PI *
                  std::abs(position.local_element(2 * edge.nodes[a]));
            }
        }
      area.compress(dealii::VectorOperation::add);
      area.update_ghost_values();
      return area;
    }


    /// Straight lines on the last touching edges, where the end would stand out.
    void smooth_ends(const State                    &state,
                     const Field                    &area,
                     const Field                    &n_touching,
                     const std::vector<NodeContact> &contacts,
                     Field                          &pressure)
    {
      Field change(state.velocity);
      change = 0;
      for (const BoundaryEdge &edge : state.tables.edges)
        {
          const auto &touch = [&](const unsigned int a) -> const NodeContact & {
            return contacts[edge.boundary_nodes[a]];
          };
          if (!edge.owned || !touch(2).active() || !same_tool(touch(2), touch(0)) ||
              !same_tool(touch(2), touch(1)))
            continue;
          const auto is_end = [&](const unsigned int a) {
            const BoundaryNode &node = state.tables.boundary_nodes[edge.boundary_nodes[a]];
            return n_touching.local_element(2 * edge.nodes[a]) < 1.5 && !node.on_axis &&
                   !node.on_symmetry && touch(a).tool[1] == no_tool;
          };
          if (is_end(0) == is_end(1))
            continue;
          const unsigned int end = is_end(0) ? 0 : 1;
          const auto         at  = [&](const Field &field, const unsigned int a) {
            return field.local_element(2 * edge.nodes[a]);
          };
          // On the axis nothing is known but what the middle has.
          const double inner = at(area, 1 - end) > 0 ? at(pressure, 1 - end) : at(pressure, 2);
          const double p = at(pressure, end), middle = at(pressure, 2);
          if (p <= 2 * middle - inner)
            continue;
          const double rise = (at(area, 2) * (middle - inner) + at(area, end) * (p - inner)) /
                              (at(area, 2) + 2 * at(area, end));
          change.local_element(2 * edge.nodes[2]) += inner + rise - middle;
          change.local_element(2 * edge.nodes[end]) += inner + 2 * rise - p;
        }
      change.compress(dealii::VectorOperation::add);
      change.update_ghost_values();
      for (const BoundaryNode &node : state.tables.boundary_nodes)
        pressure.local_element(2 * node.node) += change.local_element(2 * node.node);
    }
  } // namespace


  void recover_contact_pressures(const State              &state,
                                 const Field              &position,
                                 std::vector<NodeContact> &contacts)
  {
    Field       n_touching(state.velocity), pressure(state.velocity);
    const Field outward = outward_tangents(state, position, contacts, n_touching);
    const Field area    = areas(state, position, contacts, outward, n_touching);
    pressure            = 0;
    for (unsigned int b = 0; b < contacts.size(); ++b)
      {
        const unsigned int i = 2 * state.tables.boundary_nodes[b].node;
        if (contacts[b].active() && area.local_element(i) > 0)
          pressure.local_element(i) = contacts[b].reaction[0] / area.local_element(i);
      }
    smooth_ends(state, area, n_touching, contacts, pressure);
    for (unsigned int b = 0; b < contacts.size(); ++b)
      contacts[b].pressure = pressure.local_element(2 * state.tables.boundary_nodes[b].node);
    for (unsigned int b = 0; b < contacts.size(); ++b)
      if (const unsigned int n = state.tables.boundary_nodes[b].axis_neighbour;
          n != no_tool && contacts[b].active())
        contacts[b].pressure = contacts[n].pressure;
  }
} // namespace axiforge::solvers
