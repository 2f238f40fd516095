// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace axiforge::study
{
  /// The history of a run: a row of numbers per accepted step, as in history.csv.
  struct History
  {
    std::vector<std::string>         columns;
    std::vector<std::vector<double>> rows;

    /// Index of a column, or -1.
    int find(const std::string &column) const;
  };

  /// A quantity against the stroke [mm] (or the time [s], where no tool drives); places ascend.
  struct Curve
  {
    std::vector<double> place, value;
  };

  /// Whether the column holds at the middle of a step (forces, powers, pressures, rates) and not at
  /// its end.
  bool holds_at_middle(const std::string &column);

  /**
   * A column as a curve, each value where it holds. While the stroke rests, only the last value at
   * a place is kept. @p against_time: for scenes without a stroke.
   */
  Curve curve_of(const History &history, const std::string &column, bool against_time);

  /**
   * Value at a place: the polynomial through the four nearest points, fewer if there are no four;
   * exact for cubics. Beyond an end a curve is continued through its three last points, by half
   * their distance (half a step) at most; farther out the result is `nan`.
   */
  double interpolate(const Curve &curve, double place);

  /**
   * Root mean square of the difference of two curves over the places that both have, 400 of them at
   * equal distances; `nan` if there are none.
   */
  double rms_difference(const Curve &a, const Curve &b);
} // namespace axiforge::study
