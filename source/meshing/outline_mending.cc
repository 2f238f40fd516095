// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <axiforge/meshing/outline.h>
#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  namespace
  {
    /// A turn of free surface above this is a corner to be kept [rad].
    constexpr double sharpest_wave = 1.;


    /// Twice the area to the left of a run of points that its chord closes; positive where the run
    /// goes round the body, as a tip does, negative where it goes round a notch.
    template <typename Place>
    double twice_area(const std::vector<Place> &run, const unsigned int i, const unsigned int j)
    {
      double area = 0;
      for (unsigned int k = i + 1; k < j; ++k)
        {
          const Vector2 u = run[k].x - run[i].x, v = run[k + 1].x - run[i].x;
          area += u[0] * v[1] - u[1] * v[0];
        }
      return area;
    }


    /// Whether the straight lines between the points of a run cross.
    template <typename Place>
    bool crosses_itself(const std::vector<Place> &run, const unsigned int i, const unsigned int j)
    {
      const auto left = [](const Point &a, const Point &b, const Point &c) {
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      };
      for (unsigned int k = i; k < j; ++k)
        for (unsigned int l = k + 2; l < j; ++l)
          {
            const Point &a = run[k].x, &b = run[k + 1].x, &c = run[l].x, &d = run[l + 1].x;
            if (left(a, b, c) * left(a, b, d) < 0 && left(c, d, a) * left(c, d, b) < 0)
              return true;
          }
      return false;
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
  } // namespace


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
    // A run with less area than this share of its way squared lies upon itself: a spike or a closed
    // slit. One with more is a tip or a groove, and is kept unless it crosses itself.
    constexpr double thin = 1e-3;
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
                    way > longest && run[i].x.distance(run[j].x) < way / ratio &&
                    (std::abs(twice_area(run, i, j)) < 2 * thin * way * way ||
                     crosses_itself(run, i, j)))
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
} // namespace axiforge::meshing
