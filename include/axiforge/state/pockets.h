// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge
{
  /// What is left free in a die that closes: doc/theory.md (30a).
  struct Pockets
  {
    bool   closed       = false; ///< every free place of the surface faces a tool near by
    double volume       = 0;     ///< between surface and tools [mm^3]
    double closing_rate = 0;     ///< of that volume at the present velocity [mm^3/s]

    /// Time after which they are filled, if it goes on like that [s]; infinite where they are open
    /// or do not close.
    double time_to_fill() const;
  };

  /**
   * Looks from places on the free edges along the outward normal for the tool it will meet. Surface
   * that meets none within a quarter of the workpiece's size is open: the side of a cylinder that
   * is upset, the tip of a flash. Named parts of the boundary count as open. Collective.
   */
  Pockets find_pockets(const scene::Scene &scene, const State &state);

  /// Whether an edge from one tool to another spans the mouth of a gap that is open behind: the
  /// mesh does not see the flash that is to come. Collective.
  bool edge_over_gap(const scene::Scene &scene, const State &state);
} // namespace axiforge
