// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include <deal.II/base/numbers.h>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/tools/profile.h>

namespace axiforge::tools
{
  using dealii::numbers::PI;

  namespace
  {
    /// Ends that are closer than this share of the profile's size are joined.
    constexpr double joining_tolerance = 1e-7;

    Vector2 left_of(const Vector2 &t)
    {
      return Vector2({ -t[1], t[0] });
    }

    Vector2 mirrored(const Vector2 &t)
    {
      return Vector2({ -t[0], t[1] });
    }

    double angle_between(const Vector2 &from, const Vector2 &to)
    {
      return std::atan2(from[0] * to[1] - from[1] * to[0], from * to);
    }

    /// Number the distinct ones of some points: equal if they are within @p tolerance.
    std::vector<unsigned int> number_points(const std::vector<Point> &points,
                                            const double              tolerance)
    {
      std::vector<unsigned int> order(points.size());
      std::iota(order.begin(), order.end(), 0u);
      std::sort(order.begin(), order.end(), [&](const unsigned int a, const unsigned int b) {
        return points[a][0] != points[b][0] ? points[a][0] < points[b][0] : a < b;
      });

      std::vector<unsigned int> number(points.size());
      for (std::size_t i = 0; i < order.size(); ++i)
        {
          const Point &x   = points[order[i]];
          number[order[i]] = order[i];
          for (std::size_t j = i; j-- > 0 && x[0] - points[order[j]][0] <= tolerance;)
            if (x.distance(points[order[j]]) <= tolerance)
              {
                number[order[i]] = number[order[j]];
                break;
              }
        }
      return number;
    }

    /// The chain of unused segments that holds @p start, in that segment's direction.
    std::deque<Segment> follow(const std::vector<Segment>                   &segments,
                               const std::vector<std::array<unsigned, 2>>   &ends,
                               const std::vector<std::vector<unsigned int>> &at_vertex,
                               const unsigned int                            start,
                               std::vector<bool>                            &used,
                               bool                                         &closed)
    {
      std::deque<Segment> chain = { segments[start] };
      used[start]               = true;

      const auto next_at = [&](const unsigned int vertex) {
        for (const unsigned int s : at_vertex[vertex])
          if (!used[s])
            return static_cast<int>(s);
        return -1;
      };

      unsigned int vertex = ends[start][1];
      for (int s = next_at(vertex); s >= 0; s = next_at(vertex))
        {
          used[s]            = true;
          const bool forward = ends[s][0] == vertex;
          chain.push_back(forward ? segments[s] : segments[s].reversed());
          vertex = ends[s][forward ? 1 : 0];
        }
      closed = vertex == ends[start][0];

      vertex = ends[start][0];
      for (int s = next_at(vertex); s >= 0; s = next_at(vertex))
        {
          used[s]            = true;
          const bool forward = ends[s][1] == vertex;
          chain.push_front(forward ? segments[s] : segments[s].reversed());
          vertex = ends[s][forward ? 0 : 1];
        }
      return chain;
    }
  } // namespace

  Profile::Profile(std::vector<Segment> segments, const std::string &name)
      : name(name)
  {
    Box all;
    for (const Segment &segment : segments)
      all.add(segment.box());
    const double tolerance = joining_tolerance * all.size();
    segments.erase(std::remove_if(segments.begin(), segments.end(),
                                  [&](const Segment &s) { return !(s.length() > tolerance); }),
                   segments.end());
    if (segments.empty())
      throw InputError(fmt::format("{}: the tool's profile is empty: it has no curve of finite "
                                   "length outside of the axis r = 0. A profile starts on the axis "
                                   "or beside it and leads away from it.",
                                   name));

    std::vector<Point> points;
    for (const Segment &segment : segments)
      {
        points.push_back(segment.begin());
        points.push_back(segment.end());
      }
    const std::vector<unsigned int>        number = number_points(points, tolerance);
    std::vector<std::array<unsigned, 2>>   ends(segments.size());
    std::vector<std::vector<unsigned int>> at_vertex(points.size());
    for (unsigned int s = 0; s < segments.size(); ++s)
      {
        ends[s] = { { number[2 * s], number[2 * s + 1] } };
        at_vertex[ends[s][0]].push_back(s);
        at_vertex[ends[s][1]].push_back(s);
      }
    for (unsigned int v = 0; v < points.size(); ++v)
      if (at_vertex[v].size() > 2)
        throw InputError(fmt::format(
            "{}: the tool's profile branches: {} curves meet at r = {:.6g}, z = {:.6g} mm "
            "where at "
            "most two may. Leave inner lines and double curves out of its physical group.",
            name, at_vertex[v].size(), points[v][0], points[v][1]));

    std::vector<bool> used(segments.size(), false);
    for (unsigned int s = 0; s < segments.size(); ++s)
      if (!used[s])
        {
          Chain                     chain;
          const std::deque<Segment> pieces =
              follow(segments, ends, at_vertex, s, used, chain.closed);
          chain.segments.assign(pieces.begin(), pieces.end());
          chains.push_back(std::move(chain));
        }
    complete();
  }

