// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::process
{
  /**
   * Puts the workpiece where the next operation wants it, by its section Placement: turned over,
   * moved along z, set down on a tool. Contacts, velocities and time begin anew; shape, mesh and
   * strain stay. Collective.
   * @throws InputError if there is no such tool, or the workpiece would fall past it
   */
  void place_workpiece(const scene::SceneParameters &parameters, State &state);
} // namespace axiforge::process
