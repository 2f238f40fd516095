// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /**
   * Moves the free surface along its normals until the workpiece has this volume [mm^3]: material
   * that a change of the mesh has cut off (new nodes are put on a tool, which an old edge passed
   * through) is given back at once. Nodes on tools, on the axis and on named parts of the boundary
   * stay where they are or on their line, those near a tool move less. No node moves by more than a
   * tenth of its edges: what cannot be given back then, or has no free surface to go to, is left.
   * Collective.
   * @return what is still missing [mm^3], negative if there is too much
   */
  double give_volume_back(const scene::Scene &scene, State &state, double volume);
} // namespace axiforge::meshing
