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

    /// Of the length of the edges with the way from an end of contact.
    constexpr double growth = 0.3;

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


  std::vector<Outline::Corner> Outline::corners(const Loop &loop, const double edge_length) const
  {
    struct Candidate
    {
      Corner corner;
      double rank;
    };
    std::vector<Candidate> candidates;
    double                 s = 0;
    for (unsigned int p = 0; p < loop.size(); ++p)
      {
        const OutlinePiece &piece = loop[p], &before = loop[(p + loop.size() - 1) % loop.size()];
        const double        turn = angle_between(before.tangent(1), piece.tangent(0));
        const bool          hard = turn > corner_angle;
        if (piece.id != before.id || (piece.node[0].tool[0] >= 0 && piece.node[0].tool[1] >= 0))
          candidates.push_back({ { s, true, hard }, 1e3 });
        else if (piece.tool != before.tool)
          candidates.push_back({ { s, false, hard }, 1e2 });
        else if (hard)
          candidates.push_back({ { s, false, hard }, turn });
        s += piece.length();
      }
    const double whole = s;
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate &a, const Candidate &b) { return a.rank > b.rank; });

    std::vector<Corner> accepted;
    for (const auto &[corner, rank] : candidates)
      {
        const double least = corner.keep ? 0 : (rank > 10 ? 1 : 1.5) * edge_length;
        bool         clear = true;
        for (const Corner &other : accepted)
          {
            const double distance = std::abs(other.s - corner.s);
            clear                 = clear && std::min(distance, whole - distance) >= least;
          }
        if (clear)
          accepted.push_back(corner);
      }
    if (accepted.empty())
      accepted.push_back({ 0, false, true });
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
    const double                  far    = std::numeric_limits<double>::max();
    std::array<tools::Contact, 2> found;
    if (tool < 0)
      // Open surface that passes through a tool between two nodes is caught here.
      for (unsigned int i = 0; i < scene.tools.size(); ++i)
        if (scene.tools[i].profile.find(Point(before - shift[i]), 0, found) > 0 &&
            found[0].gap < -inside * scene.size && tool < 0)
          tool = i;
    if (tool < 0)
      return node;
    if (scene.tools[tool].profile.find(Point(before - shift[tool]), far, found) > 0)
      {
        const Point on_tool = found[0].closest + shift[tool];
        if (on_tool.distance(before) < 0.5 * piece.length())
          node.position = on_tool;
      }
    if (piece.tool >= 0)
      node.carried = place.xi < 0.5 ? blend(piece.node[0], piece.node[2], 2 * place.xi, tool)
                                    : blend(piece.node[2], piece.node[1], 2 * place.xi - 1, tool);
    else
      node.carried.tool[0] = tool;
    return node;
  }


  std::vector<double> Outline::contact_ends(const Loop &loop, const std::vector<double> &start)
  {
    std::vector<double> ends;
    for (unsigned int p = 0; p < loop.size(); ++p)
      {
        const OutlinePiece &piece = loop[p], &before = loop[(p + loop.size() - 1) % loop.size()];
        if (piece.tool != before.tool && !straight(piece.id) && !straight(before.id))
          ends.push_back(start[p]);
      }
    return ends;
  }


  std::vector<NewLoop> Outline::divide(const double edge_length, const double refinement) const
  {
    std::vector<NewLoop> result;
    for (const Loop &loop : loops)
      {
        std::vector<double> start(loop.size() + 1, 0);
        for (unsigned int p = 0; p < loop.size(); ++p)
          start[p + 1] = start[p] + loop[p].length();
        const std::vector<Corner> corner = corners(loop, edge_length);

        const auto place_of = [&](double s) {
          s                    = s >= start.back() ? s - start.back() : s;
          const unsigned int p = std::min<std::size_t>(
              std::upper_bound(start.begin(), start.end(), s) - start.begin() - 1, loop.size() - 1);
          return Place{ p, loop[p].parameter(s - start[p]) };
        };

        // Number of edges from the first corner to a place, for edges that grow by 0.3 of the way
        // from an end of contact, where they are the shortest.
        const std::vector<double> ends      = contact_ends(loop, start);
        const auto                length_at = [&](const double s) {
          double way = std::numeric_limits<double>::max();
          for (const double end : ends)
            {
              const double d = std::abs(std::fmod(s, start.back()) - end);
              way            = std::min({ way, d, start.back() - d });
            }
          return std::min(edge_length, edge_length / refinement + growth * way);
        };

        NewLoop             made;
        std::vector<double> arc; // of vertices and middles, in turn
        for (unsigned int k = 0; k < corner.size(); ++k)
          {
            const Corner       &next   = corner[(k + 1) % corner.size()];
            const double        end    = next.s > corner[k].s ? next.s : next.s + start.back();
            const double        length = end - corner[k].s;
            std::vector<double> count(1, 0.); // of edges up to each sample
            const unsigned int  samples =
                16 * static_cast<unsigned int>(std::ceil(length * refinement / edge_length));
            for (unsigned int i = 0; i < samples; ++i)
              count.push_back(count.back() +
                              length / samples /
                                  length_at(corner[k].s + (i + 0.5) * length / samples));
            // Hard corners are at even vertices, the others at odd ones. A loop of one part needs
            // four edges, so that no pair ends where it begins.
            const bool         odd = corner[k].hard != next.hard;
            const unsigned int n =
                odd ? 2 * std::max<long>(0, std::lround(0.5 * (count.back() - 1))) + 1
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
                const Place place = place_of(middle);
                made.middles.push_back(new_node(loop, place, false));
                made.ids.push_back(loop[place.piece].id);
                arc.push_back(s);
                arc.push_back(middle);
              }
          }
        set_directions(loop, arc, made, edge_length);
        result.push_back(made);
      }
    return result;
  }


  void Outline::set_directions(const Loop                &loop,
                               const std::vector<double> &arc,
                               NewLoop                   &result,
                               const double               length) const
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
        const double  weight = std::min(1., distance / (2 * length));
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
