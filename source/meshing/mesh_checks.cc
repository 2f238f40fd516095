// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include <deal.II/base/quadrature_lib.h>

#include <fmt/format.h>

#include <axiforge/meshing/mesh_checks.h>

namespace axiforge::meshing
{
  namespace
  {
    /// Values and derivatives of the three quadratic shape functions on [0, 1] with nodes 0,
    /// 1/2, 1.
    std::array<double, 3> values(const double x)
    {
      return { { (1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1) } };
    }

    std::array<double, 3> derivatives(const double x)
    {
      return { { 4 * x - 3, 4 - 8 * x, 4 * x - 1 } };
    }

    /// Position in the 3 x 3 grid (column, row) of the nodes in the order of FE_Q(2).
    constexpr std::array<std::array<unsigned int, 2>, 9> grid = { { { { 0, 0 } },
                                                                    { { 2, 0 } },
                                                                    { { 0, 2 } },
                                                                    { { 2, 2 } },
                                                                    { { 0, 1 } },
                                                                    { { 2, 1 } },
                                                                    { { 1, 0 } },
                                                                    { { 1, 2 } },
                                                                    { { 1, 1 } } } };

    std::string place(const Point &x)
    {
      return fmt::format("r = {:.6g}, z = {:.6g} mm", x[0], x[1]);
    }

    std::string fault_of_cells(const WorkpieceMesh &mesh)
    {
      std::vector<Point> points = dealii::QGauss<2>(3).get_points();
      for (const double x : { 0., 1. })
        for (const double y : { 0., 1. })
          points.emplace_back(x, y);

      const double radius_tolerance = 1e-7 * size_of_mesh(mesh);
      unsigned int n_bad            = 0;
      Point        first_bad;
      for (const std::array<Point, 9> &nodes : mesh.cell_nodes)
        {
          for (const Point &x : nodes)
            if (x[0] < -radius_tolerance)
              return fmt::format("the mesh has a node at {}, on the wrong side of the axis r = 0",
                                 place(x));
          double largest = 0, smallest = 1e300;
          for (const Point &point : points)
            {
              const double j = jacobian(nodes, point);
              largest        = std::max(largest, j);
              smallest       = std::min(smallest, j);
            }
          if (!(smallest > 1e-6 * largest) && n_bad++ == 0)
            first_bad = nodes[8];
        }
      if (n_bad > 0)
        return fmt::format(
            "{} of {} elements are inverted or have an angle of 180 degrees, the first "
            "at {}",
            n_bad, mesh.cells.size(), place(first_bad));
      return "";
    }

    std::string fault_of_vertices(const WorkpieceMesh &mesh)
    {
      const double              tolerance = 1e-8 * size_of_mesh(mesh);
      std::vector<unsigned int> order(mesh.vertices.size());
      std::iota(order.begin(), order.end(), 0u);
      const auto &x = mesh.vertices;
      std::sort(order.begin(), order.end(), [&](const unsigned int a, const unsigned int b) {
        return x[a][0] != x[b][0] ? x[a][0] < x[b][0] : a < b;
      });
      for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = i + 1;
             j < order.size() && x[order[j]][0] - x[order[i]][0] <= tolerance; ++j)
          if (x[order[i]].distance(x[order[j]]) <= tolerance)
            return fmt::format(
                "two vertices stand in the same place, {}: parts of the mesh touch there "
                "without being joined. In a .geo, use Coherence or give both surfaces the "
                "same curve",
                place(x[order[i]]));

