// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <axiforge/study/plot.h>

namespace axiforge::study
{
  namespace
  {
    // Lengths in pixels.
    constexpr double panel_width = 560, panel_height = 400, title_height = 40;
    constexpr double left = 92, right = 20, top = 36, bottom = 56;

    // Distinct for readers who do not see red and green apart (Okabe, Ito 2008).
    constexpr const char *colours[] = { "#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                        "#e69f00", "#56b4e9", "#000000" };


    std::string escaped(const std::string &text)
    {
      std::string result;
      for (const char c : text)
        switch (c)
          {
          case '&':
            result += "&amp;";
            break;
          case '<':
            result += "&lt;";
            break;
          case '>':
            result += "&gt;";
            break;
          default:
            result += c;
          }
      return result;
    }


    std::string text_at(const double       x,
                        const double       y,
                        const std::string &text,
                        const std::string &anchor = "middle",
                        const std::string &more   = "")
    {
      return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                         anchor, more, escaped(text));
    }


    /// Numbers and their places along an axis.
    class Axis
    {
    public:
      Axis(const std::vector<double> &values,
           const bool                 logarithmic,
           const double               begin,
           const double               end)
          : logarithmic(logarithmic)
          , begin(begin)
          , end(end)
      {
        low = high = logarithmic ? 1 : 0;
        if (!values.empty())
          {
            low  = *std::min_element(values.begin(), values.end());
            high = *std::max_element(values.begin(), values.end());
          }
        const double room = 0.06 * (scale(high) - scale(low));
        if (room > 0)
          {
            low  = logarithmic ? low / std::pow(10, room) : low - room;
            high = logarithmic ? high * std::pow(10, room) : high + room;
          }
        else if (logarithmic) // a single value
          {
            low /= 2;
            high *= 2;
          }
        else
          {
            const double half = high != 0 ? 1e-3 * std::abs(high) : 1;
            low -= half;
            high += half;
          }
      }

      double at(const double value) const
      {
        return begin + (end - begin) * (scale(value) - scale(low)) / (scale(high) - scale(low));
      }

      std::vector<double> ticks() const
      {
        return logarithmic ? log_ticks(low, high) : linear_ticks(low, high);
      }

      /// As many digits as it takes to tell one tick from the next.
      std::string label(const double tick) const
      {
        if (logarithmic)
          return fmt::format("{:.6g}", tick);
        const double range  = high - low;
        const double larger = std::max(std::abs(low), std::abs(high));
        const int    digits = 2 + static_cast<int>(std::ceil(std::log10(larger / range)));
        return fmt::format("{:.{}g}", std::abs(tick) < 1e-9 * range ? 0. : tick,
                           std::clamp(digits, 6, 12));
      }

    private:
      double scale(const double value) const
      {
        return logarithmic ? std::log10(value) : value;
      }

      bool   logarithmic;
      double begin, end, low, high;
    };


    bool can_be_drawn(const Panel &panel, const std::pair<double, double> &point)
    {
      return std::isfinite(point.first) && std::isfinite(point.second) &&
             (!panel.log_x || point.first > 0) && (!panel.log_y || point.second > 0);
    }


    std::string draw_axes(const Panel &panel, const Axis &x, const Axis &y)
    {
      const double x0 = left, x1 = panel_width - right, y0 = panel_height - bottom, y1 = top;
      std::string  out;
      for (const double tick : x.ticks())
        {
          const double place = x.at(tick);
          out += fmt::format("<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" "
                             "class=\"grid\"/>\n",
                             place, y0, y1);
          out += text_at(place, y0 + 18, x.label(tick));
        }
      for (const double tick : y.ticks())
        {
          const double place = y.at(tick);
          out += fmt::format("<line x1=\"{1:.1f}\" y1=\"{0:.1f}\" x2=\"{2:.1f}\" y2=\"{0:.1f}\" "
                             "class=\"grid\"/>\n",
                             place, x0, x1);
          out += text_at(x0 - 8, place + 4, y.label(tick), "end");
        }
      out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
                         "class=\"frame\"/>\n",
                         x0, y1, x1 - x0, y0 - y1);
      out += text_at(0.5 * (x0 + x1), top - 14, panel.title, "middle", " font-weight=\"bold\"");
      out += text_at(0.5 * (x0 + x1), panel_height - 14, panel.x_label);
      out += text_at(16, 0.5 * (y0 + y1), panel.y_label, "middle",
                     fmt::format(" transform=\"rotate(-90 16 {:.1f})\"", 0.5 * (y0 + y1)));
      return out;
    }


    std::string draw_series(const Panel       &panel,
                            const Axis        &x,
                            const Axis        &y,
                            const Series      &series,
                            const std::string &colour)
    {
      std::string line, markers;
      for (const auto &point : series.points)
        if (can_be_drawn(panel, point))
          {
            const double px = x.at(point.first), py = y.at(point.second);
            line += fmt::format("{}{:.1f},{:.1f}", line.empty() ? "" : " ", px, py);
            if (!series.dashed)
              markers += fmt::format(
                  "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n", px, py, colour);
          }
      if (line.empty())
        return "";
      return fmt::format("<polyline points=\"{}\" stroke=\"{}\"{} class=\"line\"/>\n", line, colour,
                         series.dashed ? " stroke-dasharray=\"6 4\"" : "") +
             markers;
    }


