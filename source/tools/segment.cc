// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/numbers.h>

#include <axiforge/tools/segment.h>

namespace axiforge::tools
{
  using dealii::numbers::PI;

  namespace
  {
    /// A point counts as beyond an end if it is farther out than this share of the length.
    constexpr double end_tolerance = 1e-9;

    /// Starting intervals of the search on a cubic.
    constexpr unsigned int n_search_intervals = 8;

    /// @p angle shifted by full turns into [0, 2 pi).
    double positive_angle(const double angle)
    {
      const double a = std::fmod(angle, 2 * PI);
      return a < 0 ? a + 2 * PI : a;
    }
  } // namespace

  void Box::add(const Point &x)
  {
    for (unsigned int d = 0; d < 2; ++d)
      {
        lower[d] = std::min(lower[d], x[d]);
        upper[d] = std::max(upper[d], x[d]);
      }
  }

  void Box::add(const Box &box)
  {
    add(box.lower);
    add(box.upper);
  }

  double Box::distance_square(const Point &x) const
  {
    double square = 0;
    for (unsigned int d = 0; d < 2; ++d)
      {
        const double outside = std::max({ lower[d] - x[d], x[d] - upper[d], 0. });
        square += outside * outside;
      }
    return square;
  }

  double Box::size() const
  {
    return lower.distance(upper);
  }

  Segment Segment::line(const Point &begin, const Point &end)
  {
    Segment segment;
    segment.type  = Type::line;
    segment.first = begin;
    segment.last  = end;
    segment.complete();
    return segment;
  }

  Segment Segment::arc(const Point &begin,
                       const Point &end,
                       const Point &centre,
                       const bool   counter_clockwise)
  {
    const Vector2 from = begin - centre, to = end - centre;

    Segment segment;
    segment.type        = Type::arc;
    segment.first       = begin;
    segment.last        = end;
    segment.centre      = centre;
    segment.radius      = (from.norm() + to.norm()) / 2;
    segment.start_angle = std::atan2(from[1], from[0]);
    AssertThrow(std::abs(from.norm() - to.norm()) <= 1e-6 * segment.radius,
                dealii::ExcMessage("The ends of an arc have different distances from its centre."));

    // Seen from the start, the end comes after this angle; a full turn if they coincide.
    const double turn = std::atan2(cross(from, to), from * to);
    segment.sweep     = counter_clockwise ? positive_angle(turn) : -positive_angle(-turn);
    if (begin.distance(end) <= 1e-12 * segment.radius)
      segment.sweep = counter_clockwise ? 2 * PI : -2 * PI;
    segment.complete();
    return segment;
  }

  Segment Segment::cubic(const Point   &begin,
                         const Point   &end,
                         const Vector2 &begin_derivative,
                         const Vector2 &end_derivative)
  {
    Segment segment;
    segment.type        = Type::cubic;
    segment.first       = begin;
    segment.last        = end;
    segment.derivatives = { { begin_derivative, end_derivative } };
    segment.complete();
    return segment;
  }

  void Segment::complete()
  {
    bounding_box.add(first);
    bounding_box.add(last);
    switch (type)
      {
      case Type::line:
        whole_length = first.distance(last);
        break;

      case Type::arc:
        whole_length = radius * std::abs(sweep);
        for (unsigned int quarter = 0; quarter < 4; ++quarter)
          {
            const double angle  = quarter * PI / 2 - start_angle;
            const double passed = sweep > 0 ? positive_angle(angle) : positive_angle(-angle);
            if (passed <= std::abs(sweep))
              bounding_box.add(point(passed / std::abs(sweep)));
          }
        break;

      case Type::cubic:
        // A cubic lies within the hull of its Bezier points.
        bounding_box.add(first + derivatives[0] / 3.);
        bounding_box.add(last - derivatives[1] / 3.);
        whole_length = arc_length(1.);
        break;
      }
  }

  Segment Segment::moved(const Vector2 &way) const
  {
    Segment segment = *this;
    segment.first += way;
    segment.last += way;
    segment.centre += way;
    segment.bounding_box = Box();
    segment.complete();
    return segment;
  }

