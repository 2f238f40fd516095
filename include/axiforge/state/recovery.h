// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <functional>

#include <axiforge/state/state.h>

namespace axiforge
{
  /**
   * Two quantities of the Gauss points as continuous nodal fields, in the two components of a
   * Field: continued within each cell, kept in the range of the cell, averaged where cells meet
   * (Zienkiewicz and Zhu's recovery by averaging). Ghosts are up to date. Collective.
   * @param value of Gauss point q of a locally owned cell
   */
  Field
  recover(const State                                                                   &state,
          const std::function<std::array<double, 2>(unsigned int cell, unsigned int q)> &value);
} // namespace axiforge
