// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/solvers/interface_friction.h>

namespace axiforge::solvers
{
  using laws::FrictionKind;

  namespace
  {
    /// A law whose traction is bounded by the flow stress.
    bool capped(const FrictionKind kind)
    {
      return kind == FrictionKind::coulomb || kind == FrictionKind::shear ||
             kind == FrictionKind::arctan || kind == FrictionKind::tangential_forces ||
             kind == FrictionKind::sticking;
    }


    /// Largest stored traction that the primal-dual tangent may use [MPa]: the cap; for norton,
    /// which has none, K (v^2 + v0^2)^(q/2), so that the tangent is at least q times the secant.
    /// Without a bound it can vanish, and the interface of a stiff law slides freely for one
    /// iteration.
    double dual_bound(const laws::Friction         &friction,
                      const laws::FrictionResponse &response,
                      const double                  slip,
                      const double                  cap)
    {
      if (friction.kind() != FrictionKind::norton)
        return cap;
      return response.secant * std::hypot(slip, friction.regularisation_velocity());
    }


    /// A value of the Gauss points, continued to a node of a side and kept near their range.
    template <typename PointData, typename Value>
    double continue_to_side(const PointData   *points,
                            const unsigned int side,
                            const unsigned int a,
                            const Value       &value)
    {
      const double *weights = ReferenceCell::get().to_side[side][a];
      double        sum = 0, low = value(points[0]), high = low;
      for (unsigned int q = 0; q < n_points; ++q)
        {
          const double v = value(points[q]);
          sum += weights[q] * v;
          low  = std::min(low, v);
          high = std::max(high, v);
        }
      return std::clamp(sum, 0.5 * low, 2 * high);
    }


    template <typename PointData, typename Value>
    std::array<double, 3>
    side_values(const PointData *points, const unsigned int side, const Value &value)
    {
      std::array<double, 3> values;
      for (unsigned int a = 0; a < 3; ++a)
        values[a] = continue_to_side(points, side, a, value);
      return values;
    }
  } // namespace


  InterfaceFriction::InterfaceFriction(const scene::Scene &scene, const State &state)
      : scene(scene)
      , state(state)
      , lags(false)
      , refreshes(false)
  {
    bool any = false, layer = false;
    for (const scene::Tool &tool : scene.tools)
      {
        const FrictionKind kind = tool.friction.kind();
        any |= kind != FrictionKind::none;
        layer |= kind == FrictionKind::smm;
        lags |= capped(kind) && scene.material.depends_on_rate();
        refreshes |= lags && kind != FrictionKind::sticking;
      }
    if (!any)
      return;
    stored = state.edge_friction;
    edges_.resize(stored.size());
    tangents.resize(stored.size());
    caps.resize(stored.size());
    if (layer)
      layers.resize(stored.size());
    // After a change of the mesh there are no rates of edges: those of the cells are as good.
    if (lags && state.step > 0)
      for (unsigned int e = 0; e < stored.size(); ++e)
        if (const BoundaryEdge &edge = state.tables.edges[e];
            edge.owned && stored[e].strain_rate == std::array<double, 3>{})
          stored[e].strain_rate = side_values(state.cell_history[edge.cell].strain_rate.data(),
                                              edge.side, [](const double rate) { return rate; });
  }


