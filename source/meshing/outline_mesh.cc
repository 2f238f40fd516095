// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include <deal.II/base/quadrature_lib.h>

#include <fmt/format.h>
#include <gmsh.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/base/phases.h>
#include <axiforge/meshing/mesh_checks.h>
#include <axiforge/meshing/mesh_repair.h>
#include <axiforge/meshing/outline_mesh.h>

namespace axiforge::meshing
{
  namespace
  {
    /// A corner between two boundary edges of one loop.
    struct Corner
    {
      unsigned int loop, edge;
    };

    /// Worst Jacobian from which on the first mesh is taken without trying the other algorithms.
    constexpr double good_enough = 0.25;

    /// Below this a mesh is not worth having.
    constexpr double too_bad = 0.02;

    /// Of the vertices inside; they stop where nothing moves any more.
    constexpr unsigned int smoothing_sweeps = 15;

    /// What gmsh's entities stand for.
    struct Model
    {
      double                              unit;   ///< of gmsh's lengths [mm]
      std::vector<std::pair<int, Corner>> points; ///< of even vertices
      std::vector<std::pair<int, Corner>> curves; ///< over edges k and k + 1, k even
    };


    /// Power of two with which the outline is 32 to 64 long: gmsh has tolerances that are lengths
    /// (1e-8), so that a small workpiece would get another mesh than the same one in metres.
    double unit_of(const std::vector<NewLoop> &loops)
    {
      Point lower(1e300, 1e300), upper(-1e300, -1e300);
      for (const NewLoop &loop : loops)
        for (const NewNode &node : loop.vertices)
          for (unsigned int c = 0; c < 2; ++c)
            {
              lower[c] = std::min(lower[c], node.position[c]);
              upper[c] = std::max(upper[c], node.position[c]);
            }
      return std::ldexp(1., std::ilogb((upper - lower).norm()) - 5);
    }


    Model make_model(const std::vector<NewLoop> &loops)
    {
      namespace geo = gmsh::model::geo;
      gmsh::model::add("remeshing");
      Model model;
      model.unit = unit_of(loops);
      std::vector<int> curve_loops;
      for (unsigned int l = 0; l < loops.size(); ++l)
        {
          std::vector<int> points, curves;
          // In single precision: the rounding errors by which runs on one and on two ranks differ
          // should not lead gmsh to other meshes. The exact places are put back afterwards.
          for (const NewNode &node : loops[l].vertices)
            points.push_back(geo::addPoint(static_cast<float>(node.position[0] / model.unit),
                                           static_cast<float>(node.position[1] / model.unit), 0));
          const unsigned int n = points.size();
          for (unsigned int k = 0; k < n; k += 2)
            {
              curves.push_back(geo::addSpline({ points[k], points[k + 1], points[(k + 2) % n] }));
              geo::mesh::setTransfiniteCurve(curves.back(), 3);
              model.points.emplace_back(points[k], Corner{ l, k });
              model.curves.emplace_back(curves.back(), Corner{ l, k });
            }
          curve_loops.push_back(geo::addCurveLoop(curves));
        }
      // gmsh takes the first loop for the outer one.
      unsigned int outer   = 0;
      double       largest = 0;
      for (unsigned int l = 0; l < loops.size(); ++l)
        for (const NewNode &node : loops[l].vertices)
          if (node.position[0] >= largest)
            {
              largest = node.position[0];
              outer   = l;
            }
      std::swap(curve_loops[0], curve_loops[outer]);
      const int surface = geo::addPlaneSurface(curve_loops);
      geo::synchronize();
      gmsh::model::mesh::setRecombine(2, surface);
      return model;
    }


