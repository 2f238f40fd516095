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
    /// A parabola turns back on itself if its middle is so far from that of the chord [chord].
    constexpr double turns_back = 0.25;


    bool touches(const SurfaceNode &node, const int tool)
    {
      return tool >= 0 && (node.tool[0] == tool || node.tool[1] == tool);
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


    /// Where the middle of an edge stands along its chord: 0 at the start, 1 at the end.
    double place_of_middle(const OutlinePiece &piece)
    {
      const Vector2 chord = piece.x[1] - piece.x[0];
      return (piece.x[2] - piece.x[0]) * chord / chord.norm_square();
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
      const int  tool     = is_straight(piece.id) ? -1 : static_cast<int>(edge.node[2].tool[0]);
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


  } // namespace


  SurfaceNode without_contact()
  {
    SurfaceNode node{};
    node.tool[0] = node.tool[1] = -1;
    return node;
  }


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


  bool is_straight(const dealii::types::boundary_id id)
  {
    return id == axis_id || id == symmetry_id;
  }


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
        for (OutlinePiece &piece : loop)
          if (piece.tool >= 0 && std::abs(place_of_middle(piece) - 0.5) > turns_back)
            {
              piece.x[2] = on_tool(piece.tool, piece.x[0] + 0.5 * (piece.x[1] - piece.x[0]));
              measure_arc(piece);
            }
        if (!loop.empty())
          loops.push_back(loop);
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
                                          is_straight(piece.id) ? -1 : piece.tool });
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
          if ((piece.tool < 0) != (before.tool < 0) && !is_straight(piece.id) &&
              !is_straight(before.id))
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


  double Outline::least_division(const State &state)
  {
    double least = 0.5;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (!edge.owned || is_straight(edge.id) || !state.contacts[edge.boundary_nodes[2]].active())
          continue;
        OutlinePiece piece;
        for (unsigned int a = 0; a < 3; ++a)
          piece.x[a] = state.node_position(edge.nodes[a]);
        least = std::min(least, 0.5 - std::abs(place_of_middle(piece) - 0.5));
      }
    return dealii::Utilities::MPI::min(least, state.communicator);
  }


  double Outline::penetration(const State &state, const scene::Scene &scene, const double time)
  {
    std::vector<Vector2> shift;
    for (const scene::Tool &tool : scene.tools)
      shift.push_back(tool.motion.displacement(time));
    double largest = 0;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (!edge.owned || is_straight(edge.id))
          continue;
        OutlinePiece piece;
        for (unsigned int a = 0; a < 3; ++a)
          piece.x[a] = state.node_position(edge.nodes[a]);
        const double length = piece.x[0].distance(piece.x[2]) + piece.x[2].distance(piece.x[1]);
        for (const double xi : { 0.2, 0.4, 0.6, 0.8 })
          for (unsigned int i = 0; i < shift.size(); ++i)
            {
              std::array<tools::Contact, 2> found;
              if (scene.tools[i].profile.find(Point(piece.position(xi) - shift[i]), 0, found) > 0)
                largest = std::max(largest, -found[0].gap / length);
            }
      }
    return dealii::Utilities::MPI::max(largest, state.communicator);
  }
} // namespace axiforge::meshing