  const Profile::Junction &Profile::Chain::junction(const unsigned int segment,
                                                    const bool         at_end) const
  {
    return junctions[segment + (at_end ? 1 : 0)];
  }

  void Profile::complete()
  {
    box          = Box();
    whole_length = 0;
    face_count   = 0;
    for (Chain &chain : chains)
      {
        complete(chain, face_count);
        face_count = 1 + *std::max_element(chain.faces.begin(), chain.faces.end());
        box.add(chain.box);
        whole_length += chain.starts.back() + chain.segments.back().length();
      }
  }

  void Profile::complete(Chain &chain, const unsigned int first_face) const
  {
    chain.box     = Box();
    double length = 0;
    double area   = 0; // twice the signed area
    chain.starts.clear();
    for (const Segment &segment : chain.segments)
      {
        chain.box.add(segment.box());
        chain.starts.push_back(length);
        length += segment.length();
        for (unsigned int i = 0; i < 8; ++i)
          {
            const Point a = segment.point(i / 8.), b = segment.point((i + 1) / 8.);
            area += a[0] * b[1] - a[1] * b[0];
          }
      }
    chain.tool_is_inside = area < 0;

    set_junctions(chain);
    set_runs(chain);
    set_cone(chain);

    const std::size_t n = chain.segments.size();
    chain.faces.assign(n, first_face);
    for (unsigned int s = 1; s < n; ++s)
      chain.faces[s] =
          chain.faces[s - 1] + (std::abs(chain.junctions[s].turn) > smooth_angle ? 1 : 0);
    if (chain.closed && std::abs(chain.junctions[0].turn) <= smooth_angle)
      {
        const unsigned int last_face = chain.faces.back();
        std::replace(chain.faces.begin(), chain.faces.end(), last_face, first_face);
      }
  }

  void Profile::set_junctions(Chain &chain) const
  {
    const auto between = [](const Vector2 &before, const Vector2 &after) {
      Junction junction;
      junction.turn     = angle_between(before, after);
      junction.bisector = left_of(before) + left_of(after);
      if (PI - std::abs(junction.turn) < 1e-9) // a cusp: the outline turns back, around a thin wall
        {
          junction.turn     = -PI;
          junction.bisector = before;
        }
      return junction;
    };

    const std::size_t n = chain.segments.size();
    chain.junctions.assign(n + 1, Junction());
    for (unsigned int s = 1; s < n; ++s)
      chain.junctions[s] =
          between(chain.segments[s - 1].tangent(1.), chain.segments[s].tangent(0.));

    const Segment &first = chain.segments.front(), &last = chain.segments.back();
    if (chain.closed)
      {
        chain.junctions[0] = between(last.tangent(1.), first.tangent(0.));
        chain.junctions[n] = chain.junctions[0];
        return;
      }
    // Across the axis the outline goes on with its mirror image, which runs the other way.
    const double on_axis = 1e-9 * chain.box.size();
    if (std::abs(first.begin()[0]) <= on_axis)
      chain.junctions[0] = between(-mirrored(first.tangent(0.)), first.tangent(0.));
    else
      chain.junctions[0].free_end = true;
    if (std::abs(last.end()[0]) <= on_axis)
      chain.junctions[n] = between(last.tangent(1.), -mirrored(last.tangent(1.)));
    else
      chain.junctions[n].free_end = true;
  }

  void Profile::set_runs(Chain &chain) const
  {
    const unsigned int n          = chain.segments.size();
    const auto         has_corner = [&](const unsigned int junction) {
      return std::abs(chain.junctions[junction].turn) > corner_angle;
    };

    // A closed chain is begun at a corner, if it has one.
    unsigned int begin = 0;
    if (chain.closed)
      while (begin < n && !has_corner(begin))
        ++begin;
    begin = begin == n ? 0 : begin;

    chain.runs.clear();
    chain.run_of.assign(n, 0);
    for (unsigned int i = 0; i < n; ++i)
      {
        const unsigned int s = (begin + i) % n;
        if (i == 0 || has_corner(s))
          {
            chain.runs.emplace_back();
            chain.runs.back().first = s;
          }
        ++chain.runs.back().count;
        chain.runs.back().box.add(chain.segments[s].box());
        chain.run_of[s] = chain.runs.size() - 1;
      }
  }

