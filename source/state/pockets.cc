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
    Pockets              pockets;
    std::vector<Vector2> shift, speed;
    for (const scene::Tool &tool : scene.tools)
      {
        shift.push_back(tool.motion.displacement(state.time));
        speed.push_back(tool.motion.velocity(state.time));
      }
    const double reach = farthest * state.size;
    bool         open  = scene.tools.empty();
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (open)
          break;
        if (!edge.owned)
          continue;
        const BoundaryNode &middle = state.tables.boundary_nodes[edge.boundary_nodes[2]];
        if (middle.on_axis || middle.on_symmetry)
          continue;
        if (!middle.free_surface)
          {
            open = true;
            continue;
          }
        std::array<Point, 3> x;
        for (unsigned int a = 0; a < 3; ++a)
          x[a] = state.node_position(edge.nodes[a]);
        const Vector2                chord   = x[1] - x[0];
        const std::array<Vector2, 3> tangent = {
          { 4 * (x[2] - x[0]) - chord, 4 * (x[1] - x[2]) - chord, chord }
        };
        const double weight[3] = { 1. / 6, 1. / 6, 4. / 6 };
        // The workpiece is on the left of the table's edges on two of the four sides.
        const double sign = edge.side == 0 || edge.side == 3 ? -1 : 1;
        for (unsigned int a = 0; a < 3 && !open; ++a)
          {
            const double length = tangent[a].norm();
            if (state.contacts[edge.boundary_nodes[a]].active() || !(length > 0))
              continue;
            const Vector2 outward = sign / length * Vector2({ tangent[a][1], -tangent[a][0] });
            const Hit     hit     = trace(scene, shift, x[a], outward, reach);
            if (hit.tool == no_tool)
              {
                open = true;
                continue;
              }
            const double area = weight[a] * length * 2 * M_PI * x[a][0];
            double       rate = 0;
            for (unsigned int c = 0; c < 2; ++c)
              rate += (state.velocity.local_element(2 * edge.nodes[a] + c) - speed[hit.tool][c]) *
                      outward[c];
            pockets.volume += area * hit.distance;
            pockets.closing_rate += area * rate;
          }
      }
    pockets.closed       = !MPI::logical_or(open, state.communicator);
    pockets.volume       = MPI::sum(pockets.volume, state.communicator);
    pockets.closing_rate = MPI::sum(pockets.closing_rate, state.communicator);
    return pockets;
  }
} // namespace axiforge