    /// Vertices and cells; the vertex number of each node of the loops.
    std::vector<std::vector<unsigned int>>
    take_mesh(const Model &model, const std::vector<NewLoop> &loops, WorkpieceMesh &mesh)
    {
      std::vector<std::size_t> tags, elements, corners;
      std::vector<double>      x, parametric;
      gmsh::model::mesh::getNodes(tags, x, parametric, -1, -1, false, false);
      std::map<std::size_t, Point> nodes;
      for (std::size_t i = 0; i < tags.size(); ++i)
        nodes[tags[i]] = model.unit * Point(x[3 * i], x[3 * i + 1]);
      std::vector<int>                      types;
      std::vector<std::vector<std::size_t>> all_elements, all_nodes;
      gmsh::model::mesh::getElements(types, all_elements, all_nodes, 2);
      const int quadrilateral = 3; // gmsh's number of the type
      if (types != std::vector<int>{ quadrilateral })
        throw ComputationError("gmsh left elements that are not quadrilaterals");
      corners = all_nodes[0];

      std::map<std::size_t, unsigned int> number;
      for (const std::size_t tag : corners)
        number[tag] = 0;
      for (auto &entry : number)
        {
          entry.second = mesh.vertices.size();
          mesh.vertices.push_back(nodes.at(entry.first));
        }
      for (std::size_t i = 0; i < corners.size(); i += 4)
        {
          std::array<unsigned int, 4> c;
          for (unsigned int k = 0; k < 4; ++k)
            c[k] = number.at(corners[i + k]);
          const Vector2 d = mesh.vertices[c[2]] - mesh.vertices[c[0]],
                        e = mesh.vertices[c[3]] - mesh.vertices[c[1]];
          if (d[0] * e[1] - d[1] * e[0] < 0)
            std::swap(c[1], c[3]);
          mesh.cells.push_back({ { c[0], c[1], c[3], c[2] } });
        }

      std::vector<std::vector<unsigned int>> vertex_of;
      for (const NewLoop &loop : loops)
        vertex_of.emplace_back(loop.vertices.size());
      const auto set = [&](const int dim, const int entity, const Corner &corner) {
        gmsh::model::mesh::getNodes(tags, x, parametric, dim, entity, false, false);
        if (tags.size() != 1 || number.count(tags[0]) == 0)
          throw ComputationError("gmsh did not keep the boundary as it was given");
        const unsigned int v                = number.at(tags[0]);
        vertex_of[corner.loop][corner.edge] = v;
        mesh.vertices[v]                    = loops[corner.loop].vertices[corner.edge].position;
      };
      for (const auto &[entity, corner] : model.points)
        set(0, entity, corner);
      for (const auto &[entity, corner] : model.curves)
        set(1, entity, { corner.loop, corner.edge + 1 });
      return vertex_of;
    }


    NewMesh attempt(const Model &model, const std::vector<NewLoop> &loops)
    {
      NewMesh    made;
      const auto vertex_of = take_mesh(model, loops, made.mesh);
      for (unsigned int l = 0; l < loops.size(); ++l)
        {
          const unsigned int n = loops[l].vertices.size();
          for (unsigned int k = 0; k < n; ++k)
            {
              const unsigned int next = (k + 1) % n;
              made.mesh.boundary_edges.push_back(
                  { vertex_of[l][k], vertex_of[l][next], loops[l].ids[k] });
              made.boundary.push_back(
                  { { loops[l].vertices[k], loops[l].vertices[next], loops[l].middles[k] } });
            }
        }
      const Phase phase("repair and smoothing");
      repair_topology(made);
      smooth(made, smoothing_sweeps);
      return made;
    }


