// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge
{
  /// Volume of the workpiece within a radius [mm^3]: exact for the Q2 outline where that does not
  /// cross the radius. Collective.
  double volume_within(const State &state, double radius);

  /**
   * Volume [mm^3] between the tools at r < radius and a time [s]: at each r from the highest of the
   * surfaces that look up to the lowest of those that look down; a symmetry line that lies flat
   * counts as either. Where one of the two is missing nothing counts. Tools without undercuts. By
   * the midpoint rule in r. Collective.
   */
  double cavity_within(const scene::Scene &scene, const State &state, double radius, double time);

  /// Radii between which the cavity has no floor or no ceiling: a bore, or a profile that ends.
  struct Opening
  {
    double from = 0, to = 0; ///< [mm]
    bool   any() const
    {
      return to > from;
    }
  };

  /// Where the cavity within a radius is open. Collective.
  Opening opening_within(const scene::Scene &scene, const State &state, double radius, double time);

  /// The share of the cavity that is filled, doc/theory.md (30): volume_within() over
  /// cavity_within(); 0 without a cavity. Collective.
  double fill_fraction(const scene::Scene &scene, const State &state, double radius, double time);
} // namespace axiforge
