// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <axiforge/study/analysis.h>

namespace axiforge::study
{
  namespace
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();


    bool has_column(const Run &run, const std::string &quantity)
    {
      return !run.history.rows.empty() && run.history.find(quantity) >= 0;
    }


    double value_at_end(const Run &run, const std::string &quantity, const bool against_time)
    {
      if (!run.failure.empty() || !has_column(run, quantity))
        return nan;
      const std::vector<double> &last = run.history.rows.back();
      if (run.history.rows.size() == 1 || !holds_at_middle(quantity))
        return last[run.history.find(quantity)];
      return interpolate(curve_of(run.history, quantity, against_time),
                         last[run.history.find(against_time ? "time_s" : "stroke_mm")]);
    }


    double value_at(const Run &run, const std::string &quantity, const double stroke)
    {
      return has_column(run, quantity) ? interpolate(curve_of(run.history, quantity, false), stroke)
                                       : nan;
    }


    /// Distances of all curves to that of the last run, absolute and over the rms of that.
    void compare_curves(const std::vector<Run> &runs, const bool against_time, Item &item)
    {
      const std::size_t n = runs.size();
      item.value.assign(n, nan);
      item.error.assign(n, nan);
      if (!runs.back().failure.empty() || !has_column(runs.back(), item.quantity))
        return;
      const Curve finest = curve_of(runs.back().history, item.quantity, against_time);
      Curve       zero   = finest;
      std::fill(zero.value.begin(), zero.value.end(), 0.);
      const double size = rms_difference(finest, zero);
      for (std::size_t i = 0; i < n; ++i)
        if (runs[i].failure.empty() && has_column(runs[i], item.quantity))
          {
            item.value[i] =
                rms_difference(curve_of(runs[i].history, item.quantity, against_time), finest);
            item.error[i] = item.value[i] / size;
          }
    }


    void find_orders(const Plan &plan, Item &item)
    {
      const std::size_t n = item.value.size();
      item.difference.assign(n, nan);
      item.error_order.assign(n, nan);
      item.convergence.assign(n, Richardson());
      if (plan.at == Place::whole_curve)
        {
          if (plan.ratio > 0 && n >= 3)
            item.convergence.back() =
                extrapolate_distances(item.value[n - 3], item.value[n - 2], plan.ratio);
          return;
        }
      if (std::isfinite(item.reference))
        for (std::size_t i = 0; i < n; ++i)
          item.error[i] = item.reference != 0 ? item.value[i] / item.reference - 1 : item.value[i];
      for (std::size_t i = 1; i < n; ++i)
        {
          item.difference[i] = item.value[i] - item.value[i - 1];
          if (plan.ratio > 0)
            item.error_order[i] = order_of_errors(item.error[i - 1], item.error[i], plan.ratio);
          if (plan.ratio > 0 && i >= 2)
            item.convergence[i] =
                extrapolate(item.value[i - 2], item.value[i - 1], item.value[i], plan.ratio);
        }
    }
  } // namespace


  std::vector<Item> analyse(const Plan &plan, const std::vector<Run> &runs, const bool against_time)
  {
    std::vector<Item> items;
    for (unsigned int q = 0; q < plan.quantities.size(); ++q)
      {
        Item item;
        item.quantity = item.name = plan.quantities[q];
        item.reference            = q < plan.references.size() ? plan.references[q] : nan;
        item.error.assign(runs.size(), nan);
        if (plan.at == Place::whole_curve)
          {
            item.name += "_rms";
            compare_curves(runs, against_time, item);
            items.push_back(item);
          }
        else if (plan.at == Place::end)
          {
            for (const Run &run : runs)
              item.value.push_back(value_at_end(run, item.quantity, against_time));
            items.push_back(item);
          }
        else
          for (const double stroke : plan.strokes)
            {
              Item here = item;
              here.name += fmt::format("_at_{:g}_mm", stroke);
              for (const Run &run : runs)
                here.value.push_back(value_at(run, here.quantity, stroke));
              items.push_back(here);
            }
      }
    for (Item &item : items)
      find_orders(plan, item);
    return items;
  }
} // namespace axiforge::study
