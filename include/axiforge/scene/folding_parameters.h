// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::scene
{
  /// `subsection Folding`: what to do where free surface meets free surface.
  struct FoldingParameters
  {
    std::string when_found   = "stop";
    double      smallest_gap = 0.05;

    void declare(dealii::ParameterHandler &prm);
  };
} // namespace axiforge::scene
