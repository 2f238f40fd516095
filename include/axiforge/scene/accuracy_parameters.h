// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/base/geometry.h>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::scene
{
  /// `subsection Accuracy`, as read.
  struct AccuracyParameters
  {
    std::string  target          = "none";
    bool         estimate_errors = false;
    unsigned int check_every     = 10;

    void declare(dealii::ParameterHandler &prm);
  };

  /// `subsection Accuracy`, checked: what the error of the tool force is estimated and driven for.
  struct Accuracy
  {
    Accuracy() = default;

    /// @throws InputError if the target is no share of the force
    explicit Accuracy(const AccuracyParameters &parameters);

    double       target      = 0;     ///< relative error of the force; 0: nothing is driven
    bool         estimated   = false; ///< whether errors are estimated at all
    unsigned int check_every = 10;

    /// Shares of the target that mesh and step are driven to; the rest is for regularisation and
    /// solver.
    static constexpr double space_share = 0.5, time_share = 0.3;

    bool driven() const
    {
      return target > 0;
    }
  };

  /// `subsection Region NAME`: a box in the meridian plane with finer cells.
  struct RegionParameters
  {
    std::string  name;
    Vector2      lower, upper; ///< corners (r, z) [mm] at the start
    std::string  moves_with;   ///< name of a tool; empty: fixed in space
    double       element_size = 0;
    unsigned int level        = 0;

    void declare(dealii::ParameterHandler &prm);
  };

  /// A region, checked.
  struct Region
  {
    std::string  name;
    Point        lower, upper; ///< [mm] at the start
    unsigned int tool;         ///< that it moves with; no_tool (scene.cc): fixed in space
    double       element_size; ///< largest [mm]; 0: not given
    unsigned int level;        ///< smallest; 0: not given
  };
} // namespace axiforge::scene
