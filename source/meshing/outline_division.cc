// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <axiforge/base/tolerances.h>
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


    bool held(const dealii::types::boundary_id id)
    {
      return id != surface_id && id != axis_id && id != symmetry_id;
    }


    double angle_between(const Vector2 &a, const Vector2 &b)
    {
      return std::abs(std::atan2(a[0] * b[1] - a[1] * b[0], a * b));
    }
  } // namespace


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
              if (is_straight(piece.id) || held(piece.id) || piece.tool != static_cast<int>(tool) ||
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
            piece.node[0].tool[0] >= 0 && !is_straight(piece.id) ? piece.node[0] : before.node[1];
        return node;
      }
    if (is_straight(piece.id))
      return node;

    int                           tool   = piece.tool;
    const Point                   before = node.position;
    std::array<tools::Contact, 2> found;
    if (tool < 0)
      // Open surface that passes through a tool between two nodes is caught here.
      for (unsigned int i = 0; i < scene.tools.size(); ++i)
        if (scene.tools[i].profile.find(Point(before - shift[i]), 0, found) > 0 &&
            found[0].gap < -tolerance::same_place * scene.size && tool < 0)
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

    // Places that hold the surface back: it moves the more the farther it is from them, and from
    // the tools that it does not touch: what were pushed into one would be caught in the next step.
    const auto clearance = [&](const Point &x, const double most) {
      double least = most;
      for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
        {
          std::array<tools::Contact, 2> found;
          if (scene.tools[tool].profile.find(Point(x - shift[tool]), most, found) > 0)
            least = std::min(least, std::max(0., found[0].gap));
        }
      return least;
    };
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
        const Point   x      = node.position;
        const double  far    = 2 * field.at(x);
        const double  weight = std::min(distance, clearance(x, far)) / far;
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
} // namespace axiforge::meshing
