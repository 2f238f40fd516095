// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/solvers/contact_set.h>

// What the set of touching nodes means for the edges between them and for the equations: areas,
// pressures, and the axes along which velocities are prescribed.

namespace axiforge::solvers
{
  Field ContactSet::edge_lengths() const
  {
    Field length;
    length.reinit(state.velocity);
    for (const BoundaryEdge &edge : state.tables.edges)
      if (edge.owned)
        {
          const double chord =
              (state.node_position(edge.nodes[1]) - state.node_position(edge.nodes[0])).norm();
          for (const unsigned int node : edge.nodes)
            length.local_element(2 * node) += chord / 2;
        }
    length.compress(dealii::VectorOperation::add);
    length.update_ghost_values();
    return length;
  }


  ContactSet::EdgeContact ContactSet::edge(const unsigned int e, const Field &position) const
  {
    const BoundaryEdge &boundary = state.tables.edges[e];
    const NodeContact  &middle   = nodes[boundary.boundary_nodes[2]];
    EdgeContact         result;
    if (!middle.active())
      return result;
    result.tool    = middle.tool[0];
    result.touches = { { false, false, true } };
    result.normal.fill(middle.normal[0]);
    for (unsigned int a = 0; a < 2; ++a)
      {
        const NodeContact &end = nodes[boundary.boundary_nodes[a]];
        for (const unsigned int slot : { 1u, 0u })
          if (end.tool[slot] == result.tool &&
              (!result.touches[a] || end.face[slot] == middle.face[0]))
            {
              result.touches[a] = true;
              result.normal[a]  = end.normal[slot];
            }
      }
    if (result.touches[0] && result.touches[1])
      result.weight = { { 1. / 6, 1. / 6, 4. / 6 } };
    else
      result.weight = { { result.touches[0] ? 0.25 : 0., result.touches[1] ? 0.25 : 0., 0.25 } };

    std::array<Point, 3> x;
    for (unsigned int a = 0; a < 3; ++a)
      for (unsigned int c = 0; c < 2; ++c)
        x[a][c] = position.local_element(2 * boundary.nodes[a] + c);
    const Vector2                chord   = x[1] - x[0];
    const std::array<Vector2, 3> tangent = { { 2 * (x[2] - x[0]) - 0.5 * chord,
                                               2 * (x[1] - x[2]) - 0.5 * chord, 0.5 * chord } };
    for (unsigned int a = 0; a < 3; ++a)
      result.measure[a] = result.weight[a] * 2 * tangent[a].norm() * 2 * M_PI * std::abs(x[a][0]);
    return result;
  }


  void ContactSet::set_pressures(const Field &position)
  {
    if (area.size() == 0)
      area.reinit(state.velocity);
    area = 0;
    for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
      if (state.tables.edges[e].owned)
        {
          const EdgeContact contact = edge(e, position);
          if (contact.tool != no_tool)
            for (unsigned int a = 0; a < 3; ++a)
              area.local_element(2 * state.tables.edges[e].nodes[a]) += contact.measure[a];
        }
    area.compress(dealii::VectorOperation::add);
    area.update_ghost_values();
    for (unsigned int b = 0; b < nodes.size(); ++b)
      {
        const double measure = area.local_element(2 * state.tables.boundary_nodes[b].node);
        nodes[b].pressure = nodes[b].active() && measure > 0 ? nodes[b].reaction[0] / measure : 0;
      }
    // The area of a node on the axis is zero: the pressure is even in r.
    for (unsigned int b = 0; b < nodes.size(); ++b)
      if (const unsigned int n = state.tables.boundary_nodes[b].axis_neighbour;
          n != no_tool && nodes[b].active())
        nodes[b].pressure = nodes[n].pressure;
  }


  void ContactSet::make_frames(const Field            &velocity,
                               const double            time_step,
                               std::vector<NodeFrame> &frames) const
  {
    frames.clear();
    // Prescribed velocities hold where and when the equations do.
    const double theta = scene.time.scheme() == scene::TimeScheme::midpoint ? 0.5 : 0.;
    for (unsigned int b = 0; b < nodes.size(); ++b)
      {
        const BoundaryNode &node = state.tables.boundary_nodes[b];
        const Vector2       v(
                  { velocity.local_element(2 * node.node), velocity.local_element(2 * node.node + 1) });

        Vector2      direction[2];
        double       value[2];
        unsigned int n         = 0;
        const auto   prescribe = [&](const Vector2 &d, const double increment) {
          if (n == 0 || (n == 1 && std::abs(cross(direction[0], d)) > parallel))
            {
              direction[n] = d;
              value[n++]   = increment;
            }
        };

        if (node.on_axis)
          prescribe(Vector2({ 1., 0. }), -v[0]);
        if (node.on_symmetry)
          prescribe(node.symmetry_normal, -(v * node.symmetry_normal));
        for (const dealii::types::boundary_id id : node.prescribed)
          if (const unsigned int c = condition_of(id); c != no_tool)
            {
              const Point x = state.node_position(node.node) + theta * time_step * v;
              for (unsigned int i = 0; i < 2; ++i)
                if (scene.boundaries[c].velocity[i])
                  {
                    Vector2 d;
                    d[i] = 1;
                    prescribe(d,
                              scene.boundaries[c].velocity[i](x, state.time + theta * time_step) -
                                  v[i]);
                  }
            }
        const NodeContact &contact = nodes[b];
        for (unsigned int i = 0; i < 2; ++i)
          if (contact.tool[i] != no_tool)
            prescribe(contact.normal[i], -contact.gap[i] / time_step);
        if (contact.active() && contact.share == 1 &&
            scene.tools[contact.tool[0]].friction.kind() == laws::FrictionKind::sticking)
          {
            const Vector2 along = tangent(contact.normal[0]);
            prescribe(along, (tool_velocities[contact.tool[0]] - v) * along);
          }

        if (n == 0)
          continue;
        NodeFrame frame;
        frame.node = node.node;
        if (n == 1)
          {
            frame.axis         = { { direction[0], tangent(direction[0]) } };
            frame.fixed[0]     = true;
            frame.fixed[1]     = false;
            frame.increment[0] = value[0];
            frame.increment[1] = 0;
          }
        else
          {
            // both components follow: dv . d_i = value_i
            const double sine = cross(direction[0], direction[1]);
            frame.axis        = { { Vector2({ 1., 0. }), Vector2({ 0., 1. }) } };
            frame.fixed[0] = frame.fixed[1] = true;
            frame.increment[0] = (value[0] * direction[1][1] - value[1] * direction[0][1]) / sine;
            frame.increment[1] = (value[1] * direction[0][0] - value[0] * direction[1][0]) / sine;
          }
        frames.push_back(frame);
      }
  }
} // namespace axiforge::solvers
