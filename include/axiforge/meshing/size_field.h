// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <axiforge/base/geometry.h>

namespace axiforge::meshing
{
  /**
   * The wanted length of edges at any place of the workpiece [mm]: that of the nearest demands,
   *
   *   h(x) = max(h_min, min(h_max, min_i (h_i + g |x - x_i|))),
   *
   * so it grows by no more than g with the way, and neighbouring edges differ little.
   */
  class SizeField
  {
  public:
    SizeField(double largest, double smallest, double growth);

    /// Demand a size at a place. Demands that others have met already are left out.
    void demand(const Point &x, double size);

    double at(const Point &x) const;

    double largest() const
    {
      return h_max;
    }

    /// All sizes times this, the bounds too.
    void scale(double factor);

  private:
    struct Demand
    {
      Point  x;
      double size;
    };

    double              h_max, h_min, growth;
    std::vector<Demand> demands;
  };
} // namespace axiforge::meshing
