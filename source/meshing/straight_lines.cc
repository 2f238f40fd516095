// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <axiforge/meshing/mesh_checks.h>
#include <axiforge/meshing/straight_lines.h>

namespace axiforge::meshing
{
  namespace
  {
    using Edge = std::pair<unsigned int, unsigned int>;

    /// The end vertices of the four edges of a cell and the index of their middle in cell_nodes.
    constexpr std::array<std::array<unsigned int, 3>, 4> edges_of_cell = {
      { { { 0, 2, 4 } }, { { 1, 3, 5 } }, { { 0, 1, 6 } }, { { 2, 3, 7 } } }
    };


    /// Calls an action with every node of the edges, as often as it stands in the mesh.
    template <typename Action>
    void for_nodes(const std::set<Edge> &edges, WorkpieceMesh &mesh, const Action &action)
    {
      std::set<unsigned int> ends;
      for (const auto &[a, b] : edges)
        ends.insert({ a, b });
      for (const unsigned int v : ends)
        action(mesh.vertices[v]);
      for (unsigned int cell = 0; cell < mesh.cells.size(); ++cell)
        {
          const auto &vertices = mesh.cells[cell];
          for (unsigned int v = 0; v < 4; ++v)
            if (ends.count(vertices[v]))
              action(mesh.cell_nodes[cell][v]);
          for (const auto &[a, b, middle] : edges_of_cell)
            if (edges.count(
                    { std::min(vertices[a], vertices[b]), std::max(vertices[a], vertices[b]) }))
              action(mesh.cell_nodes[cell][middle]);
        }
    }


    /// Edges that lie on one line of constant coordinate c.
    void put_on_line(const std::set<Edge> &edges, const unsigned int c, WorkpieceMesh &mesh)
    {
      const double size   = size_of_mesh(mesh);
      double       lowest = 1e300, highest = -1e300;
      for_nodes(edges, mesh, [&](const Point &x) {
        lowest  = std::min(lowest, x[c]);
        highest = std::max(highest, x[c]);
      });
      double value = 0.5 * (lowest + highest);
      if (std::max(std::abs(lowest), std::abs(highest)) <= line_tolerance * size)
        value = 0;
      const double farthest = std::max(std::abs(lowest - value), std::abs(highest - value));
      if (farthest == 0 || highest - lowest > 2 * line_tolerance * size)
        return;
      for_nodes(edges, mesh, [&](Point &x) { x[c] = value; });
      if (farthest > line_rounding * size)
        mesh.notes.push_back(
            fmt::format("the symmetry line is drawn up to {:.2g} mm off {} = {:.6g} "
                        "mm: it has been put there.",
                        farthest, c == 1 ? "z" : "r", value));
    }
  } // namespace


  void put_on_axis(WorkpieceMesh &mesh)
  {
    const double size     = size_of_mesh(mesh);
    double       farthest = 0;
    const auto   snap     = [&](Point &x) {
      if (std::abs(x[0]) <= line_tolerance * size)
        {
          farthest = std::max(farthest, std::abs(x[0]));
          x[0]     = 0;
        }
    };
    for (Point &x : mesh.vertices)
      snap(x);
    for (std::array<Point, 9> &nodes : mesh.cell_nodes)
      for (Point &x : nodes)
        snap(x);
    if (farthest > line_rounding * size)
      mesh.notes.push_back(fmt::format(
          "the axis of the workpiece is drawn up to {:.2g} mm off r = 0: it has been put there.",
          farthest));
  }


  void put_on_symmetry(const std::set<Edge> &edges, WorkpieceMesh &mesh)
  {
    const double tolerance = line_tolerance * size_of_mesh(mesh);
    for (const unsigned int c : { 0u, 1u })
      {
        std::vector<std::pair<double, Edge>> along; // by the value of the coordinate
        for (const Edge &edge : edges)
          {
            const Point a = mesh.vertices[edge.first], b = mesh.vertices[edge.second];
            if (std::abs(a[c] - b[c]) <= std::min(tolerance, 0.1 * a.distance(b)))
              along.emplace_back(0.5 * (a[c] + b[c]), edge);
          }
        std::sort(along.begin(), along.end());
        for (std::size_t i = 0, j = 0; i < along.size(); i = j)
          {
            std::set<Edge> line;
            for (; j < along.size() && along[j].first - along[i].first <= tolerance; ++j)
              line.insert(along[j].second);
            put_on_line(line, c, mesh);
          }
      }
  }
} // namespace axiforge::meshing
