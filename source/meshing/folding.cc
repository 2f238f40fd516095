// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/tolerances.h>
#include <axiforge/meshing/folding.h>

namespace axiforge::meshing
{
  namespace
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();

    /// Straight pieces of an edge.
    constexpr unsigned int n_pieces = 8;

    /// Surface that is near itself is a fold if the way along the outline is so many times longer:
    /// a notch that opens by less than 6 degrees.
    constexpr double way_over_gap = 10;

    /// Opening of a crease that counts as closed: 10 degrees [rad].
    constexpr double closed_crease = M_PI / 18;

    /// A pocket on a tool is one if its surface is so many times longer than its mouth.
    constexpr double depth_of_pocket = 3;

    /// Sine of the angle by which surface has to look at a line in order to meet it.
    constexpr double facing = 0.02;

    using tolerance::same_place;


    enum EdgeKind
    {
      surface,
      axis,
      symmetry
    };

    /// A boundary edge, the workpiece on its left. Numbers only, so that it can be sent.
    struct Edge
    {
      double start, end; ///< global numbers of the vertices
      double kind;
      double x[3][2], v[3][2]; ///< start, end, middle [mm], [mm/s]
      double tool[3];          ///< that they touch, -1: none
    };


    std::vector<Edge> owned_edges(const State &state)
    {
      const auto is = [&](const BoundaryEdge &edge, const char *name) {
        const auto found = state.boundary_ids.find(name);
        return found != state.boundary_ids.end() && found->second == edge.id;
      };
      std::vector<Edge> edges;
      for (const BoundaryEdge &boundary : state.tables.edges)
        if (boundary.owned)
          {
            // The table runs upwards and to the right: turn left and top sides.
            const bool         turned   = boundary.side == 0 || boundary.side == 3;
            const unsigned int order[3] = { turned ? 1u : 0u, turned ? 0u : 1u, 2u };
            Edge               edge;
            edge.kind = is(boundary, "axis") ? axis : is(boundary, "symmetry") ? symmetry : surface;
            for (unsigned int a = 0; a < 3; ++a)
              {
                const unsigned int node    = boundary.nodes[order[a]];
                const NodeContact &contact = state.contacts[boundary.boundary_nodes[order[a]]];
                edge.tool[a]               = contact.active() ? contact.tool[0] : -1.;
                for (unsigned int c = 0; c < 2; ++c)
                  {
                    edge.x[a][c] = state.position.local_element(2 * node + c);
                    edge.v[a][c] = state.velocity.local_element(2 * node + c);
                  }
                if (a < 2)
                  (a == 0 ? edge.start : edge.end) =
                      state.position.get_partitioner()->local_to_global(2 * node) / 2;
              }
            edges.push_back(edge);
          }
      return edges;
    }


    /// A point of an edge that moves.
    struct Sample
    {
      Point   x;
      Vector2 v;
      double  s; ///< arc length from the start of the loop [mm]
      bool    free_after, free_before;
      int     tool; ///< of a node that touches; -1: none
    };

    /// Edge e has the samples n_pieces e to n_pieces (e + 1); the last edge ends at the first
    /// sample, which stands once more at the end.
    struct Loop
    {
      std::vector<Sample> samples;
      std::vector<Edge>   edges;

      double length() const
      {
        return samples.back().s;
      }

      /// Shorter way along the loop.
      double way(const double a, const double b) const
      {
        const double d = std::abs(a - b);
        return std::min(d, length() - d);
      }

      double edge_length(const unsigned int e) const
      {
        return samples[n_pieces * (e + 1)].s - samples[n_pieces * e].s;
      }
    };


    Vector2 on_parabola(const double (&x)[3][2], const double xi)
    {
      Vector2 result;
      for (unsigned int c = 0; c < 2; ++c)
        result[c] = (1 - xi) * (1 - 2 * xi) * x[0][c] + xi * (2 * xi - 1) * x[1][c] +
                    4 * xi * (1 - xi) * x[2][c];
      return result;
    }