    /// Whether chords of the outline cross, of every or of every second vertex: gmsh would divide
    /// them again and again.
    bool crosses_itself(const std::vector<NewLoop> &loops)
    {
      for (const unsigned int stride : { 1u, 2u })
        {
          std::vector<std::pair<Point, Point>> chords;
          for (const NewLoop &loop : loops)
            for (unsigned int k = 0; k < loop.vertices.size(); k += stride)
              chords.emplace_back(loop.vertices[k].position,
                                  loop.vertices[(k + stride) % loop.vertices.size()].position);
          const auto left = [](const Point &a, const Point &b, const Point &c) {
            return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
          };
          for (std::size_t i = 0; i < chords.size(); ++i)
            for (std::size_t j = i + 1; j < chords.size(); ++j)
              {
                const auto &[a, b] = chords[i];
                const auto &[c, d] = chords[j];
                if (left(a, b, c) * left(a, b, d) < 0 && left(c, d, a) * left(c, d, b) < 0)
                  return true;
              }
        }
      return false;
    }


    /// Whether the sides with one cell are the boundary edges, and no side has more than two cells.
    bool keeps_boundary(const WorkpieceMesh &mesh)
    {
      using Edge = std::pair<unsigned int, unsigned int>;
      constexpr std::array<std::array<unsigned int, 2>, 4> sides = {
        { { { 0, 1 } }, { { 1, 3 } }, { { 3, 2 } }, { { 2, 0 } } }
      };
      std::map<Edge, int> n_cells;
      for (const auto &cell : mesh.cells)
        for (const auto &[a, b] : sides)
          ++n_cells[std::minmax(cell[a], cell[b])];
      for (const WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
        ++n_cells[std::minmax(edge.v0, edge.v1)];
      return std::all_of(n_cells.begin(), n_cells.end(),
                         [](const auto &entry) { return entry.second == 2; });
    }


    NewMesh run_gmsh(const GmshSession          &session,
                     const int                   algorithm,
                     const int                   recombination,
                     const std::vector<NewLoop> &loops,
                     const SizeField            &field)
    {
      NewMesh made;
      session.run("meshing the outline of the workpiece", [&] {
        gmsh::clear();
        for (const auto &[name, value] :
             std::map<std::string, double>{ { "Mesh.Algorithm", algorithm },
                                            { "Mesh.RecombinationAlgorithm", recombination },
                                            { "Mesh.RecombineAll", 1 },
                                            { "Mesh.Smoothing", 3 }, // ours follows
                                            { "Mesh.ElementOrder", 1 },
                                            { "Mesh.MeshOnlyVisible", 0 },
                                            { "Mesh.MeshSizeFactor", 1 },
                                            { "Mesh.MeshSizeFromPoints", 0 },
                                            { "Mesh.MeshSizeFromCurvature", 0 },
                                            { "Mesh.MeshSizeExtendFromBoundary", 1 },
                                            { "Mesh.MeshSizeMin", 0 },
                                            { "Mesh.MeshSizeMax", 1e22 } })
          gmsh::option::setNumber(name, value);
        const Model model = make_model(loops);
        // In single precision for the reason that the points are.
        gmsh::model::mesh::setSizeCallback([&](int, int, const double x, const double y, double) {
          return static_cast<double>(
              static_cast<float>(field.at(model.unit * Point(x, y)) / model.unit));
        });
        std::srand(1); // gmsh shifts points at random, and seeds only once per process
        {
          const Phase phase("gmsh");
          gmsh::model::mesh::generate(2);
        }
        gmsh::model::mesh::removeSizeCallback();
        made = attempt(model, loops);
      });
      return made;
    }
  } // namespace


  static double scaled_jacobian(const std::array<Point, 9> &nodes)
  {
    static const dealii::QGauss<2> gauss(3);
    double                         smallest = 1e300, area = 0;
    for (unsigned int q = 0; q < gauss.size(); ++q)
      {
        const double j = jacobian(nodes, gauss.point(q));
        smallest       = std::min(smallest, j);
        area += j * gauss.weight(q);
      }
    for (unsigned int v = 0; v < 4; ++v)
      smallest = std::min(smallest, jacobian(nodes, Point(v % 2, v / 2)));
    return area > 0 ? smallest / area : -1.;
  }


  double smallest_scaled_jacobian(const WorkpieceMesh &mesh)
  {
    double worst = 1;
    for (const std::array<Point, 9> &nodes : mesh.cell_nodes)
      worst = std::min(worst, scaled_jacobian(nodes));
    return worst;
  }


