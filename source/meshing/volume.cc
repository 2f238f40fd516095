// SPDX-License-Identifier: GPL-2.0-or-later
#include <limits>

#include <deal.II/base/mpi.h>

#include <axiforge/meshing/volume.h>
#include <axiforge/state/measures.h>

namespace axiforge::meshing
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// Nodes move by at most this share of their edges.
    constexpr double largest_move = 0.1;

    /// The volume is met to this share.
    constexpr double volume_tolerance = 1e-13;


    Vector2 at(const Field &field, const unsigned int node)
    {
      return Vector2({ field.local_element(2 * node), field.local_element(2 * node + 1) });
    }


    void set(Field &field, const unsigned int node, const Vector2 &value)
    {
      for (unsigned int c = 0; c < 2; ++c)
        field.local_element(2 * node + c) = value[c];
    }


    /// Outward normals of the free surface times the length it has at a node [mm], in the owned
    /// nodes and their copies.
    Field normals_of(const State &state)
    {
      Field normals(state.velocity);
      normals = 0;
      for (const BoundaryEdge &edge : state.tables.edges)
        {
          if (!edge.owned || !state.tables.boundary_nodes[edge.boundary_nodes[2]].free_surface)
            continue;
          std::array<Point, 3> x;
          for (unsigned int a = 0; a < 3; ++a)
            x[a] = state.node_position(edge.nodes[a]);
          const Vector2                chord   = x[1] - x[0];
          const std::array<Vector2, 3> tangent = { { 4 * (x[2] - x[0]) - chord,
                                                     4 * (x[1] - x[2]) - chord, chord } };
          // The cell's middle tells the outside.
          const Point  inside = state.node_position(state.tables.cells[edge.cell][8]);
          const double outward =
              chord[1] * (x[2][0] - inside[0]) - chord[0] * (x[2][1] - inside[1]);
          const double sign = outward > 0 ? 1 : -1;
          for (unsigned int a = 0; a < 3; ++a)
            for (unsigned int c = 0; c < 2; ++c)
              normals.local_element(2 * edge.nodes[a] + c) +=
                  sign * (c == 0 ? tangent[a][1] : -tangent[a][0]) / (a == 2 ? 1 : 2);
        }
      normals.compress(dealii::VectorOperation::add);
      normals.update_ghost_values();
      return normals;
    }


    /// In which each node moves: 1 along the outer normal far from all tools.
    /// @param shortest set to the length that a move of 1 is to be compared with [mm]
    Field directions_of(const scene::Scene &scene, const State &state, double &shortest)
    {
      const Field normals = normals_of(state);
      Field       directions(state.velocity);
      directions = 0;
      shortest   = std::numeric_limits<double>::max();
      for (unsigned int b = 0; b < state.tables.boundary_nodes.size(); ++b)
        {
          const BoundaryNode &node   = state.tables.boundary_nodes[b];
          const Vector2       normal = at(normals, node.node);
          const double        length = normal.norm();
          if (!node.free_surface || state.contacts[b].active() || !(length > 0) ||
              node.prescribed[0] != dealii::numbers::invalid_boundary_id)
            continue;
          const Point  x     = state.node_position(node.node);
          const double far   = 2 * length;
          double       clear = far;
          for (const scene::Tool &tool : scene.tools)
            {
              std::array<tools::Contact, 2> found;
              if (tool.profile.find(Point(x - tool.motion.displacement(state.time)), far, found) >
                  0)
                clear = std::min(clear, std::max(0., found[0].gap));
            }
          Vector2 direction = clear / far / length * normal;
          if (node.on_axis)
            direction[0] = 0;
          if (node.on_symmetry)
            direction -= (direction * node.symmetry_normal) * node.symmetry_normal;
          set(directions, node.node, direction);
          if (direction.norm() > 0)
            shortest = std::min(shortest, length / direction.norm());
        }
      shortest = MPI::min(shortest, state.communicator);
      directions.zero_out_ghost_values();
      directions.update_ghost_values(); // those of the owner
      return directions;
    }
  } // namespace


  double give_volume_back(const scene::Scene &scene, State &state, const double volume)
  {
    double missing = volume - measure(state).volume;
    if (std::abs(missing) <= volume_tolerance * volume)
      return missing;
    double      shortest;
    const Field directions = directions_of(scene, state, shortest);
    if (!(directions.linfty_norm() > 0))
      return missing;
    const double most = largest_move * shortest;
    // The volume is a cubic polynomial of the distance, almost a line: the secant's rule.
    const Field  start = state.position;
    const double whole = missing;
    const auto   move  = [&](const double distance) {
      state.position = start;
      state.position.add(distance, directions);
      state.position.update_ghost_values();
      return volume - measure(state).volume;
    };
    double before = 0, missing_before = whole, distance = std::copysign(1e-3 * most, whole);
    for (unsigned int i = 0; i < 30; ++i)
      {
        missing = move(distance);
        if (std::abs(missing) <= volume_tolerance * volume || missing == missing_before ||
            std::abs(distance) == most)
          break;
        const double next = distance - missing * (distance - before) / (missing - missing_before);
        before            = distance;
        missing_before    = missing;
        distance          = std::clamp(next, -most, most);
      }
    return missing;
  }
} // namespace axiforge::meshing
