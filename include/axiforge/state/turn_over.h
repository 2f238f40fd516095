// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>

#include <axiforge/state/state.h>

namespace axiforge
{
  /**
   * What lies between two operations: the workpiece is let go of, and may be turned over and put
   * elsewhere. Its shape, mesh and strain stay; velocity, contacts and what friction has kept
   * become zero, time and steps begin anew. Pressure and stress stay as a start for the iterations.
   */
  void let_go(State &state);

  /**
   * Turns the workpiece over: z -> a - z, a so that it stays between the same heights. A mirror
   * image of the cells would have them turn the other way, so their reference coordinates are
   * exchanged; refined meshes keep their levels. To be followed by let_go(). Everything that looks
   * into the mesh has to be made anew. Collective.
   */
  void turn_over(State &state);

  /// Moves the whole workpiece along z [mm].
  void move_axially(State &state, double way);
} // namespace axiforge