  void InterfaceFriction::evaluate(const ContactSet             &contact,
                                   const Field                  &position,
                                   const Field                  &velocity,
                                   const std::vector<FlowPoint> &points,
                                   const double                  time_step,
                                   const bool                    newton)
  {
    if (!optional_features || edges_.empty())
      return;
    const Phase phase("friction");
    for (unsigned int e = 0; e < edges_.size(); ++e)
      {
        const BoundaryEdge &boundary = state.tables.edges[e];
        Edge               &edge     = edges_[e];
        edge.tool                    = no_tool;
        if (!boundary.owned)
          continue;
        const NodeContact &middle = contact.nodes[boundary.boundary_nodes[2]];
        if (!middle.active())
          continue;
        const FrictionKind kind = scene.tools[middle.tool[0]].friction.kind();
        if (kind == FrictionKind::none)
          continue;
        // A node that sticks is held; one that cannot bear that bears a share of what shear can.
        std::array<double, 3> share;
        for (unsigned int a = 0; a < 3; ++a)
          {
            share[a] = contact.nodes[boundary.boundary_nodes[a]].share;
            if (kind == FrictionKind::sticking && share[a] == 1)
              share[a] = 0;
          }
        if (kind == FrictionKind::sticking && share == std::array<double, 3>{})
          continue;
        const ContactSet::EdgeContact touch = contact.edge(e, position);

        edge.tool                   = touch.tool;
        edge.measure                = touch.measure;
        const Vector2 tool_velocity = contact.tool_velocity(touch.tool);
        for (unsigned int a = 0; a < 3; ++a)
          {
            edge.tangent[a] = ContactSet::tangent(touch.normal[a]);
            edge.slip[a]    = 0;
            for (unsigned int c = 0; c < 2; ++c)
              edge.slip[a] +=
                  (velocity.local_element(2 * boundary.nodes[a] + c) - tool_velocity[c]) *
                  edge.tangent[a][c];
          }

        const FlowPoint *cell = points.data() + n_points * boundary.cell;
        const auto       strain =
            side_values(cell, boundary.side, [](const FlowPoint &p) { return p.strain; });
        if (kind == FrictionKind::smm)
          {
            std::array<double, 3> viscosity{};
            if (scene.tools[touch.tool].friction.workpiece_viscosity())
              viscosity =
                  side_values(cell, boundary.side, [](const FlowPoint &p) { return p.viscosity; });
            std::array<Point, 3> x;
            for (unsigned int a = 0; a < 3; ++a)
              for (unsigned int c = 0; c < 2; ++c)
                x[a][c] = position.local_element(2 * boundary.nodes[a] + c);
            evaluate_layer(e, strain, viscosity, touch.normal, x, touch.weight, newton);
          }
        else
          {
            std::array<double, 3> flow_stress{};
            if (capped(kind))
              for (unsigned int a = 0; a < 3; ++a)
                {
                  // The rate lags: taken from the present iterate it keeps Newton's method from
                  // converging where friction is high (doc/theory.md, section 4).
                  double rate = scene.characteristic_rate;
                  if (lags && stored[e].strain_rate[a] > 0)
                    {
                      rate                 = stored[e].strain_rate[a];
                      const double earlier = stored[e].earlier_rate[a];
                      if (earlier > 0 && state.earlier_time_step > 0)
                        rate = std::clamp(
                            rate + (rate - earlier) * (time_step + state.last_time_step) /
                                       (state.last_time_step + state.earlier_time_step),
                            0.5 * rate, 2 * rate);
                    }
                  flow_stress[a] = scene.material.flow_stress(strain[a], rate).value;
                }
            evaluate_traction(e, flow_stress, contact, newton);
          }
        for (unsigned int a = 0; a < 3; ++a)
          {
            edge.force[a] *= share[a];
            edge.traction[a] *= share[a];
            for (unsigned int b = 0; b < 3; ++b)
              edge.matrix[a][b] *= std::sqrt(share[a] * share[b]);
          }
        edge.power = 0;
        for (unsigned int a = 0; a < 3; ++a)
          edge.power += edge.force[a] * edge.slip[a];
      }
  }


  void InterfaceFriction::evaluate_traction(const unsigned int           e,
                                            const std::array<double, 3> &flow_stress,
                                            const ContactSet            &contact,
                                            const bool                   newton)
  {
    Edge                 &edge     = edges_[e];
    const laws::Friction &friction = scene.tools[edge.tool].friction;
    for (unsigned int a = 0; a < 3; ++a)
      {
        for (unsigned int b = 0; b < 3; ++b)
          edge.matrix[a][b] = 0;
        const NodeContact        &node = contact.nodes[state.tables.edges[e].boundary_nodes[a]];
        const laws::FrictionPoint point{ edge.slip[a], std::max(0., node.pressure), flow_stress[a],
                                         stored[e].previous_slip[a], stored[e].has_previous[a] };
        const laws::FrictionResponse response = friction.evaluate(point);
        edge.traction[a]                      = response.traction;
        edge.force[a]                         = edge.measure[a] * response.traction;
        caps[e][a]                            = friction.cap(point.pressure, point.flow_stress);
        tangents[e][a]                        = newton ? laws::primal_dual_tangent(
                                                             response, stored[e].traction[a],
                                                             dual_bound(friction, response, edge.slip[a], caps[e][a]))
                                                       : response.secant;
        edge.matrix[a][a]                     = edge.measure[a] * tangents[e][a];
      }
  }