  void Profile::set_cone(Chain &chain) const
  {
    double angle = 0, lowest = 0, highest = 0;
    for (unsigned int s = 0; s < chain.segments.size(); ++s)
      {
        if (s > 0)
          angle += chain.junctions[s].turn;
        const Segment::Turning turning = chain.segments[s].turning();
        lowest                         = std::min(lowest, angle + turning.lowest);
        highest                        = std::max(highest, angle + turning.highest);
        angle += turning.total;
      }
    chain.has_cone = !chain.closed && highest - lowest < 0.99 * PI;

    chain.cone.clear();
    const Vector2 t = chain.segments.front().tangent(0.);
    for (const double turn : { lowest, highest })
      chain.cone.push_back(left_of(std::cos(turn) * t + std::sin(turn) * left_of(t)));
    for (const Junction &end : { chain.junctions.front(), chain.junctions.back() })
      if (!end.free_end)
        chain.cone.push_back(end.bisector); // with the mirror image across the axis
  }

  void Profile::reverse(Chain &chain)
  {
    std::reverse(chain.segments.begin(), chain.segments.end());
    for (Segment &segment : chain.segments)
      segment = segment.reversed();
  }

  double Profile::vote(const Chain &chain, const Point &x, const double weighting_distance)
  {
    const Nearest  found    = nearest(chain, x, 0, chain.segments.size());
    const Segment &segment  = chain.segments[found.segment];
    double         distance = make_contact(chain, found, x).gap;
    double         trust    = 1;
    if (!found.foot.inside && chain.junction(found.segment, found.foot.parameter > 0.5).free_end)
      {
        // Beyond a free end the gap says nothing, and the end's own line little.
        distance = (x - found.foot.point) * left_of(segment.tangent(found.foot.parameter));
        trust    = 1e-3;
      }
    const double d = std::abs(distance) + weighting_distance;
    return trust * distance / (d * d);
  }

  void Profile::orient(const std::vector<Point> &workpiece_points)
  {
    Box workpiece;
    for (const Point &x : workpiece_points)
      workpiece.add(x);
    const double weighting_distance = 0.02 * workpiece.size();

    for (Chain &chain : chains)
      {
        double sum = 0;
        for (const Point &x : workpiece_points)
          sum += vote(chain, x, weighting_distance);
        if (!(std::abs(sum) * weighting_distance > 1e-12))
          throw InputError(fmt::format(
              "{}: the workpiece does not tell which side of the tool's curve from r = "
              "{:.6g}, "
              "z = {:.6g} mm to r = {:.6g}, z = {:.6g} mm is the outside. Place the tool so that "
              "the "
              "workpiece lies on one side of its profile.",
              name, chain.segments.front().begin()[0], chain.segments.front().begin()[1],
              chain.segments.back().end()[0], chain.segments.back().end()[1]));
        if (sum < 0)
          reverse(chain);

        const auto before = [](const Segment &a, const Segment &b) {
          return a.begin()[0] != b.begin()[0] ? a.begin()[0] < b.begin()[0]
                                              : a.begin()[1] < b.begin()[1];
        };
        if (chain.closed)
          std::rotate(chain.segments.begin(),
                      std::min_element(chain.segments.begin(), chain.segments.end(), before),
                      chain.segments.end());
      }
    std::stable_sort(chains.begin(), chains.end(), [](const Chain &a, const Chain &b) {
      const Point x = a.segments.front().begin(), y = b.segments.front().begin();
      return x[0] != y[0] ? x[0] < y[0] : x[1] < y[1];
    });
    complete();
  }

  void Profile::move(const Vector2 &way)
  {
    for (Chain &chain : chains)
      for (Segment &segment : chain.segments)
        segment = segment.moved(way);
    complete();
  }

  std::vector<std::vector<Point>> Profile::sample(const double chord_tolerance) const
  {
    std::vector<std::vector<Point>> polylines;
    for (const Chain &chain : chains)
      {
        std::vector<Point> points = { chain.segments.front().begin() };
        for (const Segment &segment : chain.segments)
          for (const double t : segment.sample(chord_tolerance))
            if (t > 0)
              points.push_back(segment.point(t));
        polylines.push_back(std::move(points));
      }
    return polylines;
  }

  const Box &Profile::bounding_box() const
  {
    return box;
  }

  double Profile::length() const
  {
    return whole_length;
  }

  std::vector<Profile::Corner> Profile::corners() const
  {
    std::vector<Corner> result;
    for (const Chain &chain : chains)
      for (unsigned int s = chain.closed ? 0 : 1; s < chain.segments.size(); ++s)
        if (const double turn = chain.junctions[s].turn; std::abs(turn) > corner_angle)
          result.push_back({ chain.segments[s].begin(), turn });
    return result;
  }

  std::vector<Point> Profile::free_ends() const
  {
    std::vector<Point> result;
    for (const Chain &chain : chains)
      {
        if (!chain.closed && chain.junctions.front().free_end)
          result.push_back(chain.segments.front().begin());
        if (!chain.closed && chain.junctions.back().free_end)
          result.push_back(chain.segments.back().end());
      }
    return result;
  }

  unsigned int Profile::n_faces() const
  {
    return face_count;
  }

  unsigned int Profile::n_chains() const
  {
    return chains.size();
  }
} // namespace axiforge::tools
