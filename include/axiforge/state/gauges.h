// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge
{
  /**
   * What the gauges read on the workpiece as it stands [mm], exact on the parabolas of the Q2
   * outline; nan where there is no point to measure. Does nothing without gauges. Collective.
   */
  std::vector<double> read_gauges(const scene::Scene &scene, const State &state);
} // namespace axiforge