    void add_samples(const Edge &edge, Loop &loop)
    {
      // The half of an edge touches if both its nodes do.
      const auto touches = [&](const unsigned int i) {
        return edge.kind == surface && edge.tool[2] >= 0 &&
               edge.tool[i < n_pieces / 2 ? 0 : 1] >= 0;
      };
      for (unsigned int i = 0; i < n_pieces; ++i)
        {
          const double xi = i / double(n_pieces);
          Sample       sample;
          sample.x           = Point(on_parabola(edge.x, xi));
          sample.v           = on_parabola(edge.v, xi);
          sample.s           = 0;
          sample.free_after  = edge.kind == surface && !touches(i);
          sample.free_before = false;
          sample.tool        = i == 0              ? static_cast<int>(edge.tool[0])
                               : i == n_pieces / 2 ? static_cast<int>(edge.tool[2])
                                                   : -1;
          loop.samples.push_back(sample);
        }
      loop.edges.push_back(edge);
    }


    std::vector<Loop> make_loops(const std::vector<Edge> &edges)
    {
      std::map<double, unsigned int> edge_from;
      for (unsigned int e = 0; e < edges.size(); ++e)
        edge_from[edges[e].start] = e;
      std::vector<bool> used(edges.size(), false);
      std::vector<Loop> loops;
      for (unsigned int first = 0; first < edges.size(); ++first)
        {
          if (used[first])
            continue;
          Loop loop;
          for (unsigned int e = first; !used[e];)
            {
              used[e] = true;
              add_samples(edges[e], loop);
              const auto next = edge_from.find(edges[e].end);
              if (next == edge_from.end())
                throw ComputationError("the outline of the workpiece is not closed");
              e = next->second;
            }
          loop.samples.push_back(loop.samples.front());
          for (unsigned int i = 1; i < loop.samples.size(); ++i)
            {
              const Sample &before        = loop.samples[i - 1];
              loop.samples[i].s           = before.s + before.x.distance(loop.samples[i].x);
              loop.samples[i].free_before = before.free_after;
            }
          loop.samples.front().free_before = loop.samples.back().free_before;
          loops.push_back(loop);
        }
      return loops;
    }


    /// Smallest positive root of a + b t + c t^2 up to a time.
    double first_root(const double a, const double b, const double c, const double last)
    {
      const double discriminant = b * b - 4 * a * c;
      if (discriminant < 0)
        return infinity;
      const double q     = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
      double       first = infinity;
      for (const double t : { q / c, a / q })
        if (t > 0 && t <= last) // false for nan
          first = std::min(first, t);
      return first;
    }


    class Search
    {
    public:
      Search(const State &state, const double horizon, const double smallest_gap)
          : loops(make_loops(gather_rows(state.communicator, owned_edges(state))))
          , size(state.size)
          , last_time_step(state.last_time_step)
          , horizon(horizon)
          , smallest_gap(smallest_gap)
      {
        for (unsigned int l = 0; l < loops.size(); ++l)
          for (unsigned int e = 0; e < loops[l].edges.size(); ++e)
            if (loops[l].edges[e].kind == surface)
              parts.push_back(make_part(l, e));
        for (const Part &p : parts)
          for (const Part &q : parts)
            if (&p != &q && p.free && q.free && !neighbours(p, q) && near(p, q))
              compare(p, q);
        lines = symmetry_lines();
        for (const Loop &loop : loops)
          {
            compare_with_axis(loop);
            compare_with_symmetry(loop);
            look_for_creases(loop);
            look_for_pockets(loop);
          }
      }

      std::optional<Fold> found; ///< the one that comes first

    private:
      /// An edge of the surface with the box in which it moves.
      struct Part
      {
        unsigned int loop, edge;
        bool         free;
        double       gap; ///< that counts as closed [mm]
        Point        lower, upper;
      };