      // Sorted along r, too: only vertices between the ends of an edge have to be looked at.
      std::vector<unsigned int> on_boundary;
      for (const WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
        on_boundary.insert(on_boundary.end(), { edge.v0, edge.v1 });
      std::sort(on_boundary.begin(), on_boundary.end(),
                [&](const unsigned int a, const unsigned int b) {
                  return x[a][0] != x[b][0] ? x[a][0] < x[b][0] : a < b;
                });
      for (const WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
        {
          const Point   a = x[edge.v0], b = x[edge.v1];
          const Vector2 d       = b - a;
          const double  lowest  = std::min(a[0], b[0]) - tolerance;
          const double  highest = std::max(a[0], b[0]) + tolerance;
          auto          vertex =
              std::lower_bound(on_boundary.begin(), on_boundary.end(), lowest,
                               [&](const unsigned int v, const double r) { return x[v][0] < r; });
          for (; vertex != on_boundary.end() && x[*vertex][0] <= highest; ++vertex)
            {
              const Vector2 e     = x[*vertex] - a;
              const double  along = e * d / d.norm_square();
              if (*vertex != edge.v0 && *vertex != edge.v1 && along > 0 && along < 1 &&
                  (e - along * d).norm() <= tolerance)
                return fmt::format(
                    "a vertex hangs on the edge of another element at {}: the mesh of the "
                    "workpiece has to be conforming",
                    place(x[*vertex]));
            }
        }
      return "";
    }

    std::string fault_of_connection(const WorkpieceMesh &mesh)
    {
      // Union of vertices over cells.
      std::vector<unsigned int> parent(mesh.vertices.size());
      std::iota(parent.begin(), parent.end(), 0u);
      const auto root = [&](unsigned int v) {
        while (parent[v] != v)
          v = parent[v] = parent[parent[v]];
        return v;
      };
      for (const auto &cell : mesh.cells)
        for (unsigned int v = 1; v < 4; ++v)
          parent[root(cell[v])] = root(cell[0]);
      for (const auto &cell : mesh.cells)
        if (root(cell[0]) != root(mesh.cells[0][0]))
          return fmt::format(
              "the workpiece has parts that are not connected, one at {} and one at {}",
              place(mesh.vertices[mesh.cells[0][0]]), place(mesh.vertices[cell[0]]));
      return "";
    }
  } // namespace

  double jacobian(const std::array<Point, 9> &nodes, const Point &unit_point)
  {
    const std::array<double, 3> nx = values(unit_point[0]), ny = values(unit_point[1]);
    const std::array<double, 3> dx = derivatives(unit_point[0]), dy = derivatives(unit_point[1]);
    Vector2                     along_x, along_y;
    for (unsigned int k = 0; k < 9; ++k)
      {
        along_x += dx[grid[k][0]] * ny[grid[k][1]] * nodes[k];
        along_y += nx[grid[k][0]] * dy[grid[k][1]] * nodes[k];
      }
    return along_x[0] * along_y[1] - along_x[1] * along_y[0];
  }

  double size_of_mesh(const WorkpieceMesh &mesh)
  {
    Point lower(1e300, 1e300), upper(-1e300, -1e300);
    for (const Point &x : mesh.vertices)
      for (unsigned int d = 0; d < 2; ++d)
        {
          lower[d] = std::min(lower[d], x[d]);
          upper[d] = std::max(upper[d], x[d]);
        }
    return lower.distance(upper);
  }

  double WorkpieceMesh::volume() const
  {
    const dealii::QGauss<2> quadrature(5);
    double                  volume = 0;
    for (const std::array<Point, 9> &nodes : cell_nodes)
      for (unsigned int q = 0; q < quadrature.size(); ++q)
        {
          const Point                &point = quadrature.point(q);
          const std::array<double, 3> nx = values(point[0]), ny = values(point[1]);
          double                      radius = 0;
          for (unsigned int k = 0; k < 9; ++k)
            radius += nx[grid[k][0]] * ny[grid[k][1]] * nodes[k][0];
          volume +=
              2 * dealii::numbers::PI * radius * jacobian(nodes, point) * quadrature.weight(q);
        }
    return volume;
  }

  std::string fault_of_mesh(const WorkpieceMesh &mesh)
  {
    for (const auto check : { fault_of_cells, fault_of_vertices, fault_of_connection })
      {
        const std::string fault = check(mesh);
        if (!fault.empty())
          return fault;
      }
    return "";
  }
} // namespace axiforge::meshing
