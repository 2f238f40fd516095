// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <axiforge/study/curve.h>

namespace axiforge::study
{
  namespace
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();


    /// Lagrange's polynomial through n points from @p first on.
    double
    polynomial(const Curve &curve, const std::size_t first, const std::size_t n, const double x)
    {
      double sum = 0;
      for (std::size_t i = first; i < first + n; ++i)
        {
          double weight = 1;
          for (std::size_t j = first; j < first + n; ++j)
            if (j != i)
              weight *= (x - curve.place[j]) / (curve.place[i] - curve.place[j]);
          sum += weight * curve.value[i];
        }
      return sum;
    }
  } // namespace


  int History::find(const std::string &column) const
  {
    const auto found = std::find(columns.begin(), columns.end(), column);
    return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
  }


  bool holds_at_middle(const std::string &column)
  {
    for (const char *start : { "force_", "radial_force_", "power_", "pressure_" })
      if (column.rfind(start, 0) == 0)
        return true;
    return column == "largest_strain_rate_per_s";
  }


  Curve curve_of(const History &history, const std::string &column, const bool against_time)
  {
    const bool middle   = holds_at_middle(column);
    const int  x_column = history.find(against_time ? (middle ? "time_middle_s" : "time_s")
                                                    : (middle ? "stroke_middle_mm" : "stroke_mm"));
    const int  y_column = history.find(column);

    Curve curve;
    for (const std::vector<double> &row : history.rows)
      {
        const double place = row[x_column];
        if (!curve.place.empty() && place <= curve.place.back())
          {
            if (place == curve.place.back())
              curve.value.back() = row[y_column];
            continue;
          }
        curve.place.push_back(place);
        curve.value.push_back(row[y_column]);
      }
    return curve;
  }


  double interpolate(const Curve &curve, const double x)
  {
    const std::vector<double> &place = curve.place;
    const std::size_t          n     = place.size();
    if (n == 0)
      return nan;
    if (n == 1)
      return std::abs(x - place[0]) <= std::abs(place[0]) * (1 + 1e-9) ? curve.value[0] : nan;

    const double slack = 0.5 * (1 + 1e-9);
    if (x < place.front() - slack * (place[1] - place[0]) ||
        x > place.back() + slack * (place[n - 1] - place[n - 2]))
      return nan;
    if (x < place.front() || x > place.back())
      {
        const std::size_t count = std::min<std::size_t>(3, n);
        return polynomial(curve, x < place.front() ? 0 : n - count, count, x);
      }
    const auto above = std::lower_bound(place.begin(), place.end(), x);
    if (*above == x)
      return curve.value[above - place.begin()];
    const std::size_t count = std::min<std::size_t>(4, n);
    const std::size_t right = above - place.begin(); // x is between right - 1 and right
    const std::size_t first = std::min(right >= 2 ? right - 2 : 0, n - count);
    return polynomial(curve, first, count, x);
  }


  double rms_difference(const Curve &a, const Curve &b)
  {
    if (a.place.empty() || b.place.empty())
      return nan;
    const double low  = std::max(a.place.front(), b.place.front());
    const double high = std::min(a.place.back(), b.place.back());
    if (high < low)
      return nan;
    constexpr unsigned int n   = 400;
    double                 sum = 0;
    for (unsigned int i = 0; i < n; ++i)
      {
        const double x = low + (high - low) * i / (n - 1);
        sum += std::pow(interpolate(a, x) - interpolate(b, x), 2);
      }
    return std::sqrt(sum / n);
  }
} // namespace axiforge::study