  void InterfaceFriction::evaluate_layer(const unsigned int            e,
                                         const std::array<double, 3>  &strain,
                                         const std::array<double, 3>  &viscosity,
                                         const std::array<Vector2, 3> &normals,
                                         const std::array<Point, 3>   &nodes,
                                         const std::array<double, 3>  &weights,
                                         const bool                    newton)
  {
    Edge                 &edge     = edges_[e];
    const laws::Friction &friction = scene.tools[edge.tool].friction;

    // The layer resists sliding only: its interface nodes move along the tool. Of an edge that
    // touches in half the free end continues the slip of the other two nodes.
    double continuation[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    for (unsigned int a = 0; a < 2; ++a)
      if (weights[a] == 0)
        {
          const bool other       = weights[1 - a] != 0;
          continuation[a][a]     = 0;
          continuation[a][1 - a] = other ? -1 : 0;
          continuation[a][2]     = other ? 2 : 1;
        }

    laws::SmmEdge &layer = layers[e];
    layer.nodes          = nodes;
    for (unsigned int a = 0; a < 3; ++a)
      {
        layer.normals[a] = -1. * normals[a];
        double slip      = 0;
        for (unsigned int b = 0; b < 3; ++b)
          slip += continuation[a][b] * edge.slip[b];
        layer.slip[a] = slip * edge.tangent[a];
      }
    layer.weights             = weights;
    layer.strain              = strain;
    layer.viscosity           = viscosity;
    layer.thickness           = friction.layer_thickness();
    layer.beta                = friction.beta();
    layer.smallest_rate       = scene.flow.regularisation * scene.characteristic_rate;
    layer.workpiece_viscosity = friction.workpiece_viscosity();
    layer.element             = friction.layer_element();
    layer.picard              = !newton;

    if (stored[e].layer.empty())
      stored[e].layer.emplace_back(); // zero stress
    laws::SmmResult result;
    laws::smm_layer(layer, scene.material, stored[e].layer[0], result, true);

    double force[3], matrix[3][3];
    for (unsigned int a = 0; a < 3; ++a)
      {
        force[a] =
            result.force[2 * a] * edge.tangent[a][0] + result.force[2 * a + 1] * edge.tangent[a][1];
        for (unsigned int b = 0; b < 3; ++b)
          {
            matrix[a][b] = 0;
            for (unsigned int c = 0; c < 2; ++c)
              for (unsigned int d = 0; d < 2; ++d)
                matrix[a][b] += edge.tangent[a][c] * result.stiffness(2 * a + c, 2 * b + d) *
                                edge.tangent[b][d];
          }
      }
    for (unsigned int a = 0; a < 3; ++a)
      {
        edge.force[a] = 0;
        for (unsigned int i = 0; i < 3; ++i)
          edge.force[a] += continuation[i][a] * force[i];
        for (unsigned int b = 0; b < 3; ++b)
          {
            edge.matrix[a][b] = 0;
            for (unsigned int i = 0; i < 3; ++i)
              for (unsigned int j = 0; j < 3; ++j)
                edge.matrix[a][b] += continuation[i][a] * matrix[i][j] * continuation[j][b];
          }
      }
    for (unsigned int a = 0; a < 3; ++a)
      edge.traction[a] = edge.measure[a] > 0 ? edge.force[a] / edge.measure[a] : 0;
  }


  void InterfaceFriction::update_dual(const Field &increment)
  {
    for (unsigned int e = 0; e < edges_.size(); ++e)
      {
        const Edge &edge = edges_[e];
        if (edge.tool == no_tool)
          continue;
        const BoundaryEdge   &boundary = state.tables.edges[e];
        std::array<double, 3> slip;
        for (unsigned int a = 0; a < 3; ++a)
          slip[a] = increment.local_element(2 * boundary.nodes[a]) * edge.tangent[a][0] +
                    increment.local_element(2 * boundary.nodes[a] + 1) * edge.tangent[a][1];
        if (scene.tools[edge.tool].friction.kind() == FrictionKind::smm)
          {
            const laws::SmmEdge   &layer = layers[e];
            std::array<Vector2, 3> move;
            for (unsigned int a = 0; a < 3; ++a)
              {
                double s = slip[a];
                if (a < 2 && layer.weights[a] == 0)
                  s = layer.weights[1 - a] != 0 ? 2 * slip[2] - slip[1 - a] : slip[2];
                move[a] = s * edge.tangent[a];
              }
            laws::smm_update_dual(layer, scene.material, move, stored[e].layer[0]);
          }
        else
          for (unsigned int a = 0; a < 3; ++a)
            stored[e].traction[a] =
                std::clamp(edge.traction[a] + tangents[e][a] * slip[a], -caps[e][a], caps[e][a]);
      }
  }


  void InterfaceFriction::reset_dual()
  {
    for (EdgeFriction &edge : stored)
      {
        edge.traction = {};
        edge.layer.clear();
      }
  }


  bool InterfaceFriction::refresh_lagged_rates(const std::vector<FlowPoint> &points)
  {
    if (!refreshes)
      return false;
    for (unsigned int e = 0; e < edges_.size(); ++e)
      if (state.tables.edges[e].owned)
        stored[e].strain_rate = side_values(points.data() + n_points * state.tables.edges[e].cell,
                                            state.tables.edges[e].side,
                                            [](const FlowPoint &p) { return p.effective_rate; });
    return true;
  }


  std::vector<EdgeFriction> InterfaceFriction::history(const std::vector<FlowPoint> &points) const
  {
    std::vector<EdgeFriction> next = stored;
    for (unsigned int e = 0; e < edges_.size(); ++e)
      {
        const BoundaryEdge &boundary = state.tables.edges[e];
        const Edge         &edge     = edges_[e];
        if (!boundary.owned)
          continue;
        for (unsigned int a = 0; a < 3; ++a)
          {
            next[e].has_previous[a]  = edge.tool != no_tool;
            next[e].previous_slip[a] = edge.tool != no_tool ? edge.slip[a] : 0;
          }
        if (lags)
          {
            next[e].earlier_rate =
                state.step > 0 ? state.edge_friction[e].strain_rate : std::array<double, 3>{};
            next[e].strain_rate =
                side_values(points.data() + n_points * boundary.cell, boundary.side,
                            [](const FlowPoint &p) { return p.effective_rate; });
          }
      }
    return next;
  }
} // namespace axiforge::solvers
