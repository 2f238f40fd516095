// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace axiforge::study
{
  /// A line with markers, or a dashed level.
  struct Series
  {
    std::string                            label;
    std::vector<std::pair<double, double>> points; ///< those that aren't finite are left out
    bool                                   dashed = false; ///< no markers
  };

  /// One diagram.
  struct Panel
  {
    std::string         title, x_label, y_label;
    bool                log_x = false, log_y = false; ///< points that are not positive are left out
    std::vector<Series> series;
  };

  /// Ticks of an axis from low to high: multiples of 1, 2 or 5 times a power of ten, at least two.
  std::vector<double> linear_ticks(double low, double high);

  /// Ticks of a logarithmic axis: powers of ten; with 2 and 5 times them if there are less than
  /// three of them.
  std::vector<double> log_ticks(double low, double high);

  /// The diagrams, two in a row, as an SVG document of its own.
  std::string svg(const std::string &title, const std::vector<Panel> &panels);
} // namespace axiforge::study
