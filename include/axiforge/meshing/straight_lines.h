// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <set>
#include <utility>

#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  /// Over the size of the mesh: what a node is off the axis or its symmetry line by the rounding of
  /// numbers alone; what a drawing may be off (it is put right then, and told); and the radius
  /// below which a bore can only be a badly drawn axis.
  constexpr double line_rounding = 1e-9, line_tolerance = 2e-6, smallest_bore = 1e-4;

  /// Puts nodes that belong on the axis there exactly, within line_tolerance.
  void put_on_axis(WorkpieceMesh &mesh);

  /**
   * Gives the nodes of a symmetry line along r one z, and of one along z one r, within
   * line_tolerance: their mean, or 0 if that is as near.
   * @param edges of all symmetry lines, vertices with the smaller one first
   */
  void put_on_symmetry(const std::set<std::pair<unsigned int, unsigned int>> &edges,
                       WorkpieceMesh                                         &mesh);
} // namespace axiforge::meshing