  NewMesh mesh_outline(const std::vector<NewLoop>                              &loops,
                       const SizeField                                         &field,
                       const std::map<std::string, dealii::types::boundary_id> &boundary_ids)
  {
    NewMesh best;
    best.fault                                             = "gmsh made no mesh";
    double                                      best_value = too_bad;
    constexpr std::array<std::array<int, 2>, 4> algorithms = {
      { { { 6, 2 } }, { { 5, 2 } }, { { 6, 3 } }, { { 5, 3 } } }
    };
    const auto consider = [&](NewMesh &made) {
      const Phase phase("quality");
      made.mesh.boundary_ids  = boundary_ids;
      const std::string fault = keeps_boundary(made.mesh)
                                    ? fault_of_mesh(made.mesh)
                                    : "gmsh did not keep the boundary as it was given";
      const double      value = fault.empty() ? smallest_scaled_jacobian(made.mesh) : -1;
      if (value > best_value)
        {
          best       = made;
          best_value = value;
        }
      else if (!best.fault.empty())
        best.fault =
            fault.empty() ? fmt::format("the best mesh has a Jacobian of {:.3g}", value) : fault;
    };
    if (crosses_itself(loops))
      {
        best.fault = "the outline of the workpiece crosses itself";
        return best;
      }
    GmshSession session;
    for (const auto &[algorithm, recombination] : algorithms)
      {
        // The blossom's recombination gives the same mesh, as a rule: only if there is none.
        if (best_value >= good_enough || (recombination == 3 && best.fault.empty()))
          break;
        try
          {
            NewMesh made = run_gmsh(session, algorithm, recombination, loops, field);
            consider(made);
            if (best_value >= good_enough)
              break;
            const Phase phase("repair and smoothing");
            add_boundary_row(made);
            smooth(made, smoothing_sweeps);
            consider(made);
          }
        catch (const std::exception &error) // of gmsh, in its words
          {
            if (!best.fault.empty())
              best.fault = error.what();
          }
      }
    return best;
  }


  bool restore_volume(NewMesh &made, const double volume, const double edge_length)
  {
    std::map<unsigned int, Vector2> directions;
    double                          sum = 0;
    for (unsigned int e = 0; e < made.boundary.size(); ++e)
      {
        directions[made.mesh.boundary_edges[e].v0] = made.boundary[e][0].direction;
        directions[made.mesh.boundary_edges[e].v1] = made.boundary[e][1].direction;
        for (const NewNode &node : made.boundary[e])
          sum += node.direction.norm();
      }
    if (sum == 0)
      return false;

    NewMesh    moved = made;
    const auto move  = [&](const double distance) {
      moved = made;
      for (const auto &[vertex, direction] : directions)
        moved.mesh.vertices[vertex] += distance * direction;
      for (std::array<NewNode, 3> &nodes : moved.boundary)
        for (NewNode &node : nodes)
          node.position += distance * node.direction;
      place_cell_nodes(moved);
      return moved.mesh.volume() - volume;
    };
    // The volume is a cubic polynomial of the distance, almost a line: the secant's rule.
    double before = 0, error_before = move(0), distance = 1e-3 * edge_length;
    for (unsigned int i = 0; i < 30; ++i)
      {
        const double error = move(distance);
        if (!(std::abs(distance) < 0.2 * edge_length))
          return false;
        if (std::abs(error) <= 1e-13 * volume || error == error_before)
          break;
        const double next = distance - error * (distance - before) / (error - error_before);
        before            = distance;
        error_before      = error;
        distance          = next;
      }
    if (std::abs(moved.mesh.volume() / volume - 1) > 1e-11 || !fault_of_mesh(moved.mesh).empty())
      return false;
    made = moved;
    return true;
  }
} // namespace axiforge::meshing
