// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/state/state.h>

namespace axiforge::solvers
{
  /// A Gauss point of a boundary edge.
  struct EdgePoint
  {
    std::array<double, 3> shape; ///< of the nodes end, end, middle
    Point                 x;     ///< [mm]
    Vector2               area;  ///< 2 pi r ds, outward [mm^2]

    /// A nodal field here.
    Vector2 value(const Field &field, const BoundaryEdge &edge) const
    {
      Vector2 sum;
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int c = 0; c < 2; ++c)
          sum[c] += shape[a] * field.local_element(2 * edge.nodes[a] + c);
      return sum;
    }
  };

  /// The three Gauss points of an edge of the Q2 outline: exact for a pressure that is linear along
  /// a straight edge, times r and a shape function.
  inline std::array<EdgePoint, 3> edge_points(const Field &position, const BoundaryEdge &edge)
  {
    constexpr double         weight[3] = { 5. / 9, 8. / 9, 5. / 9 };
    std::array<EdgePoint, 3> points;
    for (unsigned int q = 0; q < 3; ++q)
      {
        const double s     = (static_cast<int>(q) - 1) * std::sqrt(0.6);
        const double dN[3] = { s - 0.5, s + 0.5, -2 * s };
        EdgePoint   &point = points[q];
        point.shape        = { { 0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s } };
        Vector2 along;
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            along[c] += dN[a] * position.local_element(2 * edge.nodes[a] + c);
        point.x = Point(point.value(position, edge));
        // To the right of the sides right (+z) and bottom (+r) is outside.
        const double sign = edge.side == 1 || edge.side == 2 ? 1 : -1;
        point.area = sign * weight[q] * 2 * M_PI * point.x[0] * Vector2({ along[1], -along[0] });
      }
    return points;
  }
} // namespace axiforge::solvers
