// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::scene
{
  /// `subsection Gauge NAME`: a measurement of the workpiece's shape.
  struct GaugeParameters
  {
    std::string name;
    std::string measure = "inner radius", at;

    void declare(dealii::ParameterHandler &prm);
  };

  /**
   * What a gauge measures: the smallest or largest radius or height among the points of the
   * outline that it looks at.
   */
  struct Gauge
  {
    enum class Place
    {
      surface, ///< all of it, axis and symmetry line left out
      line,    ///< where the line of constant height (of a radius) or radius (of a height) cuts
      middle,  ///< the same, half way between the ends of the workpiece
      contact  ///< with one tool
    };

    std::string  name;
    unsigned int component; ///< 0: a radius, 1: a height
    bool         largest;   ///< of the points, otherwise the smallest
    Place        place;
    double       line = 0; ///< [mm]
    unsigned int tool = 0; ///< of a contact
  };

  /**
   * @param tools names, in the order of the scene
   * @throws InputError for a place that is none of those allowed
   */
  Gauge make_gauge(const GaugeParameters &parameters, const std::vector<std::string> &tools);
} // namespace axiforge::scene
