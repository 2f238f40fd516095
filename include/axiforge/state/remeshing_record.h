// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace axiforge
{
  /// What the remeshings of a run have cost so far, and what the next one is decided on.
  struct RemeshingRecord
  {
    unsigned int count       = 0;
    double       volume_jump = 0; ///< sum of the jumps before the volume was restored [mm^3]
    double       strain_jump = 0; ///< sum of the jumps of int strain dV [mm^3]
    /// What new meshes and refinements have cut off and not given back yet [mm^3].
    double missing_volume = 0;

    unsigned int wanted_cells = 0; ///< cells at the start; 0 before the first remeshing
    unsigned int last_attempt = 0; ///< step after which a new mesh was made or tried
    /// Of the mesh right after the last remeshing: the limits are relaxed to these.
    double jacobian = 1, vertex_jacobian = 1, penetration = 0, division = 0.5;
  };
} // namespace axiforge
