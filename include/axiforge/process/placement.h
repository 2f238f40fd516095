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

  /**
   * Time [s] at which the first moving tool meets a workpiece that lies loosely: until then nothing
   * happens to it, and nothing would hold it. 0 if a symmetry line or a velocity boundary holds it
   * anyway, or if a tool touches it from the start.
   * @throws InputError if no tool reaches it before the end
   */
  double time_of_first_contact(const scene::Scene            &scene,
                               const scene::WorkpieceOutline &outline,
                               const State                   &state);
} // namespace axiforge::process
