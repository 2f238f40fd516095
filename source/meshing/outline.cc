// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <deal.II/base/mpi.h>

#include <axiforge/base/errors.h>
#include <axiforge/meshing/outline.h>
#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  namespace
  {
    /// Angles of the outline above this are corners [rad].
    constexpr double corner_angle = M_PI / 6;

    /// Those above this come before all others [rad].
    constexpr double sharp_angle = M_PI / 4;

    /// A turn of free surface above this is a corner to be kept [rad].
    constexpr double sharpest_wave = 1.;

    /// A point inside a tool by this share of the size is moved out.
    constexpr double inside = 1e-9;

    SurfaceNode without_contact()
    {
      SurfaceNode node{};
      node.tool[0] = node.tool[1] = -1;
      return node;
    }


    bool touches(const SurfaceNode &node, const int tool)
    {
      return tool >= 0 && (node.tool[0] == tool || node.tool[1] == tool);
    }


    /// Between two nodes that touch the same tool.
    SurfaceNode blend(const SurfaceNode &a, const SurfaceNode &b, const double t, const int tool)
    {
      SurfaceNode node     = without_contact();
      const auto  mean     = [&](const double x, const double y) { return (1 - t) * x + t * y; };
      node.tool[0]         = tool;
      node.pressure        = mean(a.pressure, b.pressure);
      node.slip            = mean(a.slip, b.slip);
      node.traction        = mean(a.traction, b.traction);
      node.stored_traction = mean(a.stored_traction, b.stored_traction);
      node.strain_rate     = mean(a.strain_rate, b.strain_rate);
      node.earlier_rate    = mean(a.earlier_rate, b.earlier_rate);
      node.previous_slip   = mean(a.previous_slip, b.previous_slip);
      node.has_previous    = a.has_previous > 0 && b.has_previous > 0;
      return node;
    }


    void measure_arc(OutlinePiece &piece)
    {
      piece.arc[0] = 0;
      for (unsigned int i = 1; i < piece.arc.size(); ++i)
        piece.arc[i] =
            piece.arc[i - 1] + piece.position(i / 16.).distance(piece.position((i - 1) / 16.));
    }


    OutlinePiece half(const OutlinePiece &whole, const bool second, const int tool)
    {
      OutlinePiece piece = whole;
      const double from  = second ? 0.5 : 0;
      piece.x            = { { second ? whole.x[2] : whole.x[0], second ? whole.x[1] : whole.x[2],
                               whole.position(from + 0.25) } };
      piece.node[0]      = whole.node[second ? 2 : 0];
      piece.node[1]      = whole.node[second ? 1 : 2];
      piece.node[2] =
          tool >= 0 ? blend(piece.node[0], piece.node[1], 0.5, tool) : without_contact();
      piece.tool = tool;
      measure_arc(piece);
      return piece;
    }


    /// The part of a free piece between two parameters.
    OutlinePiece part(const OutlinePiece &whole, const double from, const double to)
    {
      OutlinePiece piece = whole;
      piece.x = { { whole.position(from), whole.position(to), whole.position(0.5 * (from + to)) } };
      if (from > 0)
        piece.node[0] = without_contact();
      if (to < 1)
        piece.node[1] = without_contact();
      piece.node[2] = without_contact();
      measure_arc(piece);
      return piece;
    }


    /// One edge, or its two halves if contact ends at its middle.
    void add_pieces(const EdgeSnapshot &edge, std::vector<OutlinePiece> &pieces)
    {
      OutlinePiece piece;
      for (unsigned int a = 0; a < 3; ++a)
        {
          piece.x[a]    = Point(edge.position[a][0], edge.position[a][1]);
          piece.node[a] = edge.node[a];
        }
      piece.id            = static_cast<dealii::types::boundary_id>(edge.boundary);
      piece.tool          = -1;
      const int  tool     = piece.id == axis_id || piece.id == symmetry_id
                                ? -1
                                : static_cast<int>(edge.node[2].tool[0]);
      const bool at_start = touches(edge.node[0], tool), at_end = touches(edge.node[1], tool);
      if (at_start != at_end)
        {
          pieces.push_back(half(piece, false, at_start ? tool : -1));
          pieces.push_back(half(piece, true, at_end ? tool : -1));
          return;
        }
      if (at_start)
        piece.tool = tool;
      measure_arc(piece);
      pieces.push_back(piece);
    }


    bool held(const dealii::types::boundary_id id)
    {
      return id != surface_id && id != axis_id && id != symmetry_id;
    }


    bool straight(const dealii::types::boundary_id id)
    {
      return id == axis_id || id == symmetry_id;
    }


    double angle_between(const Vector2 &a, const Vector2 &b)
    {
      return std::abs(std::atan2(a[0] * b[1] - a[1] * b[0], a * b));
    }
  } // namespace


  Point OutlinePiece::position(const double xi) const
  {
    Point result;
    for (unsigned int c = 0; c < 2; ++c)
      result[c] = x[0][c] == x[1][c] && x[0][c] == x[2][c]
                      ? x[0][c] // r = 0 and the symmetry line to the last bit
                      : (1 - xi) * (1 - 2 * xi) * x[0][c] + xi * (2 * xi - 1) * x[1][c] +
                            4 * xi * (1 - xi) * x[2][c];
    return result;
  }


  Vector2 OutlinePiece::tangent(const double xi) const
  {
    const Vector2 t = (4 * xi - 1) * (x[1] - x[2]) + (3 - 4 * xi) * (x[2] - x[0]);
    const double  n = t.norm();
    return n > 0 ? t / n : (x[1] - x[0]) / x[0].distance(x[1]);
  }


  double OutlinePiece::parameter(const double arc_length) const
  {
    if (arc_length <= 0)
      return 0;
    if (arc_length >= length())
      return 1;
    const unsigned int i = std::upper_bound(arc.begin(), arc.end(), arc_length) - arc.begin();
    return (i - 1 + (arc_length - arc[i - 1]) / (arc[i] - arc[i - 1])) / 16;
  }


  Outline::Outline(const Snapshot &snapshot, const scene::Scene &scene, const double time)
      : scene(scene)
  {
    for (const scene::Tool &tool : scene.tools)
      shift.push_back(tool.motion.displacement(time));

    std::map<double, unsigned int> edge_from;
    for (unsigned int e = 0; e < snapshot.edges.size(); ++e)
      edge_from[snapshot.edges[e].vertex[0]] = e;
    std::vector<bool> used(snapshot.edges.size(), false);
    for (unsigned int first = 0; first < snapshot.edges.size(); ++first)
      {
        Loop loop;
        for (unsigned int e = first; !used[e];)
          {
            used[e] = true;
            add_pieces(snapshot.edges[e], loop);
            const auto next = edge_from.find(snapshot.edges[e].vertex[1]);
            if (next == edge_from.end())
              throw ComputationError("the outline of the workpiece is not closed");
            e = next->second;
          }
        if (!loop.empty())
          loops.push_back(loop);
      }
  }


  unsigned int Outline::close_pockets(const double width)
  {
    const auto is_free = [](const OutlinePiece &piece) {
      return piece.tool < 0 && piece.id == surface_id;
    };
    unsigned int n_closed = 0;
    for (Loop &loop : loops)
      {
        // Begin with a piece that does not lie within free surface.
        const auto begin = std::find_if_not(loop.begin(), loop.end(), is_free);
        if (begin == loop.end())
          continue;
        std::rotate(loop.begin(), begin, loop.end());
        Loop closed;
        for (unsigned int p = 0; p < loop.size();)
          {
            unsigned int end = p;
            while (end < loop.size() && is_free(loop[end]))
              ++end;
            if (end == p)
              {
                closed.push_back(loop[p++]);
                continue;
              }
            const OutlinePiece &before = loop[p - 1], &after = loop[end % loop.size()];
            const Point         a = loop[p].x[0], b = loop[end - 1].x[1];
            double              area = 0; // between the surface and the chord
            for (unsigned int q = p; q < end; ++q)
              for (unsigned int i = 0; i < 16; ++i)
                {
                  const Vector2 u = loop[q].position(i / 16.) - a,
                                v = loop[q].position((i + 1) / 16.) - a;
                  area += 0.5 * (u[0] * v[1] - u[1] * v[0]);
                }
            const int  tool   = before.tool;
            const bool pocket = tool >= 0 && after.tool == tool && a.distance(b) < width &&
                                std::abs(area) < 0.1 * width * width;
            if (!pocket)
              closed.insert(closed.end(), loop.begin() + p, loop.begin() + end);
            else
              {
                OutlinePiece piece = loop[p];
                piece.tool         = tool;
                piece.x            = { { a, b, on_tool(tool, a + 0.5 * (b - a)) } };
                piece.node[0]      = before.node[1];
                piece.node[1]      = after.node[0];
                piece.node[2]      = blend(piece.node[0], piece.node[1], 0.5, tool);
                measure_arc(piece);
                closed.push_back(piece);
                ++n_closed;
              }
            p = end;
          }
        loop = closed;
      }
    return n_closed;
  }


  unsigned int Outline::cut_curls(const double width)
  {
    constexpr unsigned int n     = 4; // places looked at on a piece
    constexpr double       ratio = 2; // of the way to the chord
    struct Place
    {
      unsigned int piece, quarter;
      Point        x;
      double       s;
    };
    unsigned int n_cut = 0;
    for (Loop &loop : loops)
      for (bool again = true; again && n_cut < 50;)
        {
          again              = false;
          const auto is_free = [&](const unsigned int p) {
            return loop[p].tool < 0 && loop[p].id == surface_id;
          };
          std::vector<Place> run;
          double             longest = 0;
          Place              from{}, to{};
          const auto         look = [&] {
            for (unsigned int i = 0; i < run.size(); ++i)
              for (unsigned int j = i + 2; j < run.size() && run[j].s - run[i].s < 4 * width; ++j)
                if (const double way = run[j].s - run[i].s;
                    way > longest && run[i].x.distance(run[j].x) < way / ratio)
                  {
                    longest = way;
                    from    = run[i];
                    to      = run[j];
                  }
          };
          double s = 0;
          for (unsigned int p = 0; p < loop.size(); ++p)
            {
              if (!is_free(p))
                {
                  look();
                  run.clear();
                  continue;
                }
              for (unsigned int i = run.empty() ? 0 : 1; i <= n; ++i)
                run.push_back(
                    { p, i, loop[p].position(i / double(n)), s + loop[p].arc[i * 16 / n] });
              s += loop[p].length();
            }
          look();
          if (longest == 0)
            continue;
          Loop cut(loop.begin(), loop.begin() + from.piece);
          if (from.quarter > 0)
            cut.push_back(part(loop[from.piece], 0, from.quarter / double(n)));
          OutlinePiece line = loop[from.piece];
          line.node         = { { from.quarter == 0 ? loop[from.piece].node[0] : without_contact(),
                          to.quarter == n ? loop[to.piece].node[1] : without_contact(),
                                  without_contact() } };
          line.x            = { { from.x, to.x, from.x + 0.5 * (to.x - from.x) } };
          measure_arc(line);
          if (line.length() > 1e-6 * width)
            cut.push_back(line);
          else if (!cut.empty() && to.quarter == n && to.piece + 1 < loop.size())
            cut.back().x[1] = loop[to.piece + 1].x[0];
          if (to.quarter < n)
            cut.push_back(part(loop[to.piece], to.quarter / double(n), 1));
          cut.insert(cut.end(), loop.begin() + to.piece + 1, loop.end());
          loop = cut;
          ++n_cut;
          again = true;
        }
    return n_cut;
  }


  void Outline::fair(NewLoop &loop) const
  {
    // x - (x[-2] - 4 x[-1] + 6 x - 4 x[+1] + x[+2]) / 16 takes waves of two edges away and leaves
    // parabolas as they are.
    const unsigned int n = loop.vertices.size();
    const auto node      = [&](const unsigned int k) -> NewNode      &{ return loop.vertices[k % n]; };
    std::vector<double> turn(n);
    for (unsigned int k = 0; k < n; ++k)
      {
        const Vector2 a = node(k).position - node(k + n - 1).position,
                      b = node(k + 1).position - node(k).position;
        turn[k]         = std::atan2(a[0] * b[1] - a[1] * b[0], a * b);
      }
    std::vector<bool> moves(n);
    for (unsigned int k = 0; k < n; ++k)
      {
        moves[k] = true;
        for (unsigned int i = k + n - 2; i < k + n + 2; ++i)
          moves[k] = moves[k] && loop.ids[i % n] == surface_id;
        for (unsigned int i = k + n - 1; i <= k + n + 1; ++i)
          moves[k] = moves[k] && node(i).carried.tool[0] < 0;
        // Sharp corners, which stand at even vertices, are no waves.
        for (unsigned int i = k + n - 2; i <= k + n + 2; ++i)
          moves[k] = moves[k] && (i % 2 == 1 || std::abs(turn[i % n]) < sharpest_wave);
      }
    for (unsigned int pass = 0; pass < 3; ++pass)
      {
        std::vector<Vector2> change(n);
        for (unsigned int k = 0; k < n; ++k)
          if (moves[k])
            for (unsigned int c = 0; c < 2; ++c)
              change[k][c] = -(node(k + n - 2).position[c] - 4 * node(k + n - 1).position[c] +
                               6 * node(k).position[c] - 4 * node(k + 1).position[c] +
                               node(k + 2).position[c]) /
                             16;
        for (unsigned int k = 0; k < n; ++k)
          if (moves[k])
            {
              std::array<tools::Contact, 2> found;
              const Point                   x           = node(k).position + change[k];
              bool                          inside_tool = false;
              for (unsigned int i = 0; i < scene.tools.size(); ++i)
                inside_tool = inside_tool ||
                              (scene.tools[i].profile.find(Point(x - shift[i]), 0, found) > 0 &&
                               found[0].gap < 0);
              if (inside_tool)
                continue;
              node(k).position = x;
              // The middles beside it follow by half.
              loop.middles[k % n].position += 0.5 * change[k];
              loop.middles[(k + n - 1) % n].position += 0.5 * change[k];
            }
      }
  }


  double Outline::area() const
  {
    double area = 0;
    for (const Loop &loop : loops)
      for (const OutlinePiece &piece : loop)
        for (unsigned int i = 0; i < 16; ++i)
          {
            const Point a = piece.position(i / 16.), b = piece.position((i + 1) / 16.);
            area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
          }
    return area;
  }


  std::vector<std::vector<Outline::Sample>> Outline::sample(const double spacing) const
  {
    std::vector<std::vector<Sample>> result;
    for (const Loop &loop : loops)
      {
        result.emplace_back();
        for (const OutlinePiece &piece : loop)
          {
            const unsigned int n =
                std::max(1u, static_cast<unsigned int>(std::ceil(piece.length() / spacing)));
            for (unsigned int i = 0; i < n; ++i)
              {
                const double  xi = piece.parameter(i * piece.length() / n);
                const Vector2 t  = piece.tangent(xi);
                result.back().push_back({ piece.position(xi), Vector2({ -t[1], t[0] }), piece.id,
                                          straight(piece.id) ? -1 : piece.tool });
              }
          }
      }
    return result;
  }


  std::vector<Point> Outline::contact_ends() const
  {
    std::vector<Point> ends;
    for (const Loop &loop : loops)
      for (unsigned int p = 0; p < loop.size(); ++p)
        {
          const OutlinePiece &piece = loop[p], &before = loop[(p + loop.size() - 1) % loop.size()];
          if ((piece.tool < 0) != (before.tool < 0) && !straight(piece.id) && !straight(before.id))
            ends.push_back(piece.x[0]);
        }
    return ends;
  }


  Point Outline::on_tool(const int tool, const Point &x) const
  {
    std::array<tools::Contact, 2> found;
    if (scene.tools[tool].profile.find(Point(x - shift[tool]), std::numeric_limits<double>::max(),
                                       found) == 0)
      return x;
    return found[0].closest + shift[tool];
  }


  void Outline::add_tool_corners(const Loop                &loop,
                                 const std::vector<double> &start,
                                 const SizeField           &field,
                                 std::vector<Corner>       &found) const
  {
    constexpr unsigned int n = 16; // places looked at on a piece
    for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
      for (const tools::Profile::Corner &corner : scene.tools[tool].profile.corners())
        {
          const Point  x     = corner.place + shift[tool];
          const double h     = field.at(x);
          double       least = (corner.turn < 0 ? 0.3 : 0.1) * h;
          double       s     = -1;
          for (unsigned int p = 0; p < loop.size(); ++p)
            {
              const OutlinePiece &piece = loop[p];
              if (straight(piece.id) || held(piece.id) || piece.tool != static_cast<int>(tool) ||
                  piece.x[0].distance(x) > piece.length() + least)
                continue;
              for (unsigned int i = 0; i <= n; ++i)
                if (const double d = piece.position(i / double(n)).distance(x); d < least)
                  {
                    least = d;
                    s     = start[p] + piece.arc[i * 16 / n];
                  }
            }
          if (s >= 0)
            found.push_back({ s, false, std::abs(corner.turn) > corner_angle, true, x });
        }
  }


  std::vector<Outline::Corner> Outline::corners(const Loop &loop, const SizeField &field) const
  {
    struct Candidate
    {
      Corner corner;
      double rank, least;
    };
    std::vector<Candidate> candidates;
    std::vector<double>    start(1, 0.);
    for (unsigned int p = 0; p < loop.size(); ++p)
      {
        const OutlinePiece &piece = loop[p], &before = loop[(p + loop.size() - 1) % loop.size()];
        const double        turn = angle_between(before.tangent(1), piece.tangent(0));
        const bool          hard = turn > corner_angle;
        const double        s = start.back(), h = field.at(piece.x[0]);
        if (piece.id != before.id || (piece.node[0].tool[0] >= 0 && piece.node[0].tool[1] >= 0))
          candidates.push_back({ { s, true, hard, false, {} }, 1e3, 0 });
        else if (turn > sharp_angle)
          candidates.push_back({ { s, false, hard, false, {} }, 2e2, 0.3 * h });
        else if (piece.tool != before.tool)
          candidates.push_back({ { s, false, hard, false, {} }, 1e2, h });
        else if (hard)
          candidates.push_back({ { s, false, hard, false, {} }, turn, 1.5 * h });
        start.push_back(s + piece.length());
      }
    std::vector<Corner> of_tools;
    add_tool_corners(loop, start, field, of_tools);
    for (const Corner &corner : of_tools)
      candidates.push_back({ corner, 5e2, 0.3 * field.at(corner.place) });
    const double whole = start.back();
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate &a, const Candidate &b) { return a.rank > b.rank; });

    std::vector<Corner> accepted;
    for (const auto &[corner, rank, least] : candidates)
      {
        bool clear = true;
        for (const Corner &other : accepted)
          {
            const double distance = std::abs(other.s - corner.s);
            clear                 = clear && std::min(distance, whole - distance) >= least;
          }
        if (clear)
          accepted.push_back(corner);
      }
    if (accepted.empty())
      accepted.push_back({ 0, false, true, false, {} });
    std::sort(accepted.begin(), accepted.end(),
              [](const Corner &a, const Corner &b) { return a.s < b.s; });
    // A hard corner comes first: it is at vertex 0.
    auto first = std::find_if(accepted.begin(), accepted.end(),
                              [](const Corner &corner) { return corner.hard; });
    if (first == accepted.end())
      {
        first       = accepted.begin();
        first->hard = true;
      }
    std::rotate(accepted.begin(), first, accepted.end());
    return accepted;
  }


  NewNode Outline::new_node(const Loop &loop, const Place &place, const bool keep) const
  {
    const OutlinePiece &piece = loop[place.piece];
    NewNode             node;
    node.position = piece.position(place.xi);
    node.carried  = without_contact();
    if (piece.id == axis_id)
      node.position[0] = 0;
    if (keep)
      {
        // The old node itself; of the two pieces that meet there, what the one knows that touches.
        const OutlinePiece &before = loop[(place.piece + loop.size() - 1) % loop.size()];
        if (before.id == axis_id)
          node.position[0] = 0;
        node.carried =
            piece.node[0].tool[0] >= 0 && !straight(piece.id) ? piece.node[0] : before.node[1];
        return node;
      }
    if (straight(piece.id))
      return node;

    int                           tool   = piece.tool;
    const Point                   before = node.position;
    std::array<tools::Contact, 2> found;
    if (tool < 0)
      // Open surface that passes through a tool between two nodes is caught here.
      for (unsigned int i = 0; i < scene.tools.size(); ++i)
        if (scene.tools[i].profile.find(Point(before - shift[i]), 0, found) > 0 &&
            found[0].gap < -inside * scene.size && tool < 0)
          tool = i;
    if (tool < 0)
      return node;
    if (const Point x = on_tool(tool, before);
        x.distance(before) < std::max(0.5 * piece.length(), 0.01 * scene.size))
      node.position = x;
    if (piece.tool >= 0)
      node.carried = place.xi < 0.5 ? blend(piece.node[0], piece.node[2], 2 * place.xi, tool)
                                    : blend(piece.node[2], piece.node[1], 2 * place.xi - 1, tool);
    else
      node.carried.tool[0] = tool;
    return node;
  }


  NewNode Outline::middle_node(const Loop  &loop,
                               const Place &place,
                               const Point &from,
                               const Point &to) const
  {
    NewNode       node   = new_node(loop, place, false);
    const Vector2 chord  = to - from;
    const double  length = chord.norm();
    // Where its ends were put on a tool the place may no longer be the middle between them.
    const Vector2 along = (node.position - from) * chord / (length * length) * chord - 0.5 * chord;
    if (along.norm() > 0.05 * length)
      {
        node.position -= along;
        if (node.carried.tool[0] >= 0)
          if (const Point x = on_tool(static_cast<int>(node.carried.tool[0]), node.position);
              x.distance(node.position) < 0.5 * length)
            node.position = x;
      }
    return node;
  }


  std::vector<NewLoop> Outline::divide(SizeField &field) const
  {
    std::vector<NewLoop> result;
    for (const Loop &loop : loops)
      {
        std::vector<double> start(loop.size() + 1, 0);
        for (unsigned int p = 0; p < loop.size(); ++p)
          start[p + 1] = start[p] + loop[p].length();
        const std::vector<Corner> corner = corners(loop, field);

        const auto place_of = [&](double s) {
          s                    = s >= start.back() ? s - start.back() : s;
          const unsigned int p = std::min<std::size_t>(
              std::upper_bound(start.begin(), start.end(), s) - start.begin() - 1, loop.size() - 1);
          return Place{ p, loop[p].parameter(s - start[p]) };
        };
        const auto point_at = [&](const double s) {
          const Place place = place_of(s);
          return loop[place.piece].position(place.xi);
        };
        const auto end_of = [&](const unsigned int k) {
          const double s = corner[(k + 1) % corner.size()].s;
          return s > corner[k].s ? s : s + start.back();
        };
        const auto is_odd = [&](const unsigned int k) {
          return corner[k].hard != corner[(k + 1) % corner.size()].hard;
        };
        for (unsigned int k = 0; k < corner.size(); ++k)
          {
            const double length = end_of(k) - corner[k].s;
            const Point  middle = point_at(corner[k].s + 0.5 * length);
            if (length < field.at(middle))
              field.demand(middle, length / (is_odd(k) ? 1 : 2));
          }

        NewLoop             made;
        std::vector<double> arc;     // of vertices and middles, in turn
        std::vector<Place>  middles; // and the places of the middles
        for (unsigned int k = 0; k < corner.size(); ++k)
          {
            const double length   = end_of(k) - corner[k].s;
            double       shortest = length;
            for (unsigned int i = 0; i <= 16; ++i)
              shortest = std::min(shortest, field.at(point_at(corner[k].s + i * length / 16)));
            std::vector<double> count(1, 0.); // of edges up to each sample
            const unsigned int  samples =
                16 * static_cast<unsigned int>(std::ceil(length / shortest));
            for (unsigned int i = 0; i < samples; ++i)
              count.push_back(count.back() +
                              length / samples /
                                  field.at(point_at(corner[k].s + (i + 0.5) * length / samples)));
            // Hard corners are at even vertices, the others at odd ones. A loop of one part needs
            // four edges, so that no pair ends where it begins.
            const unsigned int n =
                is_odd(k) ? 2 * std::max<long>(0, std::lround(0.5 * (count.back() - 1))) + 1
                          : 2 * std::max<long>(corner.size() == 1 ? 2 : 1,
                                               std::lround(0.5 * count.back()));
            const auto place_after = [&](const double edges) {
              const double       wanted = edges * count.back() / n;
              const unsigned int i      = std::clamp<int>(
                  std::upper_bound(count.begin(), count.end(), wanted) - count.begin() - 1, 0,
                  samples - 1);
              return corner[k].s +
                     length * (i + (wanted - count[i]) / (count[i + 1] - count[i])) / samples;
            };
            for (unsigned int i = 0; i < n; ++i)
              {
                const double s      = i == 0 ? corner[k].s : place_after(i);
                const double middle = 0.5 * (s + place_after(i + 1));
                made.vertices.push_back(new_node(loop, place_of(s), i == 0 && corner[k].keep));
                if (i == 0 && corner[k].snap)
                  {
                    // A concave corner has both flanks as its surfaces.
                    made.vertices.back().position = corner[k].place;
                  }
                middles.push_back(place_of(middle));
                made.ids.push_back(loop[middles.back().piece].id);
                arc.push_back(s);
                arc.push_back(middle);
              }
          }
        for (unsigned int k = 0; k < middles.size(); ++k)
          made.middles.push_back(middle_node(loop, middles[k], made.vertices[k].position,
                                             made.vertices[(k + 1) % middles.size()].position));
        // What could not be put on its tool does not touch it: the first step would pull it there.
        for (std::vector<NewNode> *nodes : { &made.vertices, &made.middles })
          for (NewNode &node : *nodes)
            if (node.carried.tool[0] >= 0 && node.carried.tool[1] < 0 &&
                on_tool(static_cast<int>(node.carried.tool[0]), node.position)
                        .distance(node.position) > 1e-5 * scene.size)
              node.carried = without_contact();
        fair(made);
        set_directions(loop, arc, field, made);
        result.push_back(made);
      }
    return result;
  }


  void Outline::set_directions(const Loop                &loop,
                               const std::vector<double> &arc,
                               const SizeField           &field,
                               NewLoop                   &result) const
  {
    double whole = 0;
    for (const OutlinePiece &piece : loop)
      whole += piece.length();
    const unsigned int n       = result.vertices.size();
    const auto         node_at = [&](const unsigned int k) -> NewNode         &{
      const unsigned int i = k % (2 * n);
      return i % 2 == 0 ? result.vertices[i / 2] : result.middles[i / 2];
    };
    const auto id_before = [&](const unsigned int k) {
      return result.ids[(k / 2 + n - (k % 2 == 0)) % n];
    };
    const auto id_after = [&](const unsigned int k) { return result.ids[k / 2]; };

    // Places that hold the surface back: it moves the more the farther it is from them.
    std::vector<double> holds;
    for (unsigned int k = 0; k < 2 * n; ++k)
      if (node_at(k).carried.tool[0] >= 0 || held(id_before(k)) || held(id_after(k)))
        holds.push_back(arc[k]);

    for (unsigned int k = 0; k < 2 * n; ++k)
      {
        NewNode   &node   = node_at(k);
        const auto before = id_before(k), after = id_after(k);
        const bool free_before = before == surface_id, free_after = after == surface_id;
        node.direction = Vector2();
        if (!free_before && !free_after)
          continue;
        double distance = std::numeric_limits<double>::max();
        for (const double s : holds)
          {
            const double d = std::abs(s - arc[k]);
            distance       = std::min({ distance, d, whole - d });
          }
        const double  weight = std::min(1., distance / (2 * field.at(node.position)));
        const Point   x      = node.position;
        const Vector2 along  = (free_after ? node_at(k + 1).position : x) -
                              (free_before ? node_at(k + 2 * n - 1).position : x);
        const Vector2 normal = Vector2({ along[1], -along[0] }) / along.norm();
        if (free_before && free_after)
          {
            node.direction = weight * normal;
            continue;
          }
        // The end of the axis or of the symmetry line moves along that line.
        const Vector2 line = node_at(free_before ? k + 2 : k + 2 * n - 2).position - x;
        Vector2       unit = line / line.norm();
        for (unsigned int c = 0; c < 2; ++c)
          if (std::abs(unit[c]) < 1e-12)
            unit[c] = 0;
        const double projection = unit * normal;
        if (std::abs(projection) > 0.3)
          node.direction = weight / projection * unit;
      }
  }


  double Outline::penetration(const State &state, const scene::Scene &scene)
  {
    double largest = 0;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (!edge.owned || straight(edge.id))
          continue;
        bool touches_any = false;
        for (const unsigned int b : edge.boundary_nodes)
          touches_any |= state.contacts[b].active();
        if (!touches_any)
          continue;
        OutlinePiece piece;
        for (unsigned int a = 0; a < 3; ++a)
          piece.x[a] = state.node_position(edge.nodes[a]);
        const double length = piece.x[0].distance(piece.x[2]) + piece.x[2].distance(piece.x[1]);
        for (const double xi : { 0.2, 0.4, 0.6, 0.8 })
          for (const scene::Tool &tool : scene.tools)
            {
              std::array<tools::Contact, 2> found;
              if (tool.profile.find(
                      Point(piece.position(xi) - tool.motion.displacement(state.time)), 0, found) >
                  0)
                largest = std::max(largest, -found[0].gap / length);
            }
      }
    return dealii::Utilities::MPI::max(largest, state.communicator);
  }
} // namespace axiforge::meshing
