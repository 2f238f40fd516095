// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <utility>

#include <axiforge/state/state.h>

namespace axiforge
{
  /// Sizes of the workpiece as it stands.
  struct Measures
  {
    double volume;            ///< [mm^3], exact for the Q2 geometry
    double largest_radius;    ///< [mm], on the Q2 edges of the surface, not only at nodes
    double lowest, highest;   ///< z [mm]
    double smallest_jacobian; ///< det J at the Gauss points over its mean in the cell
    double
          smallest_vertex_jacobian; ///< the same at the vertices: negative where an edge folds over
    Point worst_place;              ///< centre of the cell that has it [mm]
  };

  /// Collective.
  /// @param places positions that worst_place is named by, if not the present ones [mm]
  Measures measure(const State &state, const Field *places = nullptr);

  /// Lowest and highest z alone [mm]. Collective.
  std::pair<double, double> vertical_extent(const State &state);

  /// Volume that each Gauss point of a locally owned cell stands for, in the present geometry
  /// [mm^3].
  std::array<double, 9> volumes_of_points(const State &state, unsigned int cell);

  /// Integral over the body of revolution of a quantity given at the Gauss points of a locally
  /// owned
  /// cell, in the present geometry.
  double integral(const State                                     &state,
                  unsigned int                                     cell,
                  const std::function<double(unsigned int point)> &quantity);

  /// Largest effective strain at the Gauss points. Collective.
  double largest_strain(const State &state);
} // namespace axiforge
