// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <limits>
#include <string>

namespace axiforge::study
{
  /// What a sequence f(h) = a + b h^p tells about itself. What can't be told is `nan`.
  struct Richardson
  {
    double order = std::numeric_limits<double>::quiet_NaN(); ///< p
    double limit = std::numeric_limits<double>::quiet_NaN(); ///< a
    double error = std::numeric_limits<double>::quiet_NaN(); ///< |f - a| of the finest value

    std::string remark; ///< why there is no order; empty: there is one
  };

  /**
   * Observed order and limit from three values, each with a mesh or step @p ratio times finer than
   * the one before (L. F. Richardson, Phil. Trans. R. Soc. A 226 (1927) 299-361):
   *
   *     p = log((f1 - f2) / (f2 - f3)) / log(ratio),    a = f3 + (f3 - f2) / (ratio^p - 1).
   *
   * Values that go up and down, or whose differences do not fall (p < 0.1), have no order; neither
   * have values whose last difference is rounding (1e-14 of them).
   */
  Richardson extrapolate(double coarse, double middle, double fine, double ratio);

  /**
   * The same from distances to the finest of three runs, |f1 - f3| and |f2 - f3|: their quotient is
   * ratio^p + 1. There is no limit, but the error of the finest run: |f2 - f3| / (ratio^p - 1).
   */
  Richardson extrapolate_distances(double coarse, double middle, double ratio);

  /// Order from the errors of two values; `nan` if one is zero or they are no numbers.
  double order_of_errors(double coarse, double fine, double ratio);
} // namespace axiforge::study