  Segment Segment::reversed() const
  {
    Segment segment = *this;
    std::swap(segment.first, segment.last);
    segment.start_angle    = start_angle + sweep;
    segment.sweep          = -sweep;
    segment.derivatives[0] = -derivatives[1];
    segment.derivatives[1] = -derivatives[0];
    return segment;
  }

  Point Segment::begin() const
  {
    return first;
  }

  Point Segment::end() const
  {
    return last;
  }

  const Box &Segment::box() const
  {
    return bounding_box;
  }

  double Segment::length() const
  {
    return whole_length;
  }

  Point Segment::point(const double t) const
  {
    if (t <= 0)
      return first;
    if (t >= 1)
      return last;
    switch (type)
      {
      case Type::line:
        return first + t * (last - first);

      case Type::arc:
        {
          const double angle = start_angle + t * sweep;
          return centre + radius * Vector2({ std::cos(angle), std::sin(angle) });
        }

      case Type::cubic:
        {
          const double s = 1 - t;
          return first + (t * t * (3 - 2 * t)) * (last - first) + (t * s * s) * derivatives[0] -
                 (t * t * s) * derivatives[1];
        }
      }
    return {};
  }

  Vector2 Segment::first_derivative(const double t) const
  {
    switch (type)
      {
      case Type::line:
        return last - first;

      case Type::arc:
        {
          const double angle = start_angle + t * sweep;
          return radius * sweep * Vector2({ -std::sin(angle), std::cos(angle) });
        }

      case Type::cubic:
        return (6 * t * (1 - t)) * (last - first) + ((1 - t) * (1 - 3 * t)) * derivatives[0] +
               (t * (3 * t - 2)) * derivatives[1];
      }
    return {};
  }

  Vector2 Segment::second_derivative(const double t) const
  {
    switch (type)
      {
      case Type::line:
        return Vector2();

      case Type::arc:
        {
          const double angle = start_angle + t * sweep;
          return -radius * sweep * sweep * Vector2({ std::cos(angle), std::sin(angle) });
        }

      case Type::cubic:
        return (6 - 12 * t) * (last - first) + (6 * t - 4) * derivatives[0] +
               (6 * t - 2) * derivatives[1];
      }
    return {};
  }

  Vector2 Segment::tangent(const double t) const
  {
    const Vector2 derivative = first_derivative(t);
    return derivative / derivative.norm();
  }

  double Segment::curvature(const double t) const
  {
    if (type == Type::line)
      return 0;
    if (type == Type::arc)
      return (sweep > 0 ? 1 : -1) / radius;
    const Vector2 derivative = first_derivative(t);
    return cross(derivative, second_derivative(t)) / std::pow(derivative.norm(), 3);
  }

  double Segment::arc_length(const double t) const
  {
    if (type != Type::cubic)
      return t * whole_length;

    // Gauss-Legendre with four points on four intervals: to rounding for the gently curved pieces
    // splines are cut into.
    constexpr std::array<double, 2> abscissas = { { 0.861136311594052575, 0.339981043584856265 } };
    constexpr std::array<double, 2> weights   = { { 0.347854845137453857, 0.652145154862546143 } };
    constexpr unsigned int          n         = 4;
    const double                    h         = t / (2 * n); // half an interval
    double                          length    = 0;
    for (unsigned int i = 0; i < n; ++i)
      for (unsigned int q = 0; q < 2; ++q)
        for (const double sign : { -1., 1. })
          length += weights[q] * h * first_derivative(h * (2 * i + 1 + sign * abscissas[q])).norm();
    return length;
  }

  Segment::Turning Segment::turning() const
  {
    if (type == Type::line)
      return { 0, 0, 0 };
    if (type == Type::arc)
      return { std::min(sweep, 0.), std::max(sweep, 0.), sweep };

    // The derivative is a Bezier curve of these three vectors, and so lies between them.
    const std::array<Vector2, 3> hull = {
      { derivatives[0], 3. * (last - first) - derivatives[0] - derivatives[1], derivatives[1] }
    };
    const double middle = std::atan2(cross(hull[0], hull[1]), hull[0] * hull[1]);
    const double total  = middle + std::atan2(cross(hull[1], hull[2]), hull[1] * hull[2]);
    return { std::min({ 0., middle, total }), std::max({ 0., middle, total }), total };
  }

