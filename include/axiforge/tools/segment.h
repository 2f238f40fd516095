// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <vector>

#include <axiforge/base/geometry.h>

namespace axiforge::tools
{
  /// An axis-parallel box [mm].
  struct Box
  {
    Point lower{ 1e300, 1e300 };
    Point upper{ -1e300, -1e300 };

    void add(const Point &x);
    void add(const Box &box);

    /// Square of the distance from x, 0 inside [mm^2].
    double distance_square(const Point &x) const;

    /// Length of the diagonal [mm].
    double size() const;
  };

  /**
   * One piece of a tool's outline: a straight line, a circular arc or a cubic in Hermite form, with
   * a parameter t from 0 (begin) to 1 (end) and the exact closest point.
   */
  class Segment
  {
  public:
    /// The point of a segment closest to some x.
    struct Foot
    {
      Point  point;
      double parameter = 0; ///< t in [0, 1]
      double distance  = 0; ///< |x - point| [mm], not negative
      bool inside = true; ///< false if x lies beyond an end: the closest point is that end, and the
                          ///< line to it is not perpendicular to the segment
    };

    static Segment line(const Point &begin, const Point &end);

    /**
     * Arc from begin to end around centre. Equal end points make a full circle. The radius is the
     * mean of the distances of both ends, which have to agree to 1e-6 of it (asserted).
     */
    static Segment
    arc(const Point &begin, const Point &end, const Point &centre, bool counter_clockwise);

    /// Cubic with the derivatives dx/dt at both ends, t in [0, 1].
    static Segment cubic(const Point   &begin,
                         const Point   &end,
                         const Vector2 &begin_derivative,
                         const Vector2 &end_derivative);

    /// The same points run through the other way.
    Segment reversed() const;

    /// The same segment elsewhere.
    Segment moved(const Vector2 &way) const;

    Point begin() const;
    Point end() const;

    Point point(double t) const;

    /// Unit tangent, in the direction of growing t.
    Vector2 tangent(double t) const;

    /// Curvature [1/mm], positive where the segment turns left.
    double curvature(double t) const;

    /// Length from 0 to t [mm].
    double arc_length(double t) const;
    double length() const;

    /// Range of the tangent's direction.
    struct Turning
    {
      double lowest;  ///< smallest angle against the tangent at the begin, at most 0
      double highest; ///< largest angle, at least 0
      double total;   ///< angle at the end
    };

    /// A range [rad, positive to the left] that holds all tangents (exact but for cubics).
    Turning turning() const;

    /// The closest point. Of two equally close ones, either.
    Foot closest(const Point &x) const;

    /// Box around all points.
    const Box &box() const;

    /// Parameters 0 ... 1 of points between which the chord is off by at most @p tolerance [mm].
    std::vector<double> sample(double tolerance) const;

  private:
    enum class Type
    {
      line,
      arc,
      cubic
    };

    /// Derivatives with respect to t.
    Vector2 first_derivative(double t) const;
    Vector2 second_derivative(double t) const;

    double closest_on_arc(const Point &x) const;
    double closest_on_cubic(const Point &x) const;
    void   complete();

    Type                   type = Type::line;
    Point                  first;
    Point                  last;
    Point                  centre;          // arc
    double                 radius      = 0; // arc
    double                 start_angle = 0; // arc
    double                 sweep       = 0; // arc, positive counter-clockwise
    std::array<Vector2, 2> derivatives;     // cubic, at the ends
    double                 whole_length = 0;
    Box                    bounding_box;
  };
} // namespace axiforge::tools
