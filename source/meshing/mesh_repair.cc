// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <axiforge/meshing/mesh_repair.h>

namespace axiforge::meshing
{
  namespace
  {
    using Edge = std::pair<unsigned int, unsigned int>; ///< vertices, the smaller first

    Edge edge_of(const unsigned int a, const unsigned int b)
    {
      return { std::min(a, b), std::max(a, b) };
    }

    /// Start, end and middle node of the sides of a cell.
    constexpr std::array<std::array<unsigned int, 3>, 4> edges_of_cell = {
      { { { 0, 2, 4 } }, { { 1, 3, 5 } }, { { 0, 1, 6 } }, { { 2, 3, 7 } } }
    };

    /// Corners of a cell in the order of its rim, and back.
    constexpr std::array<unsigned int, 4> around = { { 0, 1, 3, 2 } };

    /// A cell angle above this [rad] has to be mended.
    constexpr double largest_angle = 0.85 * M_PI;

    /// A vertex that moves by less, over the size of its cells, stays where it is.
    constexpr double at_rest = 1e-3;

    /// An edge counts as straight whose middle is off that of its chord by less than this part of
    /// it.
    constexpr double straight = 1e-9;


    using Middles = std::map<Edge, Point>;

    Middles boundary_middles(const NewMesh &made)
    {
      Middles middles;
      for (unsigned int e = 0; e < made.mesh.boundary_edges.size(); ++e)
        middles[edge_of(made.mesh.boundary_edges[e].v0, made.mesh.boundary_edges[e].v1)] =
            made.boundary[e][2].position;
      return middles;
    }


    /// Middle nodes of the edges of a cell, null where the edge is straight.
    using CellMiddles = std::array<const Point *, 4>;

    CellMiddles
    middles_of_cell(const WorkpieceMesh &mesh, const Middles &middles, const unsigned int c)
    {
      CellMiddles result;
      for (unsigned int e = 0; e < 4; ++e)
        {
          const auto &[a, b, m] = edges_of_cell[e];
          const auto found      = middles.find(edge_of(mesh.cells[c][a], mesh.cells[c][b]));
          result[e]             = found != middles.end() ? &found->second : nullptr;
        }
      return result;
    }


    void place_nodes(WorkpieceMesh &mesh, const CellMiddles &middles, const unsigned int c)
    {
      std::array<Point, 9> &x = mesh.cell_nodes[c];
      Point                 centre;
      for (unsigned int v = 0; v < 4; ++v)
        {
          x[v] = mesh.vertices[mesh.cells[c][v]];
          centre += -0.25 * x[v];
        }
      for (unsigned int e = 0; e < 4; ++e)
        {
          const auto &[a, b, m] = edges_of_cell[e];
          x[m]                  = middles[e] ? *middles[e] : x[a] + 0.5 * (x[b] - x[a]);
          centre += 0.5 * x[m];
        }
      x[8] = centre;
    }


    /// Cells around each vertex.
    std::vector<std::vector<unsigned int>> cells_of_vertices(const WorkpieceMesh &mesh)
    {
      std::vector<std::vector<unsigned int>> cells(mesh.vertices.size());
      for (unsigned int c = 0; c < mesh.cells.size(); ++c)
        for (const unsigned int v : mesh.cells[c])
          cells[v].push_back(c);
      return cells;
    }


