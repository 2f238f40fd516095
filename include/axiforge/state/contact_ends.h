// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <vector>

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge
{
  /// Where the contact with a tool ends on the outline: between two nodes of one edge.
  struct ContactEnd
  {
    unsigned int tool;
    unsigned int edge;      ///< row in MeshTables::edges
    unsigned int last;      ///< row in the edge's nodes: the last that touches
    unsigned int next;      ///< the same: the first that does not
    double       share = 0; ///< of the way from the one to the other
  };

  /**
   * The ends of all contacts on locally owned edges. Past the end x0 of a contact with a smooth
   * tool the surface leaves it tangentially, with a gap that grows as (x - x0)^2: the gaps g1 and
   * g2 of the first two free nodes, at d1 and d2 along the outline, say that x0 = (q d1 - d2)/(q -
   * 1), q^2 = g2/g1. Where it leaves at an angle, as at an edge of the workpiece, the last node is
   * the end, and the formula gives that, too.
   * @param contacts of the boundary nodes
   * @param time at which the tools stand where @p place has the nodes
   * @param place of a node [mm]
   */
  std::vector<ContactEnd> contact_ends(const scene::Scene                            &scene,
                                       const State                                   &state,
                                       const std::vector<NodeContact>                &contacts,
                                       double                                         time,
                                       const std::function<Point(unsigned int node)> &place);
} // namespace axiforge
