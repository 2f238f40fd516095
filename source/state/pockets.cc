// SPDX-License-Identifier: GPL-2.0-or-later
#include <cmath>
#include <limits>

#include <deal.II/base/mpi.h>

#include <axiforge/state/pockets.h>

namespace axiforge
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// How far a tool is looked for, over the size of the workpiece.
    constexpr double farthest = 0.25;

    /// A ray has met a tool when it is so near, over that distance.
    constexpr double met = 1e-4;

    /// A ray that runs along a tool for so many steps leaves the pocket.
    constexpr unsigned int most_steps = 60;


    /// Places looked at on a free edge, and on one between two tools, which may cross the mouth of
    /// a narrow gap.
    constexpr unsigned int places = 4, places_between = 32;


    struct Hit
    {
      unsigned int tool     = no_tool; ///< no_tool: none
      double       distance = 0;       ///< along the ray [mm]
    };


    /// The tool that a ray from the surface meets: it goes on by the distance to the nearest one.
    Hit trace(const scene::Scene         &scene,
              const std::vector<Vector2> &shift,
              const Point                &from,
              const Vector2              &direction,
              const double                reach)
    {
      Hit hit;
      for (unsigned int step = 0; step < most_steps && hit.distance <= reach; ++step)
        {
          const Point  x    = from + hit.distance * direction;
          double       near = std::numeric_limits<double>::max();
          unsigned int tool = no_tool;
          for (unsigned int i = 0; i < shift.size(); ++i)
            {
              std::array<tools::Contact, 2> found;
              if (scene.tools[i].profile.find(Point(x - shift[i]), reach, found) > 0 &&
                  found[0].past_end <= met * reach && found[0].gap < near)
                {
                  near = found[0].gap;
                  tool = i;
                }
            }
          if (tool == no_tool)
            return {};
          if (near <= met * reach)
            {
              hit.tool = tool;
              return hit;
            }
          hit.distance += near;
        }
      return {};
    }

    /// Places of the tools at the present time [mm], and their velocities [mm/s].
    struct Tools
    {
      std::vector<Vector2> shift, speed;

      explicit Tools(const scene::Scene &scene, const double time)
      {
        for (const scene::Tool &tool : scene.tools)
          {
            shift.push_back(tool.motion.displacement(time));
            speed.push_back(tool.motion.velocity(time));
          }
      }
    };


    /// Adds what lies in front of an edge. @return false where it looks into the open
    bool add_edge(const scene::Scene &scene,
                  const State        &state,
                  const Tools        &tools,
                  const BoundaryEdge &edge,
                  const unsigned int  n_places,
                  Pockets            &pockets)
    {
      std::array<Point, 3> x;
      for (unsigned int a = 0; a < 3; ++a)
        x[a] = state.node_position(edge.nodes[a]);
      const double reach = farthest * state.size;
      // The workpiece is on the left of the table's edges on two of the four sides.
      const double sign = edge.side == 0 || edge.side == 3 ? -1 : 1;
      for (unsigned int i = 0; i < n_places; ++i)
        {
          const double  s       = (i + 0.5) / n_places;
          const Vector2 tangent = (4 * s - 3) * Vector2(x[0]) + (4 * s - 1) * Vector2(x[1]) +
                                  (4 - 8 * s) * Vector2(x[2]);
          const double length = tangent.norm();
          if (!(length > 0))
            continue;
          const Vector2 outward  = sign / length * Vector2({ tangent[1], -tangent[0] });
          const double  shape[3] = { (1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s) };
          Point         place;
          Vector2       velocity;
          for (unsigned int a = 0; a < 3; ++a)
            for (unsigned int c = 0; c < 2; ++c)
              {
                place[c] += shape[a] * x[a][c];
                velocity[c] += shape[a] * state.velocity.local_element(2 * edge.nodes[a] + c);
              }
          const Hit hit = trace(scene, tools.shift, place, outward, reach);
          if (hit.tool == no_tool)
            return false;
          const double area = length / n_places * 2 * M_PI * place[0];
          pockets.volume += area * hit.distance;
          pockets.closing_rate += area * ((velocity - tools.speed[hit.tool]) * outward);
        }
      return true;
    }
  } // namespace


  double Pockets::time_to_fill() const
  {
    if (!closed)
      return std::numeric_limits<double>::infinity();
    if (!(volume > 0))
      return 0;
    return closing_rate > 0 ? volume / closing_rate : std::numeric_limits<double>::infinity();
  }


  Pockets find_pockets(const scene::Scene &scene, const State &state)
  {
    Pockets     pockets;
    const Tools tools(scene, state.time);
    bool        open = scene.tools.empty();
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (open)
          break;
        const BoundaryNode &middle = state.tables.boundary_nodes[edge.boundary_nodes[2]];
        if (!edge.owned || middle.on_axis || middle.on_symmetry)
          continue;
        const auto touch = [&](const unsigned int a) -> const NodeContact & {
          return state.contacts[edge.boundary_nodes[a]];
        };
        if (touch(0).active() && touch(1).active() && touch(2).active() &&
            touch(0).tool[0] == touch(1).tool[0])
          continue; // it lies on one tool
        open = !middle.free_surface ||
               !add_edge(scene, state, tools, edge,
                         touch(0).active() && touch(1).active() ? places_between : places, pockets);
      }
    pockets.closed       = !MPI::logical_or(open, state.communicator);
    pockets.volume       = MPI::sum(pockets.volume, state.communicator);
    pockets.closing_rate = MPI::sum(pockets.closing_rate, state.communicator);
    return pockets;
  }


  bool edge_over_gap(const scene::Scene &scene, const State &state)
  {
    const Tools tools(scene, state.time);
    bool        any = false;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        const NodeContact &begin = state.contacts[edge.boundary_nodes[0]],
                          &end   = state.contacts[edge.boundary_nodes[1]];
        Pockets unused;
        if (!any && edge.owned && begin.active() && end.active() && begin.tool[0] != end.tool[0] &&
            begin.tool[0] != end.tool[1] && begin.tool[1] != end.tool[0])
          any = !add_edge(scene, state, tools, edge, places_between, unused);
      }
    return MPI::logical_or(any, state.communicator);
  }
} // namespace axiforge
