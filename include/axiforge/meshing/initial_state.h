// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>

#include <axiforge/meshing/workpiece_mesh.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /// What the scene has to know of the workpiece.
  scene::WorkpieceOutline outline_of(const WorkpieceMesh &mesh);

  /// The same of a workpiece that has been forged; the points in the order of r and z, whatever the
  /// number of ranks. Collective.
  scene::WorkpieceOutline outline_of(const State &state);

  /**
   * Fills an empty state with the workpiece at the start of the run: mesh, refined so many times,
   * its Q2 geometry, and everything else zero. Collective.
   */
  void make_initial_state(const WorkpieceMesh &mesh, unsigned int refinement_levels, State &state);

  /**
   * Refines the cells whose centre (in the present geometry) the predicate chooses. The position
   * field is carried over exactly; the other fields start at zero, so this is for a state that has
   * not moved.
   */
  void refine_at_start(State &state, const std::function<bool(const Point &)> &choose);
} // namespace axiforge::meshing
