// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::scene
{
  /// `subsection Study`: what `axiforge study` repeats and compares. A run by itself ignores it.
  struct StudyParameters
  {
    std::string entry, values;
    double      refinement_ratio = 0;
    std::string quantities, at = "end";
    bool        single_velocity_solve = false;
    std::string reference;

    void declare(dealii::ParameterHandler &prm);
  };
} // namespace axiforge::scene