  double Segment::closest_on_arc(const Point &x) const
  {
    const Vector2 d = x - centre;
    if (d.norm_square() == 0)
      return 0.5;
    const double angle  = std::atan2(d[1], d[0]) - start_angle;
    const double passed = sweep > 0 ? positive_angle(angle) : positive_angle(-angle);
    const double whole  = std::abs(sweep);
    if (passed <= whole)
      return passed / whole;
    // In the gap between the end and the start: the nearer of the two.
    return passed - whole < 2 * PI - passed ? 1 : 0;
  }

  double Segment::closest_on_cubic(const Point &x) const
  {
    // Zeros of g(t) = (p(t) - x) . p'(t) from + to -, bracketed by samples of the distance; Newton
    // kept inside the bracket by bisection.
    std::array<double, n_search_intervals + 1> distances;
    for (unsigned int i = 0; i <= n_search_intervals; ++i)
      distances[i] = (point(double(i) / n_search_intervals) - x).norm_square();

    double best_t = 0, best = 1e300;
    for (unsigned int i = 0; i <= n_search_intervals; ++i)
      {
        if ((i > 0 && distances[i - 1] < distances[i]) ||
            (i < n_search_intervals && distances[i + 1] < distances[i]))
          continue;
        double lower = double(i > 0 ? i - 1 : 0) / n_search_intervals;
        double upper = double(std::min(i + 1, n_search_intervals)) / n_search_intervals;
        double t     = double(i) / n_search_intervals;
        for (unsigned int iteration = 0; iteration < 60; ++iteration)
          {
            const Vector2 offset    = point(t) - x;
            const Vector2 d1        = first_derivative(t);
            const double  g         = offset * d1;
            const double  slope     = d1 * d1 + offset * second_derivative(t);
            (g > 0 ? upper : lower) = t;

            double next = slope > 0 ? t - g / slope : lower - 1;
            if (!(next >= lower && next <= upper))
              next = (lower + upper) / 2;
            const double change = std::abs(next - t);
            t                   = next;
            if (change <= 1e-15)
              break;
          }
        // Bisection creeps up to an end but never quite gets there.
        if (t < 1e-14)
          t = 0;
        if (t > 1 - 1e-14)
          t = 1;
        const double distance = (point(t) - x).norm_square();
        if (distance < best)
          {
            best   = distance;
            best_t = t;
          }
      }
    return best_t;
  }

  Segment::Foot Segment::closest(const Point &x) const
  {
    double t = 0;
    switch (type)
      {
      case Type::line:
        {
          const Vector2 d = last - first;
          t               = std::clamp(((x - first) * d) / d.norm_square(), 0., 1.);
          break;
        }
      case Type::arc:
        t = closest_on_arc(x);
        break;
      case Type::cubic:
        t = closest_on_cubic(x);
        break;
      }

    Foot foot;
    foot.parameter = t;
    foot.point     = point(t);
    foot.distance  = x.distance(foot.point);
    if (t <= 0)
      foot.inside = (x - first) * tangent(0.) >= -end_tolerance * whole_length;
    else if (t >= 1)
      foot.inside = (x - last) * tangent(1.) <= end_tolerance * whole_length;
    return foot;
  }

  std::vector<double> Segment::sample(const double tolerance) const
  {
    if (type == Type::line)
      return { 0., 1. };

    unsigned int n = 1;
    if (type == Type::arc)
      {
        // sagitta r (1 - cos(angle / 2)) of a chord
        const double angle = 2 * std::acos(std::max(0., 1 - std::min(1., tolerance / radius)));
        n                  = std::max(1., std::ceil(std::abs(sweep) / std::max(angle, 1e-3)));
      }
    else
      {
        // |p''| / 8 bounds the distance from the chord of a unit interval; p'' is linear in t.
        const double bend = std::max(second_derivative(0.).norm(), second_derivative(1.).norm());
        n                 = std::max(1., std::ceil(std::sqrt(bend / (8 * tolerance))));
      }

    std::vector<double> parameters(n + 1);
    for (unsigned int i = 0; i <= n; ++i)
      parameters[i] = double(i) / n;
    return parameters;
  }
} // namespace axiforge::tools