      Part make_part(const unsigned int l, const unsigned int e) const
      {
        Part part{ l, e, false, smallest_gap * loops[l].edge_length(e), Point(), Point() };
        for (unsigned int c = 0; c < 2; ++c)
          {
            part.lower[c] = infinity;
            part.upper[c] = -infinity;
          }
        for (unsigned int i = n_pieces * e; i <= n_pieces * (e + 1); ++i)
          {
            const Sample &sample = loops[l].samples[i];
            if (i < n_pieces * (e + 1))
              part.free |= sample.free_after;
            for (unsigned int c = 0; c < 2; ++c)
              {
                const double later = sample.x[c] + horizon * sample.v[c];
                part.lower[c]      = std::min({ part.lower[c], sample.x[c], later });
                part.upper[c]      = std::max({ part.upper[c], sample.x[c], later });
              }
          }
        return part;
      }

      /// Edges with a common vertex make a crease or none, see look_for_creases().
      bool neighbours(const Part &p, const Part &q) const
      {
        const unsigned int n = loops[p.loop].edges.size();
        return p.loop == q.loop && ((p.edge + 1) % n == q.edge || (q.edge + 1) % n == p.edge);
      }

      static bool near(const Part &p, const Part &q)
      {
        const double room = std::min(p.gap, q.gap);
        for (unsigned int c = 0; c < 2; ++c)
          if (p.lower[c] > q.upper[c] + room || q.lower[c] > p.upper[c] + room)
            return false;
        return true;
      }

      void
      add(const Fold::Kind kind, const Point &place, const double opening, const double time_left)
      {
        // Of what meets at the same time, the widest.
        if (!found || time_left < found->time_left * (1 - same_place) ||
            (time_left <= found->time_left * (1 + same_place) &&
             opening > found->opening * (1 + same_place)))
          found = Fold{ kind, place, opening, time_left };
      }

      /// The points of an edge against the pieces of another.
      void compare(const Part &p, const Part &q)
      {
        const Loop &of_p = loops[p.loop], &of_q = loops[q.loop];
        for (unsigned int j = n_pieces * q.edge; j < n_pieces * (q.edge + 1); ++j)
          if (of_q.samples[j].free_after)
            for (unsigned int i = n_pieces * p.edge; i <= n_pieces * (p.edge + 1); ++i)
              if (of_p.samples[i].free_before || of_p.samples[i].free_after)
                {
                  const Loop *const one = p.loop == q.loop ? &of_p : nullptr;
                  compare(of_p.samples[i], of_q.samples[j], of_q.samples[j + 1], one,
                          std::min(p.gap, q.gap));
                  if (i < n_pieces * (p.edge + 1) && of_p.samples[i].free_after)
                    look_for_overlap(of_p.samples[i], of_p.samples[i + 1], of_q.samples[j],
                                     of_q.samples[j + 1]);
                }
      }

      void compare(const Sample &p,
                   const Sample &a,
                   const Sample &b,
                   const Loop   *loop, ///< that both are on, if it is one
                   const double  gap)
      {
        const Vector2 along = b.x - a.x, to_p = p.x - a.x, v_along = b.v - a.v, v_p = p.v - a.v;
        // Area between the piece and the point: negative in front of the surface. A point behind it
        // is on the other side of the workpiece.
        const double area = cross(along, to_p);
        if (!(area < -same_place * size * along.norm()))
          return;
        const double t = first_root(area, cross(along, v_p) + cross(v_along, to_p),
                                    cross(v_along, v_p), horizon);
        if (t <= horizon)
          {
            const Vector2 now    = along + t * v_along;
            const double  length = now.norm();
            const double  place  = (now * (to_p + t * v_p)) / (length * length);
            if (place >= -0.1 && place <= 1.1)
              add(Fold::Kind::surfaces, Point(p.x + t * p.v), -area / along.norm(), t);
          }
        const double  place   = std::clamp((along * to_p) / along.norm_square(), 0., 1.);
        const Vector2 between = to_p - place * along;
        const double  opening = between.norm();
        const double  closing = -(between * (v_p - place * v_along)) / opening;
        const double  way     = loop ? loop->way(p.s, a.s + place * (b.s - a.s)) : infinity;
        if (opening < gap && closing > 0 && way > way_over_gap * opening)
          add(Fold::Kind::surfaces, Point(p.x - 0.5 * between), opening, opening / closing);
      }

