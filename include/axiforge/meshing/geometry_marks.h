// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /**
   * Flags the cells that are to be divided because of where they are, whatever the flow says:
   * those whose edge is off the tool's profile between its nodes, or long against the tool's radius
   * of curvature, and those in the regions of the scene. Takes back the coarsening that would
   * bring such a cell about. Within the limits of `subsection Refinement`.
   */
  void mark_by_geometry(const scene::Scene &scene, State &state);

  /// Of a locally owned cell [mm]: what "Refinement/Smallest size" is about.
  double shorter_diagonal(const State &state, unsigned int row);
} // namespace axiforge::meshing
