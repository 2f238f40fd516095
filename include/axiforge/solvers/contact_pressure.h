// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <axiforge/state/state.h>

namespace axiforge::solvers
{
  /**
   * Sets the pressure of the nodes for output, as a field over the edges: its integral over the
   * surface, projected on to the tool and with Simpson's rule, is the reaction of the nodes.
   *
   * A node at the end of a contact also bears what the material past it presses, up to where the
   * contact really ends; over the touching edges alone its reaction would give a peak that is not
   * there. So a node has the area that all its edges turn towards the tool, those with free nodes,
   * too. Where the surface turns away at once, as at an edge of the workpiece, the last touching
   * edge gets the straight line through the pressure of its inner node that bears the same. Nodes
   * on the axis, whose area is zero, take their neighbour's. Collective.
   * @param position nodes where the reactions hold [mm]
   */
  void recover_contact_pressures(const State              &state,
                                 const Field              &position,
                                 std::vector<NodeContact> &contacts);
} // namespace axiforge::solvers
