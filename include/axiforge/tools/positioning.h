// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <vector>

#include <axiforge/tools/profile.h>

namespace axiforge::tools
{
  /**
   * Tolerances of placing tools and workpiece, over the workpiece's size: a body that is brought to
   * another one stops `touching_tolerance` short of it; along a wall that it touches and that bends
   * into its way (a fillet in a die of its own radius) it sinks in by `sunk_tolerance`, since gaps
   * grow there with the square of the way; and what overlaps by more than `overlap_tolerance` is
   * refused. Each has to be well below the next.
   */
  constexpr double touching_tolerance = 1e-9;
  constexpr double sunk_tolerance     = 1e-7;
  constexpr double overlap_tolerance  = 1e-6;

  /**
   * How far [mm] an oriented profile, clear of all points, can travel along a unit direction until
   * it touches the first of them: to within @p tolerance [mm] short of it, and beyond only where a
   * wall along the way bends into it, see sunk_tolerance. Surfaces that touch and move away or
   * along themselves do not count.
   * @return infinity if it passes all of them
   *
   * Conservative advancement (B. Mirtich, 1996): the smallest gap is a way that is safe whatever
   * the shapes, and is gone again and again. With a flat tool the first step is exact.
   */
  double travel_to_contact(const Profile            &profile,
                           const std::vector<Point> &points,
                           const Vector2            &direction,
                           double                    tolerance);

  /**
   * Moves a profile back against a unit direction until it is wholly behind all points, chooses its
   * side from there and lets it come forward until it touches, see travel_to_contact().
   * @return the displacement from where the profile was drawn [mm]
   * @throws InputError if it touches none of the points, with @p name
   */
  Vector2 bring_to_contact(Profile                  &profile,
                           const std::vector<Point> &points,
                           const Vector2            &direction,
                           double                    tolerance,
                           const std::string        &name);

  /// A place where a chain of the profile crosses itself [mm]; nothing if none does.
  std::optional<Point> self_crossing(const Profile &profile);
} // namespace axiforge::tools