    /// How much of the lines runs through a box.
    unsigned int covered(const Panel &panel,
                         const Axis  &x,
                         const Axis  &y,
                         const double x0,
                         const double y0,
                         const double width,
                         const double height)
    {
      unsigned int count = 0;
      for (const Series &series : panel.series)
        for (std::size_t i = 0; i < series.points.size(); ++i)
          {
            const auto &a = series.points[i == 0 ? 0 : i - 1], &b = series.points[i];
            if (!can_be_drawn(panel, a) || !can_be_drawn(panel, b))
              continue;
            for (double part = 0; part <= 1; part += 0.05)
              {
                const double px = (1 - part) * x.at(a.first) + part * x.at(b.first);
                const double py = (1 - part) * y.at(a.second) + part * y.at(b.second);
                count += px > x0 - 5 && px < x0 + width + 5 && py > y0 - 5 && py < y0 + height + 5;
              }
          }
      return count;
    }


    /// The legend stands in the corner where it covers least.
    std::string draw_legend(const Panel &panel, const Axis &x, const Axis &y)
    {
      std::size_t longest = 0;
      for (const Series &series : panel.series)
        longest = std::max(longest, series.label.size());
      const double height = 18. * panel.series.size() + 8, width = 46 + 7.1 * longest;
      double       x0 = 0, y0 = 0;
      unsigned int least = std::numeric_limits<unsigned int>::max();
      for (const double corner_x : { panel_width - right - 8 - width, left + 8 })
        for (const double corner_y : { top + 8, panel_height - bottom - 8 - height })
          {
            const unsigned int count = covered(panel, x, y, corner_x, corner_y, width, height);
            if (count < least)
              {
                least = count;
                x0    = corner_x;
                y0    = corner_y;
              }
          }
      std::string out = fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
                                    "height=\"{:.1f}\" class=\"legend\"/>\n",
                                    x0, y0, width, height);
      for (unsigned int i = 0; i < panel.series.size(); ++i)
        {
          const double row = y0 + 13 + 18. * i;
          out += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" "
                             "stroke=\"{}\" stroke-width=\"2\"{}/>\n",
                             x0 + 8, row, x0 + 32, row, colours[i % std::size(colours)],
                             panel.series[i].dashed ? " stroke-dasharray=\"6 4\"" : "");
          out += text_at(x0 + 38, row + 4, panel.series[i].label, "start");
        }
      return out;
    }


    std::string draw(const Panel &panel)
    {
      std::vector<double> xs, ys;
      for (const Series &series : panel.series)
        for (const auto &point : series.points)
          if (can_be_drawn(panel, point))
            {
              xs.push_back(point.first);
              ys.push_back(point.second);
            }
      const Axis  x(xs, panel.log_x, left, panel_width - right);
      const Axis  y(ys, panel.log_y, panel_height - bottom, top);
      std::string out = draw_axes(panel, x, y);
      for (unsigned int i = 0; i < panel.series.size(); ++i)
        out += draw_series(panel, x, y, panel.series[i], colours[i % std::size(colours)]);
      return panel.series.empty() ? out : out + draw_legend(panel, x, y);
    }
  } // namespace


  std::vector<double> linear_ticks(const double low, const double high)
  {
    const double raw   = (high - low) / 5;
    const double power = std::pow(10, std::floor(std::log10(raw)));
    double       step  = 10 * power;
    for (const double factor : { 5., 2., 1. })
      if (factor * power >= raw * (1 - 1e-9))
        step = factor * power;
    std::vector<double> ticks;
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
      ticks.push_back(i * step);
    return ticks;
  }


  std::vector<double> log_ticks(const double low, const double high)
  {
    std::vector<double> decades, finer;
    for (int k = static_cast<int>(std::floor(std::log10(low))) - 1;
         k <= static_cast<int>(std::ceil(std::log10(high))); ++k)
      for (const double factor : { 1., 2., 5. })
        {
          const double tick = factor * std::pow(10., k);
          if (tick < low * (1 - 1e-9) || tick > high * (1 + 1e-9))
            continue;
          finer.push_back(tick);
          if (factor == 1)
            decades.push_back(tick);
        }
    if (decades.size() >= 3)
      return decades;
    return finer.size() >= 2 ? finer : linear_ticks(low, high);
  }


  std::string svg(const std::string &title, const std::vector<Panel> &panels)
  {
    const unsigned int columns = std::min<std::size_t>(2, std::max<std::size_t>(1, panels.size()));
    const unsigned int rows    = (panels.size() + columns - 1) / columns;
    const double       width = columns * panel_width, height = title_height + rows * panel_height;
    std::string        out = fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
                      "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"DejaVu Sans, Arial, sans-serif\" "
                      "font-size=\"12\">\n<style>.grid{{stroke:#ddd}} .frame{{fill:none;stroke:#333}} "
                      ".line{{fill:none;stroke-width:2}} "
                      ".legend{{fill:#fff;fill-opacity:0.85;stroke:#bbb}}</style>\n"
                      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
               width, height);
    out += text_at(0.5 * width, 26, title, "middle", " font-size=\"15\" font-weight=\"bold\"");
    for (unsigned int i = 0; i < panels.size(); ++i)
      out += fmt::format("<g transform=\"translate({:.0f} {:.0f})\">\n",
                         (i % columns) * panel_width, title_height + (i / columns) * panel_height) +
             draw(panels[i]) + "</g>\n";
    return out + "</svg>\n";
  }
} // namespace axiforge::study