      void look_for_overlap(const Sample &p, const Sample &p_end, const Sample &a, const Sample &b)
      {
        const Vector2 d = p_end.x - p.x, e = b.x - a.x, between = a.x - p.x;
        const double  determinant = cross(d, e);
        if (std::abs(determinant) <= same_place * d.norm() * e.norm())
          return;
        const double s = cross(between, e) / determinant, t = cross(between, d) / determinant;
        if (s > 0 && s < 1 && t > 0 && t < 1)
          add(Fold::Kind::overlap, Point(p.x + s * d), 0, 0);
      }

      /// Way along the loop to the nearest edge of a kind.
      static double way_to(const Loop &loop, const double s, const EdgeKind kind)
      {
        double way = infinity;
        for (unsigned int e = 0; e < loop.edges.size(); ++e)
          if (loop.edges[e].kind == kind)
            way = std::min({ way, loop.way(s, loop.samples[n_pieces * e].s),
                             loop.way(s, loop.samples[n_pieces * (e + 1)].s) });
        return way;
      }

      /// Whether free surface on either side of a point looks in a direction.
      static bool faces(const Loop &loop, const unsigned int i, const Vector2 &direction)
      {
        const unsigned int before = i == 0 ? loop.samples.size() - 2 : i - 1;
        for (const unsigned int k : { before, i })
          {
            const Vector2 along = loop.samples[k + 1].x - loop.samples[k].x;
            if (loop.samples[k].free_after && cross(along, direction) < -facing * along.norm())
              return true;
          }
        return false;
      }

      /// Points at a distance from a line, which is half way to their image.
      void compare_with_line(const Loop      &loop,
                             const EdgeKind   kind,
                             const Fold::Kind fold,
                             const Point     &on_line,
                             const Vector2   &normal)
      {
        for (unsigned int e = 0; e < loop.edges.size(); ++e)
          for (unsigned int i = n_pieces * e; i < n_pieces * (e + 1); ++i)
            {
              const Sample &p = loop.samples[i];
              if (loop.edges[e].kind != surface || !(p.free_before || p.free_after))
                continue;
              const double distance = normal * (p.x - on_line), speed = -(normal * p.v);
              if (kind == axis && distance < -same_place * size)
                add(Fold::Kind::overlap, p.x, 0, 0);
              if (distance < same_place * size || speed <= 0 || !faces(loop, i, -normal))
                continue;
              // Near the axis r v_r is the same for all times, not v_r: of r_middle, where v holds.
              const double time_left =
                  kind == axis ? distance * distance /
                                     (2 * speed * (distance + 0.5 * speed * last_time_step))
                               : distance / speed;
              const bool closed = 2 * distance < smallest_gap * loop.edge_length(e) &&
                                  way_to(loop, p.s, kind) > way_over_gap * distance;
              if (time_left <= horizon || closed)
                add(fold, Point(p.x - distance * normal), 2 * distance, time_left);
            }
      }

      void compare_with_axis(const Loop &loop)
      {
        compare_with_line(loop, axis, Fold::Kind::axis, Point(0, 0), Vector2({ 1, 0 }));
      }

      void compare_with_symmetry(const Loop &loop)
      {
        for (const auto &[on_line, normal] : lines)
          compare_with_line(loop, symmetry, Fold::Kind::symmetry, on_line, normal);
      }

      /**
       * A notch between two edges that closes, by the straight lines between the vertices: the
       * middle nodes zig-zag where perfectly plastic material flows unevenly, and turn the edges at
       * a vertex against each other without any fold.
       */
      void look_for_creases(const Loop &loop)
      {
        const unsigned int n = loop.edges.size();
        for (unsigned int e = 0; e < n; ++e)
          {
            const Sample &v = loop.samples[n_pieces * e],
                         &a = loop.samples[n_pieces * ((e + n - 1) % n)],
                         &b = loop.samples[n_pieces * (e + 1)];
            if (!v.free_before || !v.free_after)
              continue;
            // Counter-clockwise from the edge before to the edge behind: the void's angle.
            const auto opening = [&](const double t) {
              const Vector2 to_a = a.x - v.x + t * (a.v - v.v), to_b = b.x - v.x + t * (b.v - v.v);
              const double  angle = std::atan2(cross(to_a, to_b), to_a * to_b);
              return angle;
            };
            const double now = opening(0), length = std::min(v.x.distance(a.x), v.x.distance(b.x));
            if (!(now > 0 && now < 0.5 * M_PI))
              continue;
            const double moment    = 1e-3 * length / ((a.v - v.v).norm() + (b.v - v.v).norm());
            const double rate      = (opening(moment) - now) / moment;
            const double time_left = -now / rate;
            if (rate < 0 && (now < closed_crease || time_left <= horizon))
              add(Fold::Kind::crease, v.x, length * now, time_left);
          }
      }

