// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/mpi.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/solvers/contact_pressure.h>
#include <axiforge/solvers/edge_points.h>
#include <axiforge/solvers/flow_solver.h>
#include <axiforge/state/contact_ends.h>

namespace axiforge::solvers
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    Vector2 node_value(const Field &field, const unsigned int node)
    {
      return Vector2({ field.local_element(2 * node), field.local_element(2 * node + 1) });
    }


    /**
     * Radius where the slip changes sign [mm], NaN if it does not. Where several do, the outermost;
     * signs of nodes that hardly slip (sticking zones) do not count, unless they change just once
     * between two that do.
     */
    double neutral_radius(std::vector<std::array<double, 2>> radius_and_slip)
    {
      std::sort(radius_and_slip.begin(), radius_and_slip.end());
      double largest = 0;
      for (const auto &entry : radius_and_slip)
        largest = std::max(largest, std::abs(entry[1]));
      double     radius = std::numeric_limits<double>::quiet_NaN();
      const auto zero   = [](const std::array<double, 2> &a, const std::array<double, 2> &b) {
        return (a[0] * b[1] - b[0] * a[1]) / (b[1] - a[1]);
      };
      const unsigned int none = radius_and_slip.size();
      unsigned int       last = none;
      for (unsigned int i = 0; i < radius_and_slip.size(); ++i)
        {
          if (std::abs(radius_and_slip[i][1]) < 1e-3 * largest)
            continue;
          if (last != none && radius_and_slip[last][1] * radius_and_slip[i][1] < 0)
            {
              radius                 = zero(radius_and_slip[last], radius_and_slip[i]);
              unsigned int n_changes = 0, at = 0;
              for (unsigned int j = last; j < i; ++j)
                if (radius_and_slip[j][1] * radius_and_slip[j + 1][1] < 0)
                  {
                    at = j;
                    ++n_changes;
                  }
              if (n_changes == 1)
                radius = zero(radius_and_slip[at], radius_and_slip[at + 1]);
            }
          last = i;
        }
      return radius;
    }
  } // namespace


  void FlowSolver::finish(FlowResult &result)
  {
    const Phase phase("figures of the step");
    // Exactly along the axis and the symmetry lines: round-off would add up in the positions.
    for (const BoundaryNode &node : state.tables.boundary_nodes)
      {
        double *v = &velocity.local_element(2 * node.node);
        if (node.on_axis)
          v[0] = 0;
        if (node.on_symmetry)
          for (unsigned int c = 0; c < 2; ++c)
            if (std::abs(node.symmetry_normal[c]) == 1)
              v[c] = 0;
      }
    result.velocity = velocity;
    result.velocity.update_ghost_values();
    result.edge_friction = friction->history(points);

    StepRecord &record = result.record;
    record_powers(record);
    record_tools(record);
    record_boundaries(record);
    record.power_residual = record.power_tools + record.power_boundaries - record.power_plastic -
                            record.power_friction - record.power_contact - record.power_volume;
    if (optional_features && scene.accuracy.estimated)
      estimate_solver_errors(record);
    if (scene.flow.estimate_condition)
      record.condition = system->condition();

    if (!scene.tools.empty())
      recover_contact_pressures(state, position, contact->nodes);
    result.contacts = contact->nodes;
    result.cell_history.resize(state.tables.cells.size());
    CellGeometry geometry;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        CellDofs x;
        load_cell(position, cell, x);
        cell_geometry(x, geometry);
        CellHistory &history = result.cell_history[cell];
        history.pressure     = pressure[cell];
        for (unsigned int q = 0; q < n_points; ++q)
          {
            const FlowPoint &point = points[n_points * cell + q];
            history.mean_stress[q] = 0;
            for (unsigned int i = 0; i < n_pressure; ++i)
              history.mean_stress[q] += geometry.pressure_basis[q][i] * pressure[cell][i];
            for (unsigned int c = 0; c < 4; ++c)
              history.stress[q][c] = 2 * point.viscosity * point.strain_rate[c];
            history.strain_rate[q] = point.effective_rate;
            history.flow_stress[q] = point.flow_stress;
          }
      }
  }


  void FlowSolver::estimate_solver_errors(StepRecord &record) const
  {
    // What the rounding of the corner at rest leaves out of the dissipation, at this velocity.
    double       left_out = 0;
    CellGeometry geometry;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        CellDofs x;
        load_cell(position, cell, x);
        cell_geometry(x, geometry);
        for (unsigned int q = 0; q < n_points; ++q)
          {
            const FlowPoint &point = points[n_points * cell + q];
            const double     sharp =
                scene.material.flow_stress(point.strain, point.effective_rate).value;
            left_out += geometry.weight[q] * point.effective_rate *
                        (sharp - 3 * point.viscosity * point.effective_rate);
          }
      }
    for (const InterfaceFriction::Edge &edge : friction->edges())
      if (edge.tool != no_tool)
        {
          const laws::Friction    &law  = scene.tools[edge.tool].friction;
          const laws::FrictionKind kind = law.kind();
          if (kind != laws::FrictionKind::shear && kind != laws::FrictionKind::coulomb)
            continue;
          for (unsigned int a = 0; a < 3; ++a)
            if (edge.slip[a] != 0)
              left_out += edge.force[a] * edge.slip[a] *
                          (std::hypot(1, law.regularisation_velocity() / edge.slip[a]) - 1);
        }

    // The force that nothing balances, times the speed of its node.
    const Field &forces     = balance();
    double       unbalanced = 0;
    for (unsigned int node = 0; node < state.tables.n_owned_nodes; ++node)
      {
        const Vector2 r = node_value(forces, node), v = node_value(velocity, node);
        const int     f = frame_of_node[node];
        for (unsigned int i = 0; i < 2; ++i)
          if (f < 0)
            unbalanced += std::abs(r[i] * v[i]);
          else if (!frames[f].fixed[i])
            unbalanced += std::abs((r * frames[f].axis[i]) * (v * frames[f].axis[i]));
      }

    const double power           = std::abs(record.power_tools + record.power_boundaries);
    left_out                     = std::abs(MPI::sum(left_out, state.communicator));
    unbalanced                   = MPI::sum(unbalanced, state.communicator);
    record.errors.regularisation = power > 0 ? left_out / power : 0;
    record.errors.nonlinear = power > 0 ? (unbalanced + std::abs(record.power_volume)) / power : 0;
  }


  void FlowSolver::record_powers(StepRecord &record)
  {
    double       plastic = 0, volume = 0, largest = 0;
    CellGeometry geometry;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        CellDofs x;
        load_cell(position, cell, x);
        cell_geometry(x, geometry);
        for (unsigned int q = 0; q < n_points; ++q)
          {
            const FlowPoint &point = points[n_points * cell + q];
            const double    *e     = point.strain_rate;
            plastic += geometry.weight[q] * 2 * point.viscosity *
                       (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2 * e[3] * e[3]);
            largest = std::max(largest, point.effective_rate);
          }
        for (unsigned int i = 0; i < n_pressure; ++i)
          volume += pressure[cell][i] * divergences[cell / n_lanes].flux[i][cell % n_lanes];
      }
    double slip = 0;
    for (const InterfaceFriction::Edge &edge : friction->edges())
      if (edge.tool != no_tool)
        slip += edge.power;

    record.power_plastic       = MPI::sum(plastic, state.communicator);
    record.power_volume        = MPI::sum(volume, state.communicator);
    record.power_friction      = MPI::sum(slip, state.communicator);
    record.largest_strain_rate = MPI::max(largest, state.communicator);
    if (!cell_external.empty())
      record.power_boundaries += external * velocity;
  }


  void FlowSolver::record_tools(StepRecord &record)
  {
    if (scene.tools.empty())
      return;
    contact->set_pressures(position);

    // Force of each tool on the workpiece: reactions along the normals, less the friction that
    // resists.
    std::vector<Vector2>                            force(scene.tools.size());
    std::vector<double>                             radius(scene.tools.size(), 0.);
    std::vector<std::vector<std::array<double, 2>>> slip(scene.tools.size());
    double                                          power_contact = 0, tension = 0;

    for (unsigned int b = 0; b < contact->nodes.size(); ++b)
      {
        const BoundaryNode &node  = state.tables.boundary_nodes[b];
        NodeContact        &touch = contact->nodes[b];
        touch.slip = touch.traction = 0;
        if (!touch.active())
          continue;
        const Vector2 v = node_value(velocity, node.node);
        const Vector2 t = ContactSet::tangent(touch.normal[0]);
        touch.slip      = (v - contact->tool_velocity(touch.tool[0])) * t;
        const bool sticking =
            scene.tools[touch.tool[0]].friction.kind() == laws::FrictionKind::sticking &&
            touch.share == 1;
        if (sticking)
          touch.slip = 0;
        if (!node.owned)
          continue;
        for (unsigned int i = 0; i < 2; ++i)
          if (touch.tool[i] != no_tool)
            {
              const Vector2 relative = v - contact->tool_velocity(touch.tool[i]);
              force[touch.tool[i]] += touch.reaction[i] * touch.normal[i];
              power_contact -= touch.reaction[i] * (relative * touch.normal[i]);
              if (contact->adheres)
                tension += std::max(0., -touch.reaction[i]);
              radius[touch.tool[i]] =
                  std::max(radius[touch.tool[i]],
                           state.position.local_element(2 * node.node) + time_step * v[0]);
            }
        if (sticking && touch.tool[1] == no_tool && !node.on_axis && !node.on_symmetry)
          force[touch.tool[0]] += (node_value(balance(), node.node) * t) * t;
        slip[touch.tool[0]].push_back({ { position.local_element(2 * node.node), touch.slip } });
      }
    add_contact_ends(radius, slip);
    for (unsigned int e = 0; e < friction->edges().size(); ++e)
      {
        const InterfaceFriction::Edge &edge = friction->edges()[e];
        if (edge.tool != no_tool)
          for (unsigned int a = 0; a < 3; ++a)
            force[edge.tool] -= edge.force[a] * edge.tangent[a];
      }

    record.power_contact = MPI::sum(power_contact, state.communicator);
    record.tension       = MPI::sum(tension, state.communicator);
    record.tools.resize(scene.tools.size());
    for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
      {
        ToolRecord   &entry  = record.tools[tool];
        const Vector2 total  = MPI::sum(force[tool], state.communicator);
        const Vector2 speed  = contact->tool_velocity(tool);
        const double  along  = speed[1] < 0 ? -1 : 1;
        entry.force          = along * total[1] + 0.; // a tool out of contact feels 0, not -0
        entry.radial_force   = total[0];
        entry.contact_radius = MPI::max(radius[tool], state.communicator);
        record.power_tools += total * speed;

        std::vector<std::array<double, 2>> all = gather_rows(state.communicator, slip[tool]);
        entry.neutral_radius                   = neutral_radius(all);
      }

    // Friction traction of the nodes, from the forces of their edges.
    if (!friction->edges().empty())
      {
        friction_force.update_ghost_values();
        for (unsigned int b = 0; b < contact->nodes.size(); ++b)
          if (NodeContact &touch = contact->nodes[b]; touch.active())
            {
              const unsigned int node = state.tables.boundary_nodes[b].node;
              const double       area = contact->node_area(node);
              if (area > 0)
                touch.traction =
                    node_value(friction_force, node) * ContactSet::tangent(touch.normal[0]) / area;
            }
      }
  }


  void FlowSolver::add_contact_ends(std::vector<double>                             &radius,
                                    std::vector<std::vector<std::array<double, 2>>> &slip) const
  {
    const auto at_end = [&](const unsigned int node) {
      return Point(state.node_position(node) + time_step * node_value(velocity, node));
    };
    for (const ContactEnd &end :
         contact_ends(scene, state, contact->nodes, state.time + time_step, at_end))
      {
        const BoundaryEdge &edge = state.tables.edges[end.edge];
        const unsigned int  last = edge.nodes[end.last], next = edge.nodes[end.next];
        radius[end.tool]         = std::max(radius[end.tool], (1 - end.share) * at_end(last)[0] +
                                                                  end.share * at_end(next)[0]);
        const NodeContact &touch = contact->nodes[edge.boundary_nodes[end.last]];
        if (end.share == 0 || touch.tool[0] != end.tool ||
            scene.tools[end.tool].friction.kind() == laws::FrictionKind::sticking)
          continue;
        const auto between = [&](const double a, const double b) {
          return (1 - end.share) * a + end.share * b;
        };
        const Vector2 v = node_value(velocity, next) - contact->tool_velocity(end.tool);
        slip[end.tool].push_back(
            { { between(position.local_element(2 * last), position.local_element(2 * next)),
                between(touch.slip, v * ContactSet::tangent(touch.normal[0])) } });
      }
  }


  void FlowSolver::record_boundaries(StepRecord &record)
  {
    record.boundaries.resize(scene.boundaries.size());
    for (unsigned int i = 0; i < scene.boundaries.size(); ++i)
      {
        const BoundarySums sums =
            scene.boundaries[i].is_velocity ? sums_of_velocity(i) : sums_of_pressure(i);
        const double    extent = MPI::sum(sums.extent, state.communicator);
        const double    load   = MPI::sum(sums.load, state.communicator);
        BoundaryRecord &entry  = record.boundaries[i];
        entry.power            = MPI::sum(sums.power, state.communicator);
        entry.force            = MPI::sum(sums.force, state.communicator);
        entry.pressure         = extent != 0 ? load / extent : 0;
        // The power of pressures is among that of the external forces, see record_powers().
        if (scene.boundaries[i].is_velocity)
          record.power_boundaries += entry.power;
      }
  }


  FlowSolver::BoundarySums FlowSolver::sums_of_velocity(const unsigned int condition) const
  {
    BoundarySums sums;
    for (const BoundaryNode &node : state.tables.boundary_nodes)
      for (unsigned int c = 0; c < 2 && node.owned; ++c)
        {
          // Where two parts meet, the first that prescribes a component supplies its force.
          unsigned int owner = no_tool;
          for (const dealii::types::boundary_id id : node.prescribed)
            if (const unsigned int other = contact->condition_of(id);
                owner == no_tool && other != no_tool && scene.boundaries[other].velocity[c])
              owner = other;
          if (owner != condition)
            continue;
          const double f = node_value(internal, node.node)[c];
          sums.power += f * node_value(velocity, node.node)[c];
          sums.force += c == 1 ? f : 0;
        }
    // The mean pressure is the power over the volume that is swept, inwards, per time.
    sums.load = sums.power;
    for (const BoundaryEdge &edge : state.tables.edges)
      if (edge.owned && contact->condition_of(edge.id) == condition)
        for (const EdgePoint &point : edge_points(position, edge))
          sums.extent -= point.area * point.value(velocity, edge);
    return sums;
  }


  FlowSolver::BoundarySums FlowSolver::sums_of_pressure(const unsigned int condition) const
  {
    // A load at rest sweeps no volume: its mean is that over the area.
    BoundarySums sums;
    const double time = state.time + theta * time_step;
    for (const BoundaryEdge &edge : state.tables.edges)
      if (edge.owned && contact->condition_of(edge.id) == condition)
        for (const EdgePoint &point : edge_points(position, edge))
          {
            const double  p        = scene.boundaries[condition].pressure(point.x, time);
            const Vector2 traction = -p * point.area;
            sums.power += traction * point.value(velocity, edge);
            sums.force += traction[1];
            sums.load += p * point.area.norm();
            sums.extent += point.area.norm();
          }
    return sums;
  }
} // namespace axiforge::solvers
