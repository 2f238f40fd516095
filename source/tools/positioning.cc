// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/tools/positioning.h>

namespace axiforge::tools
{
  namespace
  {
    Vector2 left_of(const Vector2 &t)
    {
      return Vector2({ -t[1], t[0] });
    }


    /// A surface that moves along itself, or away, does not come closer: it may touch and slide.
    constexpr double sliding = 0.02;

    /// Along such a surface the way goes on in steps of this share of the points' extent at least.
    constexpr double sliding_step = 0.005;


    /// What a place on the way says.
    struct Clearance
    {
      double safe_way = std::numeric_limits<double>::infinity(); ///< that surely meets nothing [mm]
      double deepest  = 0; ///< smallest gap, if it is negative [mm]
    };


    Clearance clearance(const Profile            &profile,
                        const std::vector<Point> &points,
                        const Vector2            &direction,
                        const double              travel,
                        const double              size)
    {
      Clearance              result;
      std::array<Contact, 2> found;
      for (const Point &x : points)
        {
          const unsigned int n =
              profile.find(Point(x - travel * direction), result.safe_way, found);
          for (unsigned int i = 0; i < n; ++i)
            {
              const bool closes = found[i].normal * direction >= sliding;
              result.safe_way =
                  std::min(result.safe_way,
                           closes ? found[i].gap : std::max(found[i].gap, sliding_step * size));
              result.deepest = std::min(result.deepest, found[i].gap);
            }
        }
      return result;
    }
  } // namespace


  double travel_to_contact(const Profile            &profile,
                           const std::vector<Point> &points,
                           const Vector2            &direction,
                           const double              tolerance)
  {
    constexpr double never = std::numeric_limits<double>::infinity();
    // Beyond this way the profile is past all points.
    Box body;
    for (const Point &x : points)
      body.add(x);
    const double size     = body.size();
    const double farthest = 2 * (profile.bounding_box().size() + size +
                                 std::sqrt(body.distance_square(profile.bounding_box().lower)) + 1);

    // A wall that touches all along the way may stand a rounding error inside from the start.
    const double deepest =
        clearance(profile, points, direction, 0, size).deepest - sunk_tolerance * size;
    const auto touches = [&](const Clearance &here) {
      return here.safe_way <= tolerance || here.deepest < deepest;
    };
    double travel = 0, before = 0;
    for (unsigned int i = 0; i < 100000 && travel < farthest; ++i)
      {
        const Clearance here = clearance(profile, points, direction, travel, size);
        if (touches(here))
          {
            if (here.safe_way > 0 && here.deepest >= deepest)
              return travel;
            // A step along a wall may have gone beyond the place where it bends into the way.
            while (travel - before > 0.1 * tolerance)
              {
                const double middle = 0.5 * (before + travel);
                if (middle <= before || middle >= travel)
                  break;
                (touches(clearance(profile, points, direction, middle, size)) ? travel : before) =
                    middle;
              }
            return before;
          }
        before = travel;
        travel += std::min(here.safe_way - 0.5 * tolerance, farthest);
      }
    return never;
  }


  Vector2 bring_to_contact(Profile                  &profile,
                           const std::vector<Point> &points,
                           const Vector2            &direction,
                           const double              tolerance,
                           const std::string        &name)
  {
    Box body;
    for (const Point &x : points)
      body.add(x);
    // Extents along the direction: the foremost of the profile against the hindmost of the points.
    const auto along = [&](const Box &box, const bool most) {
      double result = 0;
      for (unsigned int c = 0; c < 2; ++c)
        result += direction[c] * ((direction[c] > 0) == most ? box.upper[c] : box.lower[c]);
      return result;
    };
    const double back =
        along(profile.bounding_box(), true) - along(body, false) + 0.01 * body.size();
    profile.move(-back * direction);
    profile.orient(points);
    const double forward = travel_to_contact(profile, points, direction, tolerance);
    if (!std::isfinite(forward))
      throw InputError(
          fmt::format("{}: on its way along ({:.4g}, {:.4g}) the tool passes the workpiece without "
                      "touching it. "
                      "Draw it so that it meets the workpiece, or place it where it is to start.",
                      name, direction[0], direction[1]));
    profile.move(forward * direction);
    return (forward - back) * direction;
  }


  std::optional<Point> self_crossing(const Profile &profile)
  {
    const double chord = 1e-4 * profile.bounding_box().size(),
                 least = 1e-6 * profile.bounding_box().size();
    for (const std::vector<Point> &line : profile.sample(chord))
      {
        // By their left ends, so that only pieces that overlap in r are compared.
        std::vector<unsigned int> order(line.size() - 1);
        std::iota(order.begin(), order.end(), 0u);
        const auto leftmost = [&](const unsigned int i) {
          return std::min(line[i][0], line[i + 1][0]);
        };
        std::sort(order.begin(), order.end(), [&](const unsigned int i, const unsigned int j) {
          return leftmost(i) < leftmost(j);
        });
        for (std::size_t i = 0; i < order.size(); ++i)
          {
            const Point a = line[order[i]], b = line[order[i] + 1];
            for (std::size_t j = i + 1;
                 j < order.size() && leftmost(order[j]) <= std::max(a[0], b[0]); ++j)
              {
                const Point c = line[order[j]], d = line[order[j] + 1];
                // Signed distances of the ends of each from the line of the other: both change
                // sides.
                const Vector2 along = (b - a) / a.distance(b), other = (d - c) / c.distance(d);
                const double  c_off = left_of(along) * (c - a), d_off = left_of(along) * (d - a);
                const double  a_off = left_of(other) * (a - c), b_off = left_of(other) * (b - c);
                if (std::min(c_off, d_off) < -least && std::max(c_off, d_off) > least &&
                    std::min(a_off, b_off) < -least && std::max(a_off, b_off) > least)
                  return Point(c + c_off / (c_off - d_off) * (d - c));
              }
          }
      }
    return {};
  }
} // namespace axiforge::tools
