// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/tools/positioning.h>

namespace axiforge::tools
{
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
    const double farthest = 2 * (profile.bounding_box().size() + body.size() +
                                 std::sqrt(body.distance_square(profile.bounding_box().lower)) + 1);

    // A surface that moves along itself does not come closer: it may touch and slide.
    constexpr double sliding = 0.02;
    double           travel  = 0;
    for (unsigned int i = 0; i < 100000 && travel < farthest; ++i)
      {
        double nearest = never;
        for (const Point &x : points)
          {
            std::array<Contact, 2> found;
            if (profile.find(Point(x - travel * direction), nearest, found) > 0)
              nearest = std::min(nearest, std::abs(found[0].normal * direction) < sliding
                                              ? std::max(found[0].gap, 0.005 * body.size())
                                              : found[0].gap);
          }
        if (nearest <= tolerance)
          return travel;
        travel += std::min(nearest - 0.5 * tolerance, farthest);
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
} // namespace axiforge::tools
