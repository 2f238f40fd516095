// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>

#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /// Parts of the free surface that meet, or are about to. doc/theory.md, "Folding".
  struct Fold
  {
    enum class Kind
    {
      surfaces, ///< two parts of the surface meet
      symmetry, ///< the surface meets its mirror image
      axis,     ///< a bore closes
      pocket,   ///< surface between two places that touch the same tool closes on it
      crease,   ///< a notch between two edges closes
      overlap   ///< two parts have passed through each other
    };

    Kind   kind;
    Point  place;     ///< where they meet [mm]
    double opening;   ///< what is left between them now [mm]
    double time_left; ///< until they meet, with the present velocity [s]

    /// As `two parts of the free surface meet near r = 1 mm, z = 2 mm (0.1 mm apart)`.
    std::string describe() const;
  };

  /**
   * Looks for the fold that comes first: within the horizon, which is the length of the next step,
   * with the present velocity; or where surface that closes has come nearer than a share of the
   * length of its edges, and the way along the outline is more than ten times as long.
   *
   * Surface that touches a tool takes no part in it. All ranks look at the whole outline, some
   * hundred edges, and find the same. Collective.
   *
   * @param smallest_gap share of the edges' length
   * @param horizon [s]
   */
  std::optional<Fold> find_fold(const State &state, double horizon, double smallest_gap);
} // namespace axiforge::meshing
