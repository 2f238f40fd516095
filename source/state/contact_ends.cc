// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <axiforge/base/phases.h>
#include <axiforge/state/contact_ends.h>

namespace axiforge
{
  namespace
  {
    bool touches(const NodeContact &contact, const unsigned int tool)
    {
      return contact.tool[0] == tool || contact.tool[1] == tool;
    }


    /// Boundary edges that end at each boundary node: two at most.
    std::vector<std::array<unsigned int, 2>> edges_of_nodes(const State &state)
    {
      std::vector<std::array<unsigned int, 2>> edges(state.tables.boundary_nodes.size(),
                                                     { { no_tool, no_tool } });
      for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
        for (unsigned int a = 0; a < 2; ++a)
          {
            auto &list                       = edges[state.tables.edges[e].boundary_nodes[a]];
            list[list[0] == no_tool ? 0 : 1] = e;
          }
      return edges;
    }
  } // namespace


  std::vector<ContactEnd> contact_ends(const scene::Scene                            &scene,
                                       const State                                   &state,
                                       const std::vector<NodeContact>                &contacts,
                                       const double                                   time,
                                       const std::function<Point(unsigned int node)> &place)
  {
    std::vector<ContactEnd> ends;
    const MeshTables       &tables = state.tables;
    const auto              edges  = edges_of_nodes(state);
    const auto              gap = [&](const unsigned int tool, const Point &x, const double reach) {
      std::array<tools::Contact, 2> found;
      const Vector2                 shift = scene.tools[tool].motion.displacement(time);
      return scene.tools[tool].profile.find(x - shift, reach, found) > 0 ? found[0].gap : reach;
    };

    for (unsigned int e = 0; e < tables.edges.size(); ++e)
      {
        const BoundaryEdge &edge = tables.edges[e];
        if (!edge.owned || !tables.boundary_nodes[edge.boundary_nodes[2]].free_surface)
          continue;
        for (unsigned int a = 0; a < 2; ++a)
          for (const bool outward : { true, false })
            for (unsigned int slot = 0; slot < 2; ++slot)
              {
                // From the middle to this end, or from this end to the middle.
                const unsigned int last = outward ? 2 : a, next = outward ? a : 2;
                const NodeContact &contact = contacts[edge.boundary_nodes[last]];
                const unsigned int tool    = contact.tool[slot];
                if (tool == no_tool || touches(contacts[edge.boundary_nodes[next]], tool))
                  continue;
                ContactEnd end{ tool, e, last, next };

                // The node after the next: the other end, or the middle of the neighbour.
                unsigned int second = no_tool;
                if (!outward)
                  second = edge.boundary_nodes[1 - a];
                else
                  for (const unsigned int other : edges[edge.boundary_nodes[a]])
                    if (other != no_tool && other != e)
                      second = tables.edges[other].boundary_nodes[2];
                if (second != no_tool && tables.boundary_nodes[second].free_surface &&
                    !touches(contacts[second], tool))
                  {
                    const Point x0 = place(edge.nodes[last]), x1 = place(edge.nodes[next]),
                                x2  = place(tables.boundary_nodes[second].node);
                    const double d1 = x0.distance(x1), d2 = d1 + x1.distance(x2);
                    const double g1 = std::max(gap(tool, x1, d2), 0.), g2 = gap(tool, x2, 2 * d2);
                    // q d1 - d2 over q - 1, times sqrt(g1): no division by a gap of 0
                    const double r1 = std::sqrt(g1), r2 = std::sqrt(std::max(g2, 0.));
                    if (r2 > r1)
                      end.share = std::clamp((r2 * d1 - r1 * d2) / ((r2 - r1) * d1), 0., 1.);
                  }
                ends.push_back(end);
              }
      }
    return ends;
  }
} // namespace axiforge
