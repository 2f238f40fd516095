// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/mpi.h>

#include <axiforge/base/phases.h>
#include <axiforge/base/tolerances.h>
#include <axiforge/solvers/contact_set.h>

namespace axiforge::solvers
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// Gap, in shares of the edges at a node, below which nothing is torn off.
    constexpr double least_departure = 1e-3;

    /// A reaction pulls if it is below this share of the forces of the cells at its node, negative.
    constexpr double tension_of_cells = 1e-6;

    /// The same before convergence, as a multiple of what the forces are still wrong by.
    constexpr double tension_of_residual = 10;

    /// The same over flow stress times area of the workpiece, where cells have hardly any forces.
    constexpr double tension_of_workpiece = 1e-10;

    /// A node may be released so often in a step as soon as it pulls; then only at convergence.
    constexpr unsigned int free_releases = 2;

    /// A node that is pressed by more than this share of the flow stress rubs, whatever it did
    /// before.
    constexpr double pressed = 0.1;

    /// A node whose friction has been taken gets back this share of it, and twice as much in each
    /// step after.
    constexpr double first_share = 0.1;

    /// Share of its edges by which a node that neither holds nor stays out may be in a tool.
    constexpr double deepest_left_in = 0.01;

    /// The same over the way of the tools in the step: with more a short step would lose the
    /// contact.
    constexpr double slowest_catch = 0.05;

    /// Nodes that pull with more than this share of what the worst one pulls with are released with
    /// it.
    constexpr double at_once = 0.5;

    /// An end of a profile that lies on another tool to this share of the size lets nothing
    /// through.
    constexpr double sealing = 1e-5;

    /// Share of a tool's way in a step by which it has to come nearer in order to press.
    constexpr double approach = 1e-6;

    double largest_flow_stress(const scene::Scene &scene, const State &state)
    {
      double largest = 0;
      for (const CellHistory &cell : state.cell_history)
        largest =
            std::max(largest, *std::max_element(cell.flow_stress.begin(), cell.flow_stress.end()));
      largest = MPI::max(largest, state.communicator);
      return largest > 0 ? largest : scene.material.flow_stress(0, scene.characteristic_rate).value;
    }
  } // namespace


  ContactSet::ContactSet(const scene::Scene &scene, const State &state, const bool adheres)
      : nodes(state.contacts)
      , scene(scene)
      , state(state)
      , adheres(adheres)
      , n_releases(nodes.size(), 0)
      , left_in(nodes.size(), 0.)
      , curvature(nodes.size(), 0.)
      , tool_velocities(scene.tools.size())
      , reach(0.05 * scene.size)
      , catch_distance(tolerance::caught * scene.size)
      , yield_stress(largest_flow_stress(scene, state))
      , least_tension(tension_of_workpiece * scene.size * scene.size * yield_stress)
  {
    for (const auto &group : state.boundary_ids)
      {
        if (group.second >= condition.size())
          condition.resize(group.second + 1, no_tool);
        for (unsigned int i = 0; i < scene.boundaries.size(); ++i)
          if (scene.boundaries[i].name == group.first)
            condition[group.second] = i;
      }
    if (!scene.tools.empty())
      length = edge_lengths();
    // What a node could not bear in the last step it is given back by and by.
    for (NodeContact &node : nodes)
      if (node.share < 1 && (!node.active() || node.pressure > pressed * yield_stress))
        node.share = std::min(1., 2 * node.share + first_share);
  }


  unsigned int ContactSet::condition_of(const dealii::types::boundary_id id) const
  {
    return id < condition.size() ? condition[id] : no_tool;
  }


  bool ContactSet::in_concave_pair(const unsigned int b,
                                   const unsigned int tool,
                                   const unsigned int face) const
  {
    for (unsigned int i = 0; i < 2; ++i)
      if (nodes[b].tool[i] == tool && nodes[b].face[i] == face)
        return true;
    return false;
  }


  void ContactSet::find_sealed_ends(const std::vector<Vector2> &shift)
  {
    sealed_ends.resize(scene.tools.size());
    for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
      for (const Point &end : scene.tools[tool].profile.free_ends())
        for (unsigned int other = 0; other < scene.tools.size(); ++other)
          {
            std::array<tools::Contact, 2> found;
            const double                  close = sealing * scene.size;
            if (other != tool &&
                scene.tools[other].profile.find(end + shift[tool] - shift[other], close, found) >
                    0 &&
                std::abs(found[0].gap) <= close)
              {
                sealed_ends[tool].push_back(end);
                break;
              }
          }
  }


  bool ContactSet::is_sealed(const unsigned int tool, const Point &end) const
  {
    for (const Point &sealed : sealed_ends[tool])
      if (sealed.distance(end) <= catch_distance)
        return true;
    return false;
  }


  bool ContactSet::presses(const double time_step) const
  {
    const double end = state.time + time_step;
    bool         any = false;
    for (const scene::Tool &tool : scene.tools)
      {
        const Vector2 before = tool.motion.displacement(state.time),
                      after  = tool.motion.displacement(end);
        const double way     = (after - before).norm();
        if (!(way > 0))
          continue;
        for (unsigned int b = 0; b < nodes.size() && !any; ++b)
          {
            const BoundaryNode           &node = state.tables.boundary_nodes[b];
            const Point                   x    = state.node_position(node.node);
            std::array<tools::Contact, 2> then, now;
            if (!node.free_surface || !node.owned)
              continue;
            const unsigned int n = tool.profile.find(x - after, 0, then);
            for (unsigned int i = 0; i < n; ++i)
              if (then[i].gap < -catch_distance)
                any |= tool.profile.find(x - before, way, now) == 0 ||
                       then[i].gap < now[0].gap - approach * way;
          }
      }
    return MPI::max(static_cast<unsigned int>(any), state.communicator) > 0;
  }


  bool ContactSet::any_tool_turns(const double time_step) const
  {
    // Less than half of the speed that the tool has had along the way that it came.
    const double end = state.time + time_step;
    for (const scene::Tool &tool : scene.tools)
      {
        const Vector2 now    = tool.motion.displacement(state.time);
        const Vector2 before = (now - tool.motion.displacement(state.time - state.last_time_step)) /
                               state.last_time_step,
                      after = (tool.motion.displacement(end) - now) / time_step;
        if (after * before < 0.5 * before.norm_square())
          return true;
      }
    return false;
  }


  double ContactSet::turning_stiffness(const unsigned int b, const double time_step) const
  {
    const NodeContact &contact = nodes[b];
    if (!contact.active() || contact.tool[1] != no_tool)
      return 0;
    return std::max(0., -curvature[b] * contact.reaction[0] * time_step);
  }


  void ContactSet::clear()
  {
    for (NodeContact &contact : nodes)
      contact = NodeContact();
  }


  unsigned int ContactSet::locate(const Field &velocity, const double time_step)
  {
    if (scene.tools.empty())
      return 0;
    const Phase  phase("contact search");
    const double end       = state.time + time_step;
    unsigned int n_changes = 0;
    way                    = scene.characteristic_speed * time_step;

    std::vector<Vector2> shift(scene.tools.size());
    for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
      {
        shift[tool] = scene.tools[tool].motion.displacement(end);
        tool_velocities[tool] =
            (shift[tool] - scene.tools[tool].motion.displacement(state.time)) / time_step;
      }
    if (sealed_ends.empty())
      find_sealed_ends(shift);

    struct Candidate
    {
      unsigned int tool, face;
      double       gap;
      Vector2      normal;
      double       curvature;
    };

    const auto locate_node = [&](const unsigned int b) {
      const BoundaryNode &node    = state.tables.boundary_nodes[b];
      NodeContact        &contact = nodes[b];
      Point               x       = state.node_position(node.node);
      for (unsigned int c = 0; c < 2; ++c)
        x[c] += time_step * velocity.local_element(2 * node.node + c);

      std::array<Candidate, 4> touching;
      unsigned int             n_touching = 0;
      for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
        {
          const bool was_active =
              contact.tool[0] == tool || contact.tool[1] == tool ||
              (node.axis_neighbour != no_tool && nodes[node.axis_neighbour].tool[0] == tool);
          std::array<tools::Contact, 2> found;
          const unsigned int            n = scene.tools[tool].profile.find(
                         x - shift[tool], was_active || !sealed_ends[tool].empty() ? reach : 0, found);
          for (unsigned int i = 0; i < n && n_touching < touching.size(); ++i)
            {
              const bool held   = i == 0 ? was_active : in_concave_pair(b, tool, found[i].face);
              double     gap    = found[i].gap;
              Vector2    normal = found[i].normal;
              if (found[i].past_end > catch_distance)
                {
                  if (!is_sealed(tool, found[i].closest))
                    continue; // the profile ends before: nothing is there
                  normal = found[i].end_normal;
                  gap    = (x - shift[tool] - found[i].closest) * normal;
                }
              if (held || gap < -std::max(catch_distance, left_in[b]))
                touching[n_touching++] = { tool, found[i].face, gap, normal, found[i].curvature };
            }
        }
      for (unsigned int i = 1; i < n_touching;
           ++i) // by insertion: there are two at most, as a rule
        for (unsigned int j = i; j > 0 && touching[j].gap < touching[j - 1].gap; --j)
          std::swap(touching[j], touching[j - 1]);
      // The deepest comes first, unless a held one comes before: order must not flicker.
      unsigned int second = no_tool;
      for (unsigned int i = 1; i < n_touching && second == no_tool; ++i)
        if (std::abs(cross(touching[0].normal, touching[i].normal)) > parallel)
          second = i;

      NodeContact next = contact;
      next.tool[0] = next.tool[1] = no_tool;
      if (n_touching > 0)
        {
          std::array<unsigned int, 2> order = { { 0, second } };
          if (second != no_tool && contact.active() && contact.tool[0] == touching[second].tool &&
              contact.face[0] == touching[second].face)
            order = { { second, 0 } };
          for (unsigned int i = 0; i < 2 && order[i] != no_tool; ++i)
            {
              next.tool[i]   = touching[order[i]].tool;
              next.face[i]   = touching[order[i]].face;
              next.normal[i] = touching[order[i]].normal;
              next.gap[i]    = touching[order[i]].gap;
            }
          curvature[b] = touching[order[0]].curvature;
        }
      if ((next.tool[0] != contact.tool[0] || next.tool[1] != contact.tool[1]) && node.owned)
        ++n_changes;
      contact = next;
    };

    // The nodes on the axis come last: they follow their neighbours.
    for (const bool follower : { false, true })
      for (unsigned int b = 0; b < nodes.size(); ++b)
        if (state.tables.boundary_nodes[b].free_surface &&
            (state.tables.boundary_nodes[b].axis_neighbour != no_tool) == follower)
          locate_node(b);
    return n_changes;
  }


  void ContactSet::update_reactions(const Field &force)
  {
    for (unsigned int b = 0; b < nodes.size(); ++b)
      {
        NodeContact &contact = nodes[b];
        if (!contact.active())
          {
            contact.reaction = { { 0, 0 } };
            continue;
          }
        const BoundaryNode &node = state.tables.boundary_nodes[b];
        const Vector2       f(
                  { force.local_element(2 * node.node), force.local_element(2 * node.node + 1) });

        // f = reaction * normal + a second reaction: of the other tool, the axis or the symmetry
        // line
        Vector2 second;
        bool    has_second = true;
        if (contact.tool[1] != no_tool)
          second = contact.normal[1];
        else if (node.on_axis)
          second = Vector2({ 1., 0. });
        else if (node.on_symmetry)
          second = node.symmetry_normal;
        else
          has_second = false;
        const double sine = has_second ? cross(contact.normal[0], second) : 0;
        if (std::abs(sine) > parallel)
          {
            contact.reaction[0] = cross(f, second) / sine;
            contact.reaction[1] =
                contact.tool[1] != no_tool ? cross(contact.normal[0], f) / sine : 0;
          }
        else
          contact.reaction = { { f * contact.normal[0], 0 } };
      }
  }


  unsigned int ContactSet::release_pulled(const Field &scale, const double residual)
  {
    const double doubt     = std::max(tension_of_cells, tension_of_residual * residual);
    unsigned int n_changes = 0;
    for (unsigned int b = 0; b < nodes.size(); ++b)
      if (nodes[b].active() && n_releases[b] < free_releases)
        n_changes +=
            release(b, allowed_tension(b, scale, doubt)) * state.tables.boundary_nodes[b].owned;
    return n_changes;
  }


  double ContactSet::adhesion(const unsigned int b) const
  {
    if (!adheres || !nodes[b].active())
      return 0;
    return std::min(scene.tools[nodes[b].tool[0]].friction.cap(0, yield_stress),
                    yield_stress / std::sqrt(3.)) *
           node_area(state.tables.boundary_nodes[b].node);
  }


  double
  ContactSet::allowed_tension(const unsigned int b, const Field &scale, const double share) const
  {
    const unsigned int node = state.tables.boundary_nodes[b].node;
    return share * (scale.local_element(2 * node) + scale.local_element(2 * node + 1)) +
           least_tension + adhesion(b);
  }


  bool ContactSet::release(const unsigned int b, const double allowed)
  {
    NodeContact       &contact   = nodes[b];
    const unsigned int neighbour = state.tables.boundary_nodes[b].axis_neighbour;
    bool               released  = false;
    if (relieve(b, allowed))
      return true;
    if (contact.tool[1] != no_tool && contact.reaction[1] < -allowed)
      {
        contact.tool[1] = no_tool;
        released        = true;
      }
    if (contact.active() && contact.reaction[0] < -allowed &&
        !(neighbour != no_tool && nodes[neighbour].active()))
      {
        contact.tool[0]   = contact.tool[1];
        contact.face[0]   = contact.face[1];
        contact.normal[0] = contact.normal[1];
        contact.gap[0]    = contact.gap[1];
        contact.tool[1]   = no_tool;
        released          = true;
      }
    if (released)
      {
        // To and fro, and not for its friction: it is left in the tool a little.
        if (++n_releases[b] > free_releases)
          left_in[b] = std::min(deepest_left_in *
                                    length.local_element(2 * state.tables.boundary_nodes[b].node),
                                slowest_catch * way);
        contact.reaction = { { 0, 0 } };
      }
    return released;
  }


  bool ContactSet::relieve(const unsigned int b, const double allowed)
  {
    NodeContact       &contact   = nodes[b];
    const unsigned int neighbour = state.tables.boundary_nodes[b].axis_neighbour;
    if ((n_releases[b] == 0 && contact.share == 1) || contact.share == 0 ||
        contact.tool[1] != no_tool || contact.reaction[0] >= -allowed ||
        (neighbour != no_tool && nodes[neighbour].active()) ||
        scene.tools[contact.tool[0]].friction.kind() == laws::FrictionKind::none)
      return false;
    contact.share = 0;
    return true;
  }


  unsigned int ContactSet::release_worst(const Field &scale)
  {
    // Of the owned nodes the one that pulls most; the ranks agree on it by its value.
    const auto tension = [&](const unsigned int b) {
      const unsigned int neighbour = state.tables.boundary_nodes[b].axis_neighbour;
      if (!nodes[b].active())
        return 0.;
      const double allowed = allowed_tension(b, scale, tension_of_cells);
      double       result  = 0;
      if (neighbour == no_tool || !nodes[neighbour].active())
        result = -nodes[b].reaction[0] - allowed;
      if (nodes[b].tool[1] != no_tool)
        result = std::max(result, -nodes[b].reaction[1] - allowed);
      return std::max(result, 0.);
    };
    double worst = 0;
    for (unsigned int b = 0; b < nodes.size(); ++b)
      worst = std::max(worst, tension(b));
    worst = MPI::max(worst, state.communicator);
    if (!(worst > 0))
      return 0;
    unsigned int n_changes = 0;
    for (unsigned int b = 0; b < nodes.size(); ++b)
      if (tension(b) >= worst * at_once)
        n_changes += release(b, allowed_tension(b, scale, tension_of_cells)) *
                     state.tables.boundary_nodes[b].owned;
    return n_changes;
  }


  unsigned int ContactSet::release_departing(const Field &scale)
  {
    // With two conditions, or where a neighbour decides, the sign of one reaction does not tell.
    const auto may_depart = [&](const unsigned int b) {
      return nodes[b].active() && nodes[b].tool[1] == no_tool && nodes[b].gap[0] > catch_distance &&
             state.tables.boundary_nodes[b].axis_neighbour == no_tool;
    };
    bool any = false;
    for (unsigned int b = 0; b < nodes.size() && !any; ++b)
      any = may_depart(b);
    if (MPI::max(static_cast<unsigned int>(any), state.communicator) == 0)
      return 0;

    unsigned int n_changes = 0;
    for (unsigned int b = 0; b < nodes.size(); ++b)
      {
        if (!may_depart(b))
          continue;
        const BoundaryNode &node   = state.tables.boundary_nodes[b];
        const double        strain = nodes[b].gap[0] / length.local_element(2 * node.node);
        const double        force =
            scale.local_element(2 * node.node) + scale.local_element(2 * node.node + 1);
        if (strain < least_departure || nodes[b].reaction[0] >= strain * force)
          continue;
        nodes[b].tool[0]  = no_tool;
        nodes[b].reaction = { { 0, 0 } };
        n_changes += node.owned;
      }
    return n_changes;
  }
} // namespace axiforge::solvers