    std::vector<bool> on_boundary(const WorkpieceMesh &mesh)
    {
      std::vector<bool> result(mesh.vertices.size(), false);
      for (const WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
        result[edge.v0] = result[edge.v1] = true;
      return result;
    }


    std::array<unsigned int, 4> cell_around(const unsigned int a,
                                            const unsigned int b,
                                            const unsigned int c,
                                            const unsigned int d)
    {
      return { { a, b, d, c } };
    }


    /// Inner vertices with two cells go.
    unsigned int remove_doublets(WorkpieceMesh &mesh)
    {
      unsigned int n_removed = 0;
      for (bool again = true; again;)
        {
          again                         = false;
          const auto              cells = cells_of_vertices(mesh);
          const std::vector<bool> fixed = on_boundary(mesh);
          for (unsigned int v = 0; v < mesh.vertices.size() && !again; ++v)
            {
              if (fixed[v] || cells[v].size() != 2)
                continue;
              // First cell (v, a, x, b), second (v, b, y, a): what is left is (a, x, b, y).
              std::array<std::array<unsigned int, 4>, 2> rim;
              for (unsigned int i = 0; i < 2; ++i)
                {
                  const auto  &cell  = mesh.cells[cells[v][i]];
                  unsigned int start = 0;
                  while (cell[around[start]] != v)
                    ++start;
                  for (unsigned int k = 0; k < 4; ++k)
                    rim[i][k] = cell[around[(start + k) % 4]];
                }
              if (rim[0][1] != rim[1][3] || rim[0][3] != rim[1][1])
                continue;
              mesh.cells[cells[v][0]] = cell_around(rim[0][1], rim[0][2], rim[0][3], rim[1][2]);
              mesh.cells.erase(mesh.cells.begin() + cells[v][1]);
              mesh.vertices.erase(mesh.vertices.begin() + v);
              for (auto &cell : mesh.cells)
                for (unsigned int &w : cell)
                  w -= w > v;
              for (WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
                {
                  edge.v0 -= edge.v0 > v;
                  edge.v1 -= edge.v1 > v;
                }
              ++n_removed;
              again = true;
            }
        }
      return n_removed;
    }


    /// The cells shrink away from their common rim, and a ring of new cells takes its place.
    void frame(WorkpieceMesh &mesh, const std::vector<unsigned int> &cells)
    {
      std::map<Edge, std::pair<unsigned int, Edge>> sides; // number of cells, and direction
      std::map<unsigned int, Point>                 centre;
      for (const unsigned int c : cells)
        for (unsigned int k = 0; k < 4; ++k)
          {
            const unsigned int a = mesh.cells[c][around[k]], b = mesh.cells[c][around[(k + 1) % 4]];
            auto              &side = sides[edge_of(a, b)];
            ++side.first;
            side.second = { a, b };
          }
      // Twins of the vertices of the rim, a third of the way to the middle of their cells.
      std::map<unsigned int, unsigned int>                     twin;
      std::map<unsigned int, std::pair<Vector2, unsigned int>> way;
      for (const unsigned int c : cells)
        {
          Point middle;
          for (const unsigned int v : mesh.cells[c])
            middle += 0.25 * mesh.vertices[v];
          for (const unsigned int v : mesh.cells[c])
            {
              way[v].first += middle - mesh.vertices[v];
              ++way[v].second;
            }
        }
      for (const auto &[edge, side] : sides)
        if (side.first == 1)
          for (const unsigned int v : { edge.first, edge.second })
            if (twin.count(v) == 0)
              {
                twin[v] = mesh.vertices.size();
                mesh.vertices.push_back(mesh.vertices[v] + way[v].first / (3. * way[v].second));
              }
      for (const unsigned int c : cells)
        for (unsigned int &v : mesh.cells[c])
          if (const auto found = twin.find(v); found != twin.end())
            v = found->second;
      for (const auto &[edge, side] : sides)
        if (side.first == 1)
          {
            const auto &[a, b] = side.second;
            mesh.cells.push_back(cell_around(a, b, twin[b], twin[a]));
          }
    }


    /// Angle of the workpiece at the vertices of the boundary [rad].
    std::map<unsigned int, double> boundary_angles(const NewMesh &made)
    {
      std::map<unsigned int, Vector2> arriving, leaving;
      for (unsigned int e = 0; e < made.mesh.boundary_edges.size(); ++e)
        {
          const auto &edge  = made.mesh.boundary_edges[e];
          const Point x0    = made.mesh.vertices[edge.v0];
          const Point x1    = made.mesh.vertices[edge.v1];
          const Point m     = made.boundary[e][2].position;
          leaving[edge.v0]  = 4. * (m - x0) - (x1 - x0);
          arriving[edge.v1] = (x1 - x0) - 4. * (m - x0) + 2. * (x1 - x0);
        }
      std::map<unsigned int, double> angles;
      for (const auto &[v, in] : arriving)
        {
          const Vector2 out = leaving[v];
          angles[v]         = M_PI - std::atan2(in[0] * out[1] - in[1] * out[0], in * out);
        }
      return angles;
    }


    unsigned int frame_flat_corners(NewMesh &made)
    {
      unsigned int n_framed = 0;
      auto         cells    = cells_of_vertices(made.mesh);
      for (const auto &[v, angle] : boundary_angles(made))
        {
          if (cells[v].size() != 1 || angle < largest_angle)
            continue;
          const auto        &cell = made.mesh.cells[cells[v].front()];
          const unsigned int opposite =
              cell[3 - (std::find(cell.begin(), cell.end(), v) - cell.begin())];
          frame(made.mesh, on_boundary(made.mesh)[opposite] ? cells[v] : cells[opposite]);
          cells = cells_of_vertices(made.mesh);
          ++n_framed;
        }
      return n_framed;
    }


    /// Derivatives of the nodes' shape functions at points of a cell: corners and those next to
    /// them of the 3 x 3 Gauss points.
    struct Samples
    {
      static constexpr unsigned int n = 8;
      double                        d[9][2][n];
      double                        place[2][n];

      static const Samples &get()
      {
        static const Samples samples;
        return samples;
      }

      Samples()
      {
        const unsigned int column[9] = { 0, 2, 0, 2, 0, 2, 1, 1, 1 },
                           row[9]    = { 0, 0, 2, 2, 1, 1, 0, 2, 1 };
        const double inside          = 0.5 - std::sqrt(0.15);
        for (unsigned int q = 0; q < n; ++q)
          {
            double u[2][3], du[2][3];
            for (unsigned int c = 0; c < 2; ++c)
              {
                const double end = (c == 0 ? q % 2 : q / 2 % 2);
                const double t   = q < 4 ? end : (end > 0.5 ? 1 - inside : inside);
                place[c][q]      = t;
                u[c][0]          = (1 - t) * (1 - 2 * t);
                u[c][1]          = 4 * t * (1 - t);
                u[c][2]          = t * (2 * t - 1);
                du[c][0]         = 4 * t - 3;
                du[c][1]         = 4 - 8 * t;
                du[c][2]         = 4 * t - 1;
              }
            for (unsigned int a = 0; a < 9; ++a)
              {
                d[a][0][q] = du[0][column[a]] * u[1][row[a]];
                d[a][1][q] = u[0][column[a]] * du[1][row[a]];
              }
          }
      }
    };


    /// Determinants at the samples, and |J|^2 / 2. The loops over the samples are the inner ones:
    /// the compiler puts them into vector registers.
    void
    sample(const std::array<Point, 9> &x, double (&det)[Samples::n], double (&half)[Samples::n])
    {
      const Samples &samples             = Samples::get();
      double         J[2][2][Samples::n] = {};
      for (unsigned int a = 0; a < 9; ++a)
        for (unsigned int c = 0; c < 2; ++c)
          for (unsigned int k = 0; k < 2; ++k)
            for (unsigned int q = 0; q < Samples::n; ++q)
              J[c][k][q] += x[a][c] * samples.d[a][k][q];
      for (unsigned int q = 0; q < Samples::n; ++q)
        {
          det[q]  = J[0][0][q] * J[1][1][q] - J[0][1][q] * J[1][0][q];
          half[q] = 0.5 * (J[0][0][q] * J[0][0][q] + J[0][1][q] * J[0][1][q] +
                           J[1][0][q] * J[1][0][q] + J[1][1][q] * J[1][1][q]);
        }
    }


    /// The same of a cell with straight edges, from its vertices: the map is bilinear.
    void sample_straight(const WorkpieceMesh               &mesh,
                         const std::array<unsigned int, 4> &cell,
                         double (&det)[Samples::n],
                         double (&half)[Samples::n])
    {
      const Point &a = mesh.vertices[cell[0]], &b = mesh.vertices[cell[1]],
                  &c = mesh.vertices[cell[2]], &d = mesh.vertices[cell[3]];
      const Samples &samples = Samples::get();
      const double bottom[2] = { b[0] - a[0], b[1] - a[1] }, top[2] = { d[0] - c[0], d[1] - c[1] };
      const double left[2] = { c[0] - a[0], c[1] - a[1] }, right[2] = { d[0] - b[0], d[1] - b[1] };
      for (unsigned int q = 0; q < Samples::n; ++q)
        {
          const double x = samples.place[0][q], y = samples.place[1][q];
          const double J[4] = { bottom[0] + y * (top[0] - bottom[0]),
                                left[0] + x * (right[0] - left[0]),
                                bottom[1] + y * (top[1] - bottom[1]),
                                left[1] + x * (right[1] - left[1]) };
          det[q]            = J[0] * J[3] - J[1] * J[2];
          half[q]           = 0.5 * (J[0] * J[0] + J[1] * J[1] + J[2] * J[2] + J[3] * J[3]);
        }
    }


    class Smoother
    {
    public:
      explicit Smoother(NewMesh &made)
          : mesh(made.mesh)
          , middles(boundary_middles(made))
          , cells(cells_of_vertices(mesh))
          , fixed(on_boundary(mesh))
          , middles_of(mesh.cells.size())
          , curved(mesh.cells.size(), false)
          , due(mesh.vertices.size(), true)
      {
        for (unsigned int c = 0; c < mesh.cells.size(); ++c)
          {
            middles_of[c] = middles_of_cell(mesh, middles, c);
            for (unsigned int e = 0; e < 4; ++e)
              if (middles_of[c][e])
                {
                  const auto &[a, b, m] = edges_of_cell[e];
                  const Point &start    = mesh.vertices[mesh.cells[c][a]],
                              &end      = mesh.vertices[mesh.cells[c][b]];
                  const Vector2 off     = *middles_of[c][e] - (start + 0.5 * (end - start));
                  curved[c]             = curved[c] || off.norm() > straight * start.distance(end);
                }
          }
      }

      /// Moves the vertices that are due, and makes those due whose surroundings have moved. False:
      /// nothing moves any more.
      bool sweep()
      {
        set_delta();
        std::vector<bool> next(mesh.vertices.size(), false);
        bool              any = false;
        for (unsigned int v = 0; v < mesh.vertices.size(); ++v)
          if (due[v] && !fixed[v] && move(v) >= at_rest)
            {
              any = true;
              for (const unsigned int c : cells[v])
                for (const unsigned int w : mesh.cells[c])
                  next[w] = true;
            }
        due.swap(next);
        return any;
      }

    private:
      void measure(const unsigned int c, double (&det)[Samples::n], double (&half)[Samples::n])
      {
        if (!curved[c])
          return sample_straight(mesh, mesh.cells[c], det, half);
        place_nodes(mesh, middles_of[c], c);
        sample(mesh.cell_nodes[c], det, half);
      }

      double energy(const unsigned int v)
      {
        double sum = 0;
        for (const unsigned int c : cells[v])
          {
            double det[Samples::n], half[Samples::n];
            measure(c, det, half);
            for (unsigned int q = 0; q < Samples::n; ++q)
              {
                const double d = det[q] / half[q];
                const double h = delta > 0 ? 0.5 * (d + std::sqrt(d * d + 4 * delta * delta)) : d;
                if (!(h > 0))
                  return 1e300;
                sum += 1 / (h * h);
              }
          }
        return sum;
      }

      void set_delta()
      {
        double least = 1e300;
        for (unsigned int c = 0; c < mesh.cells.size(); ++c)
          {
            double det[Samples::n], half[Samples::n];
            measure(c, det, half);
            for (unsigned int q = 0; q < Samples::n; ++q)
              least = std::min(least, det[q] / half[q]);
          }
        constexpr double small = 0.05;
        delta                  = least < small ? std::sqrt(small * (small - least)) : 0;
      }

      double move(const unsigned int v)
      {
        const Point start = mesh.vertices[v];
        double      size  = 0;
        for (const unsigned int c : cells[v])
          size = std::max(
              size, mesh.vertices[mesh.cells[c][0]].distance(mesh.vertices[mesh.cells[c][3]]));
        const double step = 1e-3 * size;
        const auto   at   = [&](const double r, const double z) {
          mesh.vertices[v] = start + Vector2({ r, z });
          return energy(v);
        };
        const double e0 = at(0, 0), er = at(step, 0), el = at(-step, 0), eu = at(0, step),
                     ed = at(0, -step), eru = at(step, step), eld = at(-step, -step);
        const double gr = 0.5 * (er - el), gz = 0.5 * (eu - ed);
        double       hrr = er + el - 2 * e0, hzz = eu + ed - 2 * e0;
        double       hrz = 0.5 * (eru + eld - er - el - eu - ed + 2 * e0);
        // Make the matrix positive definite.
        const double mean = 0.5 * (hrr + hzz), spread = std::hypot(0.5 * (hrr - hzz), hrz);
        const double shift = std::max(0., spread - mean + 0.1 * std::max(spread, std::abs(mean)));
        hrr += shift;
        hzz += shift;
        const double det = hrr * hzz - hrz * hrz;
        double       dr = 0, dz = 0;
        if (det > 0 && std::isfinite(det))
          {
            dr = -(hzz * gr - hrz * gz) / det * step;
            dz = -(hrr * gz - hrz * gr) / det * step;
          }
        if (const double length = std::hypot(dr, dz); length > 0.2 * size)
          {
            dr *= 0.2 * size / length;
            dz *= 0.2 * size / length;
          }
        for (unsigned int i = 0; i < 6; ++i, dr *= 0.5, dz *= 0.5)
          if (at(dr, dz) < e0)
            return std::hypot(dr, dz) / size;
        at(0, 0);
        return 0;
      }

      WorkpieceMesh                         &mesh;
      const Middles                          middles;
      std::vector<std::vector<unsigned int>> cells;
      std::vector<bool>                      fixed;
      double                                 delta = 0;
      std::vector<CellMiddles>               middles_of;
      std::vector<bool>                      curved; ///< cells with a curved edge
      std::vector<bool>                      due;    ///< to be moved in the next sweep
    };
  } // namespace


  void place_cell_nodes(NewMesh &made)
  {
    const Middles middles = boundary_middles(made);
    made.mesh.cell_nodes.resize(made.mesh.cells.size());
    for (unsigned int c = 0; c < made.mesh.cells.size(); ++c)
      place_nodes(made.mesh, middles_of_cell(made.mesh, middles, c), c);
  }


  unsigned int repair_topology(NewMesh &made)
  {
    const unsigned int n_changes = remove_doublets(made.mesh) + frame_flat_corners(made);
    place_cell_nodes(made);
    return n_changes;
  }


  void add_boundary_row(NewMesh &made)
  {
    std::vector<unsigned int> all(made.mesh.cells.size());
    for (unsigned int c = 0; c < all.size(); ++c)
      all[c] = c;
    frame(made.mesh, all);
    place_cell_nodes(made);
  }


  void smooth(NewMesh &made, const unsigned int sweeps)
  {
    place_cell_nodes(made);
    Smoother smoother(made);
    for (unsigned int i = 0; i < sweeps; ++i)
      if (!smoother.sweep())
        break;
    place_cell_nodes(made);
  }
} // namespace axiforge::meshing
