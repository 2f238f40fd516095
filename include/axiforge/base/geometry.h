// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

namespace axiforge
{
  /// A point (r, z) [mm] of the meridian half plane.
  using Point = dealii::Point<2>;

  /// A vector (r, z): displacement [mm], velocity [mm/s] or a direction.
  using Vector2 = dealii::Tensor<1, 2>;

  /// a x b, out of the plane.
  inline double cross(const Vector2 &a, const Vector2 &b)
  {
    return a[0] * b[1] - a[1] * b[0];
  }
} // namespace axiforge
