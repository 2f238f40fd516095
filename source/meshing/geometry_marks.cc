// SPDX-License-Identifier: GPL-2.0-or-later
#include <limits>

#include <axiforge/meshing/geometry_marks.h>

namespace axiforge::meshing
{
  namespace
  {
    using Cell = dealii::parallel::distributed::Triangulation<2>::active_cell_iterator;

    /// What a wish for smaller cells has to say about one that is small enough, and about its
    /// family.
    struct Wish
    {
      bool divide = false; ///< the cell
      bool keep   = false; ///< joined with the others it would be too large
    };

    Wish operator|(const Wish &a, const Wish &b)
    {
      return { a.divide || b.divide, a.keep || b.keep };
    }


    /// The errors of an edge fall with the third power of its length at least.
    constexpr double error_of_joined_edge = 8;


    struct Edge
    {
      std::array<Point, 3>        x; ///< end, end, middle [mm]
      std::array<unsigned int, 3> tool;
      double                      length;
    };

    Edge edge_at(const State &state, const BoundaryEdge &boundary)
    {
      Edge edge;
      for (unsigned int a = 0; a < 3; ++a)
        {
          edge.x[a]    = state.node_position(boundary.nodes[a]);
          edge.tool[a] = state.contacts[boundary.boundary_nodes[a]].tool[0];
        }
      edge.length = edge.x[2].distance(edge.x[0]) + edge.x[2].distance(edge.x[1]);
      return edge;
    }


    /// How far the edge is off the profiles between its nodes [mm]: by the gap where both nodes
    /// beside the place touch, by the penetration elsewhere.
    double chord_error(const scene::Scene &scene, const double time, const Edge &edge)
    {
      double largest = 0;
      for (unsigned int half = 0; half < 2; ++half)
        {
          const Point middle(0.375 * edge.x[half] + 0.75 * edge.x[2] - 0.125 * edge.x[1 - half]);
          for (unsigned int t = 0; t < scene.tools.size(); ++t)
            {
              const bool                    touches = edge.tool[half] == t && edge.tool[2] == t;
              std::array<tools::Contact, 2> found;
              const Point                   x(middle - scene.tools[t].motion.displacement(time));
              if (scene.tools[t].profile.find(x, touches ? edge.length : 0, found) > 0)
                largest = std::max(largest, touches ? std::abs(found[0].gap) : -found[0].gap);
            }
        }
      return largest;
    }


    /// Largest curvature of the tools along the edge, touching or about to [1/mm]. The places are
    /// so close together that no fillet with a radius of a quarter of the edge is missed.
    double tool_curvature(const scene::Scene &scene, const double time, const Edge &edge)
    {
      constexpr unsigned int n_places = 16;
      double                 largest  = 0;
      for (const scene::Tool &tool : scene.tools)
        for (unsigned int place = 0; place <= n_places; ++place)
          {
            const double s = static_cast<double>(place) / n_places;
            const Point  x((1 - s) * (1 - 2 * s) * edge.x[0] + s * (2 * s - 1) * edge.x[1] +
                           4 * s * (1 - s) * edge.x[2]);
            std::array<tools::Contact, 2> found;
            const unsigned int n = tool.profile.find(Point(x - tool.motion.displacement(time)),
                                                     0.5 * edge.length, found);
            for (unsigned int i = 0; i < n; ++i)
              largest = std::max(largest, std::abs(found[i].curvature));
          }
      return largest;
    }


    Wish surface_wish(const scene::Scene &scene, const State &state, const BoundaryEdge &boundary)
    {
      const scene::RefinementParameters &limits = scene.refinement;
      Wish                               wish;
      if (!state.tables.boundary_nodes[boundary.boundary_nodes[2]].free_surface)
        return wish;
      const Edge edge = edge_at(state, boundary);
      if (const double allowed = limits.largest_chord_error * edge.length; allowed > 0)
        {
          const double error = chord_error(scene, state.time, edge);
          wish = wish | Wish{ error > allowed, error > allowed / error_of_joined_edge };
        }
      if (limits.edges_per_quarter > 0)
        if (const double curvature = tool_curvature(scene, state.time, edge); curvature > 0)
          {
            const double longest = 0.5 * M_PI / (curvature * limits.edges_per_quarter);
            wish                 = wish | Wish{ edge.length > longest, 2 * edge.length > longest };
          }
      return wish;
    }


    Wish region_wish(const scene::Region &region,
                     const scene::Scene  &scene,
                     const State         &state,
                     const unsigned int   row,
                     const int            level)
    {
      const auto   &nodes = state.tables.cells[row];
      const Vector2 shift = region.tool == no_tool
                                ? Vector2()
                                : scene.tools[region.tool].motion.displacement(state.time);
      for (unsigned int c = 0; c < 2; ++c)
        {
          double low = 1e300, high = -1e300;
          for (const unsigned int node : nodes)
            {
              const double x = state.node_position(node)[c] - shift[c];
              low            = std::min(low, x);
              high           = std::max(high, x);
            }
          if (high <= region.lower[c] || low >= region.upper[c])
            return {};
        }
      Wish      wish;
      const int wanted = region.level;
      if (wanted > 0)
        wish = { level < wanted, level <= wanted };
      if (region.element_size > 0)
        {
          double                 side        = 0;
          constexpr unsigned int sides[4][2] = { { 0, 2 }, { 1, 3 }, { 0, 1 }, { 2, 3 } };
          for (const auto &ends : sides)
            side = std::max(
                side,
                state.node_position(nodes[ends[0]]).distance(state.node_position(nodes[ends[1]])));
          wish = wish | Wish{ side > region.element_size * (1 + 1e-9),
                              2 * side > region.element_size * (1 + 1e-9) };
        }
      return wish;
    }
  } // namespace


  double shorter_diagonal(const State &state, const unsigned int row)
  {
    const auto &nodes = state.tables.cells[row];
    return std::min(state.node_position(nodes[0]).distance(state.node_position(nodes[3])),
                    state.node_position(nodes[1]).distance(state.node_position(nodes[2])));
  }


  void mark_by_geometry(const scene::Scene &scene, State &state)
  {
    constexpr int                      deepest = 20; // of any cell; p4est has 29
    const scene::RefinementParameters &limits  = scene.refinement;
    std::vector<Wish>                  surface(state.tables.cells.size());
    for (const BoundaryEdge &edge : state.tables.edges)
      if (edge.owned && !scene.tools.empty())
        surface[edge.cell] = surface[edge.cell] | surface_wish(scene, state, edge);

    const bool is_full = state.tables.n_global_cells >= limits.most_cells;
    for (unsigned int row = 0; row < state.tables.cells.size(); ++row)
      {
        const Cell cell = state.triangulation.create_cell_iterator(state.tables.cell_ids[row]);
        Wish       region;
        for (const scene::Region &box : scene.regions)
          region = region | region_wish(box, scene, state, row, cell->level());
        if (surface[row].keep || region.keep)
          cell->clear_coarsen_flag();
        const bool wanted =
            region.divide ||
            (surface[row].divide && cell->level() < static_cast<int>(limits.largest_level));
        if (wanted && !is_full && cell->level() < deepest &&
            shorter_diagonal(state, row) >= 2 * limits.smallest_size)
          {
            cell->clear_coarsen_flag();
            cell->set_refine_flag();
          }
      }
  }
} // namespace axiforge::meshing