      /// Open surface from one place that touches a tool to the next that touches the same.
      void look_for_pockets(const Loop &loop)
      {
        const unsigned int n = loop.samples.size() - 1;
        for (unsigned int i = 0; i < n; ++i)
          {
            const Sample &start = loop.samples[i];
            if (!start.free_after || start.tool < 0)
              continue;
            double       way = 0, area = 0, longest = 0;
            unsigned int j = i;
            do
              {
                const Sample &here = loop.samples[j], &next = loop.samples[(j + 1) % n];
                way += here.x.distance(next.x);
                area += 0.5 * cross(here.x - start.x, next.x - start.x);
                longest = std::max(longest, loop.edge_length(j / n_pieces));
                j       = (j + 1) % n;
              }
            while (loop.samples[j].free_after && loop.samples[j].tool < 0 && j != i);
            const Sample &end = loop.samples[j];
            if (end.tool != start.tool || j == i)
              continue;
            const Vector2 mouth   = end.x - start.x;
            const double  opening = mouth.norm();
            const double  closing = -(mouth * (end.v - start.v)) / opening;
            // The workpiece is on the left: a pocket has its void on the right of the way there.
            if (area < 0 && closing > 0 && opening < longest && way > depth_of_pocket * opening)
              add(Fold::Kind::pocket, Point(start.x + 0.5 * mouth), opening, opening / closing);
          }
      }

      /// The symmetry lines, each once, with the normal to the workpiece. A line with some of the
      /// surface behind it is no plane of symmetry but a wall that ends.
      std::vector<std::pair<Point, Vector2>> symmetry_lines() const
      {
        std::vector<std::pair<Point, Vector2>> list;
        for (const Loop &loop : loops)
          for (const Edge &edge : loop.edges)
            if (edge.kind == symmetry)
              {
                const Point   start(edge.x[0][0], edge.x[0][1]), end(edge.x[1][0], edge.x[1][1]);
                const Vector2 along  = (end - start) / start.distance(end);
                const Vector2 normal = Vector2({ -along[1], along[0] });
                bool          counts = true;
                for (const auto &[x, n] : list)
                  counts &=
                      n * normal < 1 - same_place || std::abs(n * (start - x)) > same_place * size;
                for (const Loop &other : loops)
                  for (const Sample &sample : other.samples)
                    counts &= normal * (sample.x - start) > -same_place * size;
                if (counts)
                  list.emplace_back(start, normal);
              }
        return list;
      }

      std::vector<Loop>                      loops;
      std::vector<Part>                      parts;
      std::vector<std::pair<Point, Vector2>> lines;
      double                                 size, last_time_step, horizon, smallest_gap;
    };
  } // namespace


  std::string Fold::describe() const
  {
    const char *const what[] = { "two parts of the free surface meet",
                                 "the free surface meets its mirror image at the symmetry line",
                                 "the bore closes",
                                 "a pocket of free surface closes on a tool",
                                 "a notch of the free surface closes to a crease",
                                 "two parts of the surface have passed through each other" };
    std::string       text   = fmt::format("{} near r = {:.4g} mm, z = {:.4g} mm",
                                           what[static_cast<int>(kind)], place[0], place[1]);
    if (kind != Kind::overlap)
      text += fmt::format(" ({:.3g} mm apart)", opening);
    return text;
  }


  std::optional<Fold> find_fold(const State &state, const double horizon, const double smallest_gap)
  {
    return Search(state, horizon, smallest_gap).found;
  }
} // namespace axiforge::meshing
