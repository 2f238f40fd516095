// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/base/errors.h>
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

  /// @throws InputError if "Placement/Rest on" names no tool of the scene
  void check_placement(const scene::SceneParameters &parameters);

  /// The way of a tool in a run: so far along the direction and back from where it starts [mm].
  struct Travel
  {
    Vector2 direction; ///< zero if it rests
    double  forward = 0, backward = 0;
  };
  Travel travel_of(const tools::Motion &motion, double end_time);

  /// Time [s] at which a tool on its way meets the workpiece as it stands; infinity: never.
  double time_of_contact(const scene::Scene            &scene,
                         unsigned int                   tool,
                         const scene::WorkpieceOutline &outline);

  /// What to say where none does.
  InputError no_tool_reaches(const scene::Scene &scene);

  /**
   * Time [s] at which the first moving tool meets a workpiece that lies loosely: until then nothing
   * happens to it, and nothing would hold it. 0 if a symmetry line or a boundary with a condition
   * has something to say from the start, or if a tool presses on it from the start.
   * @throws InputError if no tool reaches it before the end
   */
  double time_of_first_contact(const scene::Scene            &scene,
                               const scene::WorkpieceOutline &outline,
                               const State                   &state);
} // namespace axiforge::process
