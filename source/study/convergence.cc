// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <axiforge/study/convergence.h>

namespace axiforge::study
{
  namespace
  {
    /// Below this a limit would lie many times the last difference away: the sequence tells none.
    constexpr double least_order = 0.1;
  } // namespace


  Richardson
  extrapolate(const double coarse, const double middle, const double fine, const double ratio)
  {
    Richardson   result;
    const double first = middle - coarse, second = fine - middle;
    if (!std::isfinite(first) || !std::isfinite(second))
      result.remark = "a value is missing";
    else if (std::abs(second) <=
             1e-14 * std::max({ std::abs(coarse), std::abs(middle), std::abs(fine) }))
      result.remark = "no change beyond rounding";
    else if (first * second <= 0)
      result.remark = "not monotone";
    else if (std::abs(first / second) <= std::pow(ratio, least_order))
      result.remark = "the differences do not fall";
    else
      {
        const double gain = first / second; // ratio^p
        result.order      = std::log(gain) / std::log(ratio);
        result.limit      = fine + second / (gain - 1);
        result.error      = std::abs(second) / (gain - 1);
      }
    return result;
  }


  Richardson extrapolate_distances(const double coarse, const double middle, const double ratio)
  {
    Richardson result;
    if (!std::isfinite(coarse) || !std::isfinite(middle))
      result.remark = "a value is missing";
    else if (!(middle > 0))
      result.remark = "no change beyond rounding";
    else if (coarse / middle - 1 <= std::pow(ratio, least_order))
      result.remark = "the differences do not fall";
    else
      {
        const double gain = coarse / middle - 1;
        result.order      = std::log(gain) / std::log(ratio);
        result.error      = middle / (gain - 1);
      }
    return result;
  }


  double order_of_errors(const double coarse, const double fine, const double ratio)
  {
    const double order = std::log(std::abs(coarse / fine)) / std::log(ratio);
    return std::isfinite(order) ? order : std::numeric_limits<double>::quiet_NaN();
  }
} // namespace axiforge::study
