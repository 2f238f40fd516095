// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <gmsh.h>

#include <axiforge/base/cad_section.h>
#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/base/notes.h>
#include <axiforge/meshing/mesh_checks.h>
#include <axiforge/meshing/straight_lines.h>
#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  namespace
  {
    using Edge = std::pair<unsigned int, unsigned int>; ///< vertices, the smaller first

    Edge edge_of(const unsigned int a, const unsigned int b)
    {
      return { std::min(a, b), std::max(a, b) };
    }

    /// What the helpers below share for one file.
    struct Source
    {
      const GeometryParameters &parameters;
      std::string               section;
      std::string               file;
      GmshSession               session;

      InputError wrong(const std::string &what, const std::string &way_out = "") const
      {
        return InputError::entry(section + "/Geometry file", file, what, "", way_out);
      }
    };

    std::vector<int> surfaces_of_workpiece(const Source &source)
    {
      const std::string &face = source.parameters.face;
      if (source.session.holds_cad())
        {
          int        section = 0;
          const auto cut     = [&] {
            section =
                section_of_cad(face, [&](const std::string &what, const std::string &way_out) {
                  return source.wrong(what, way_out);
                });
          };
          source.session.try_out("taking the meridian section", cut);
          source.session.run("taking the meridian section", cut);
          return { section };
        }
      if (!face.empty())
        throw InputError::entry(source.section + "/Face", face,
                                fmt::format("\"{}\" is no CAD file", source.file),
                                "nothing, or a .step, .stp or .brep as Geometry file",
                                "The workpiece in a .geo or .msh is chosen by \"Physical group\"");
      const std::string &group = source.parameters.physical_group;
      std::vector<int>   surfaces;
      if (!group.empty())
        surfaces = source.session.entities_of_group(2, group);
      if (!surfaces.empty())
        return surfaces;

      const std::vector<std::string> known = source.session.group_names(2);
      gmsh::vectorpair               all;
      gmsh::model::getEntities(all, 2);
      if (known.empty() && all.size() == 1)
        return { all.front().second };
      if (known.empty())
        throw source.wrong(fmt::format("it has {} surfaces and no physical surface", all.size()),
                           all.empty()
                               ? "The workpiece has to be a plane surface, x = r and y = z"
                               : "Name the workpiece: Physical Surface(\"workpiece\") = {...};");
      throw InputError::entry(
          source.section + "/Physical group", group,
          fmt::format("\"{}\" has no physical surface of this name", source.file),
          fmt::format("the physical surfaces of this file: {}", quoted_list(known)));
    }

    /// Number of elements of the surfaces with other than four corners.
    unsigned int count_non_quadrilaterals(const std::vector<int> &surfaces, Point *place = nullptr)
    {
      unsigned int n_found = 0;
      for (const int surface : surfaces)
        {
          std::vector<int>                      types;
          std::vector<std::vector<std::size_t>> elements, nodes;
          gmsh::model::mesh::getElements(types, elements, nodes, 2, surface);
          for (std::size_t i = 0; i < types.size(); ++i)
            {
              std::string         name;
              int                 dim, order, n_nodes, n_corners;
              std::vector<double> coordinates;
              gmsh::model::mesh::getElementProperties(types[i], name, dim, order, n_nodes,
                                                      coordinates, n_corners);
              if (n_corners == 4)
                continue;
              if (n_found == 0 && place != nullptr)
                {
                  std::vector<double> x, parametric;
                  gmsh::model::mesh::getNode(nodes[i][0], x, parametric);
                  *place = Point(x[0], x[1]);
                }
              n_found += elements[i].size();
            }
        }
      return n_found;
    }

    /// Smallest sine of an angle of the quadrilaterals of the surfaces, negative if one is turned
    /// in against the others of its element.
    double smallest_corner_sine(const std::vector<int> &surfaces)
    {
      std::vector<std::size_t> tags;
      std::vector<double>      x, parametric;
      gmsh::model::mesh::getNodes(tags, x, parametric);
      std::map<std::size_t, Point> nodes;
      for (std::size_t i = 0; i < tags.size(); ++i)
        nodes[tags[i]] = Point(x[3 * i], x[3 * i + 1]);

      double smallest = 1;
      for (const int surface : surfaces)
        {
          std::vector<std::size_t> elements, element_nodes;
          const int                quadrilateral = 3; // gmsh's number of the type
          gmsh::model::mesh::getElementsByType(quadrilateral, elements, element_nodes, surface);
          for (std::size_t e = 0; e < elements.size(); ++e)
            {
              std::array<double, 4> sines;
              double                sum = 0;
              for (unsigned int v = 0; v < 4; ++v)
                {
                  const Point   corner = nodes.at(element_nodes[4 * e + v]);
                  const Vector2 to     = nodes.at(element_nodes[4 * e + (v + 1) % 4]) - corner;
                  const Vector2 from   = nodes.at(element_nodes[4 * e + (v + 3) % 4]) - corner;
                  sines[v] = (to[0] * from[1] - to[1] * from[0]) / (to.norm() * from.norm());
                  sum += sines[v];
                }
              for (const double sine : sines)
                smallest = std::min(smallest, sum > 0 ? sine : -sine);
            }
        }
      return smallest;
    }

    /// Mesh.Algorithm and Mesh.RecombinationAlgorithm to try when the first pair, 6 and 2 if the
    /// file has no wishes, leaves triangles or bad elements.
    constexpr std::array<std::array<int, 2>, 3> more_algorithms = {
      { { { 6, 3 } }, { { 5, 2 } }, { { 5, 3 } } }
    };

    /// The options a .geo may overwrite.
    void set_mesh_options()
    {
      gmsh::option::setNumber("Mesh.Algorithm", 6);
      gmsh::option::setNumber("Mesh.RecombinationAlgorithm", 2);
      gmsh::option::setNumber("Mesh.Smoothing", 10);
      gmsh::option::setNumber("Mesh.RecombineAll", 1);
      gmsh::option::setNumber("Mesh.ElementOrder", 1);
      gmsh::option::setNumber("Mesh.SecondOrderLinear", 0);
      gmsh::option::setNumber("Mesh.MeshSizeFactor", 1);
      gmsh::option::setNumber("Mesh.MeshSizeMin", 0);
      gmsh::option::setNumber("Mesh.MeshSizeMax", 1e22);
      gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 1);
      gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", 0);
      gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 1);
      gmsh::option::setNumber("Mesh.MshFileVersion", 4.1);
    }

    /// An element size that makes more elements than anyone can compute with.
    void check_element_size(const Source &source, const std::vector<int> &surfaces)
    {
      constexpr double most = 1e7;
      const double     size = source.parameters.element_size;
      if (!(size > 0))
        return;
      double area = 0;
      for (const int surface : surfaces)
        {
          double x[2], y[2], z[2];
          gmsh::model::getBoundingBox(2, surface, x[0], y[0], z[0], x[1], y[1], z[1]);
          area += (x[1] - x[0]) * (y[1] - y[0]);
        }
      if (area / size / size > most)
        throw InputError::entry(
            source.section + "/Element size", fmt::format("{:.6g}", size),
            fmt::format("the workpiece would have {:.3g} elements", area / size / size),
            fmt::format("0, or at least {:.3g} mm", std::sqrt(area / most)));
    }


    /// Number of nodes that gmsh makes of the surfaces with one size everywhere.
    std::size_t n_nodes_with(const double size)
    {
      gmsh::option::setNumber("Mesh.MeshSizeMin", size);
      gmsh::option::setNumber("Mesh.MeshSizeMax", size);
      gmsh::model::mesh::clear();
      gmsh::model::mesh::generate(2);
      std::vector<std::size_t> tags;
      std::vector<double>      x, parametric;
      gmsh::model::mesh::getNodes(tags, x, parametric);
      return tags.size();
    }

    /// A file that says the numbers of cells itself (transfinite) does not listen to a size.
    void note_idle_size(const Source &source, const std::vector<int> &surfaces)
    {
      const double size = source.parameters.element_size;
      if (!(size > 0))
        return;
      bool idle = source.session.holds_mesh();
      if (!idle && source.session.mentions("Transfinite"))
        source.session.run("meshing the workpiece", [&] {
          for (const int surface : surfaces) // its own may be the one that crashes
            gmsh::model::mesh::setAlgorithm(2, surface, 6);
          idle = n_nodes_with(size) == n_nodes_with(2 * size);
          gmsh::option::setNumber("Mesh.MeshSizeMin", size);
          gmsh::option::setNumber("Mesh.MeshSizeMax", size);
        });
      if (idle)
        note(
            fmt::format("Entry \"{}/Element size\" = \"{}\" does nothing: the file \"{}\" {}.",
                        source.section, size, source.file,
                        source.session.holds_mesh()
                            ? "is a mesh already. \"Refinement levels\" divides its cells"
                            : "says the numbers of cells itself (transfinite). Change them, by its "
                              "\"Geometry parameters\" if it has some, or take \"Refinement "
                              "levels\""));
    }

    void generate_mesh(const Source &source, const std::vector<int> &surfaces)
    {
      gmsh::vectorpair all;
      gmsh::model::getEntities(all);
      gmsh::model::setVisibility(all, 0);
      gmsh::vectorpair workpiece;
      for (const int surface : surfaces)
        workpiece.emplace_back(2, surface);
      gmsh::model::setVisibility(workpiece, 1, /* recursive = */ true);
      gmsh::option::setNumber("Mesh.MeshOnlyVisible", 1);

      double algorithm = 0;
      gmsh::option::getNumber("Mesh.Algorithm", algorithm);
      if (algorithm == 8)
        gmsh::option::setNumber("Mesh.Algorithm", algorithm = 6);
      const double size = source.parameters.element_size;
      check_element_size(source, surfaces);
      if (size > 0)
        {
          gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
          gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", 0);
          gmsh::option::setNumber("Mesh.MeshSizeMin", size);
          gmsh::option::setNumber("Mesh.MeshSizeMax", size);
          note_idle_size(source, surfaces);
        }

      double recombination = 0;
      gmsh::option::getNumber("Mesh.RecombinationAlgorithm", recombination);
      std::vector<std::pair<double, double>> attempts = { { algorithm, recombination } };
      for (const auto &[other_algorithm, other_recombination] : more_algorithms)
        attempts.emplace_back(other_algorithm, other_recombination);

      const auto mesh = [&]() {
        for (const auto &[attempted_algorithm, attempted_recombination] : attempts)
          {
            gmsh::model::mesh::clear();
            gmsh::option::setNumber("Mesh.RecombinationAlgorithm", attempted_recombination);
            for (const int surface : surfaces)
              {
                // It may have its own: 8 must not get through.
                gmsh::model::mesh::setAlgorithm(2, surface, static_cast<int>(attempted_algorithm));
                // Mesh.Smoothing is for unstructured surfaces: it would undo the grading of a
                // transfinite one, which looks at this constraint first.
                gmsh::model::mesh::setSmoothing(2, surface, 0);
              }
            std::srand(1); // gmsh shifts points at random, and seeds only once per process
            gmsh::model::mesh::generate(2);
            if (count_non_quadrilaterals(surfaces) == 0 && smallest_corner_sine(surfaces) > 0.1)
              break;
          }
        gmsh::model::mesh::setOrder(2);
      };
      if (source.session.holds_cad() || source.session.mentions("Merge") ||
          source.session.mentions("OpenCASCADE"))
        source.session.try_out("meshing the workpiece", mesh);
      source.session.run("meshing the workpiece", mesh);
    }

    /// Nodes of an element in the order of FE_Q(2), from gmsh's: corners counter-clockwise, middles
    /// of the edges between them, centre. Elements listed clockwise are turned over, nodes that are
    /// not there (4- and 8-node elements) filled in.
    std::array<Point, 9> lexicographic(std::vector<Point> x, std::array<unsigned int, 4> &corners)
    {
      if (x.size() == 4)
        for (unsigned int k = 0; k < 4; ++k)
          x.push_back(Point((x[k] + x[(k + 1) % 4]) / 2.));
      if (x.size() == 8)
        {
          Point centre; // of the serendipity element
          for (unsigned int k = 0; k < 8; ++k)
            centre += (k < 4 ? -0.25 : 0.5) * x[k];
          x.push_back(centre);
        }

      const Vector2 diagonal = x[2] - x[0], other = x[3] - x[1];
      if (diagonal[0] * other[1] - diagonal[1] * other[0] < 0)
        {
          std::swap(corners[1], corners[3]);
          x = { x[0], x[3], x[2], x[1], x[7], x[6], x[5], x[4], x[8] };
        }
      std::swap(corners[2], corners[3]);
      return { { x[0], x[1], x[3], x[2], x[7], x[5], x[4], x[6], x[8] } };
    }

    /// Cells and vertices of the surfaces, vertices in the order of gmsh's tags. Returns the number
    /// of each vertex by its tag.
    std::map<std::size_t, unsigned int>
    take_cells(const Source &source, const std::vector<int> &surfaces, WorkpieceMesh &mesh)
    {
      Point              place;
      const unsigned int n_others = count_non_quadrilaterals(surfaces, &place);
      if (n_others > 0)
        throw source.wrong(
            fmt::format(
                "the mesh of the workpiece has {} element(s) that are not quadrilaterals, the "
                "first at r = {:.6g}, z = {:.6g} mm",
                n_others, place[0], place[1]),
            "In a .geo, give curves an even number of elements, another Element size, or make the "
            "surface transfinite; a .msh has to be written with quadrilaterals only (Recombine "
            "Surface)");

      // All nodes of the model: a .msh does not always tell which ones bound a surface.
      std::vector<std::size_t> tags;
      std::vector<double>      x, parametric;
      gmsh::model::mesh::getNodes(tags, x, parametric, -1, -1, false, false);
      std::map<std::size_t, std::array<double, 3>> nodes;
      for (std::size_t i = 0; i < tags.size(); ++i)
        nodes[tags[i]] = { { x[3 * i], x[3 * i + 1], x[3 * i + 2] } };
      double size = 0;
      for (const auto &entry : nodes)
        size = std::max(size, std::abs(entry.second[0]) + std::abs(entry.second[1]));
      const auto node = [&](const std::size_t tag) {
        const std::array<double, 3> &y = nodes.at(tag);
        if (std::abs(y[2]) > 1e-6 * size)
          throw source.wrong(fmt::format("its mesh leaves gmsh's plane z = 0 (z = {:.6g})", y[2]),
                             "The section has to have x = r and y = z");
        return Point(y[0], y[1]);
      };

      std::map<std::size_t, unsigned int>   numbers;
      std::vector<std::vector<std::size_t>> quadrilaterals;
      for (const int surface : surfaces)
        {
          std::vector<int>                      types;
          std::vector<std::vector<std::size_t>> elements, element_nodes;
          gmsh::model::mesh::getElements(types, elements, element_nodes, 2, surface);
          for (std::size_t i = 0; i < types.size(); ++i)
            {
              const std::size_t n = element_nodes[i].size() / elements[i].size();
              if (n != 4 && n != 8 && n != 9)
                throw source.wrong(fmt::format("it has elements of {} nodes", n),
                                   "Write the .msh with first- or second-order elements");
              for (std::size_t e = 0; e < elements[i].size(); ++e)
                {
                  quadrilaterals.emplace_back(element_nodes[i].begin() + e * n,
                                              element_nodes[i].begin() + (e + 1) * n);
                  for (unsigned int v = 0; v < 4; ++v)
                    numbers[quadrilaterals.back()[v]] = 0;
                }
            }
        }
      if (quadrilaterals.empty())
        throw source.wrong(
            "the workpiece has no elements",
            "A .msh has to hold the elements of the workpiece's surface (gmsh leaves out "
            "those without a physical group if there are any groups)");

      for (auto &[tag, number] : numbers)
        {
          number = mesh.vertices.size();
          mesh.vertices.push_back(node(tag));
        }
      for (const std::vector<std::size_t> &quadrilateral : quadrilaterals)
        {
          std::vector<Point> element_points;
          for (const std::size_t tag : quadrilateral)
            element_points.push_back(node(tag));
          std::array<unsigned int, 4> corners;
          for (unsigned int v = 0; v < 4; ++v)
            corners[v] = numbers.at(quadrilateral[v]);
          mesh.cell_nodes.push_back(lexicographic(element_points, corners));
          mesh.cells.push_back(corners);
        }
      return numbers;
    }

    /// The end vertices of the four edges of a cell and the index of their middle in cell_nodes.
    constexpr std::array<std::array<unsigned int, 3>, 4> edges_of_cell = {
      { { { 0, 2, 4 } }, { { 1, 3, 5 } }, { { 0, 1, 6 } }, { { 2, 3, 7 } } }
    };

    /// Middle nodes of the edges with one cell only.
    std::map<Edge, Point> find_boundary(const Source &source, const WorkpieceMesh &mesh)
    {
      std::map<Edge, std::pair<unsigned int, Point>> count;
      for (unsigned int c = 0; c < mesh.cells.size(); ++c)
        for (const auto &[a, b, middle] : edges_of_cell)
          {
            auto &[n_cells, x] = count[edge_of(mesh.cells[c][a], mesh.cells[c][b])];
            if (++n_cells > 2)
              throw source.wrong(
                  fmt::format("three elements share an edge at r = {:.6g}, z = {:.6g} mm",
                              mesh.cell_nodes[c][middle][0], mesh.cell_nodes[c][middle][1]),
                  "Surfaces of the workpiece must not overlap");
            x = mesh.cell_nodes[c][middle];
          }
      std::map<Edge, Point> boundary;
      for (const auto &[edge, cells_and_middle] : count)
        if (cells_and_middle.first == 1)
          boundary[edge] = cells_and_middle.second;
      return boundary;
    }

    /// Names of edges from gmsh's physical curves.
    std::map<Edge, std::string> names_of_edges(const Source                              &source,
                                               const std::map<std::size_t, unsigned int> &numbers,
                                               const std::map<Edge, Point>               &boundary)
    {
      std::map<Edge, std::string> names;
      for (const std::string &group : source.session.group_names(1))
        for (const int curve : source.session.entities_of_group(1, group))
          {
            std::vector<int>                      types;
            std::vector<std::vector<std::size_t>> elements, nodes;
            gmsh::model::mesh::getElements(types, elements, nodes, 1, curve);
            for (std::size_t i = 0; i < types.size(); ++i)
              {
                const std::size_t n = nodes[i].size() / elements[i].size();
                for (std::size_t e = 0; e < elements[i].size(); ++e)
                  {
                    const auto a = numbers.find(nodes[i][e * n]);
                    const auto b = numbers.find(nodes[i][e * n + 1]);
                    if (a == numbers.end() || b == numbers.end())
                      continue; // not of the workpiece
                    const Edge edge = edge_of(a->second, b->second);
                    if (boundary.count(edge) == 0)
                      continue;
                    const auto [known, is_new] = names.emplace(edge, group);
                    if (!is_new && known->second != group)
                      throw source.wrong(fmt::format("the physical curves \"{}\" and \"{}\" have "
                                                     "an edge in common at r = {:.6g}, "
                                                     "z = {:.6g} mm",
                                                     known->second, group, boundary.at(edge)[0],
                                                     boundary.at(edge)[1]));
                  }
              }
          }
      return names;
    }

    /// An edge along the axis that is too far off to be put there and too near to be a bore.
    void check_bore(const Source &source, const WorkpieceMesh &mesh, const Edge &edge)
    {
      const Point  a = mesh.vertices[edge.first], b = mesh.vertices[edge.second];
      const double size = size_of_mesh(mesh), off = std::max(std::abs(a[0]), std::abs(b[0]));
      if (off < smallest_bore * size && std::abs(a[1] - b[1]) > 0.5 * a.distance(b))
        throw source.wrong(fmt::format("its edge from r = {:.6g}, z = {:.6g} mm to r = {:.6g}, z = "
                                       "{:.6g} mm is neither on the axis r = 0 nor a bore (what is "
                                       "less than {:.2g} mm off is taken for the axis)",
                                       a[0], a[1], b[0], b[1], line_tolerance * size),
                           "Draw the axis on r = 0");
    }

    /// The axis is what lies at r = 0, whether it has that name or none.
    void name_axis(const Source                &source,
                   const WorkpieceMesh         &mesh,
                   const std::map<Edge, Point> &boundary,
                   std::map<Edge, std::string> &names)
    {
      const double tolerance = line_rounding * size_of_mesh(mesh);
      for (const auto &[edge, middle] : boundary)
        {
          const bool at_zero = std::abs(mesh.vertices[edge.first][0]) <= tolerance &&
                               std::abs(mesh.vertices[edge.second][0]) <= tolerance &&
                               std::abs(middle[0]) <= tolerance;
          const auto name = names.find(edge);
          if (at_zero && name == names.end())
            names[edge] = "axis";
          else if (at_zero && name->second != "axis")
            throw source.wrong(
                fmt::format("the physical curve \"{}\" lies on the axis r = 0 at z = {:.6g} "
                            "mm, where only the name \"axis\" is allowed",
                            name->second, middle[1]));
          else if (!at_zero && name != names.end() && name->second == "axis")
            throw source.wrong(
                fmt::format("the physical curve \"axis\" has an edge at r = {:.6g}, z = {:.6g} mm, "
                            "which is not on r = 0",
                            middle[0], middle[1]),
                "The axis is found by itself; give this curve another name");
          else if (!at_zero)
            check_bore(source, mesh, edge);
        }
    }

    /// Material slides along a symmetry plane: its edges are straight, and in line where they meet.
    void check_symmetry(const Source                      &source,
                        const WorkpieceMesh               &mesh,
                        const std::map<Edge, Point>       &boundary,
                        const std::map<Edge, std::string> &names)
    {
      std::map<unsigned int, Vector2> direction_at;
      for (const auto &[edge, name] : names)
        {
          if (name != "symmetry")
            continue;
          const Point   a = mesh.vertices[edge.first], b = mesh.vertices[edge.second];
          const Point   middle    = boundary.at(edge);
          const Vector2 direction = (b - a) / a.distance(b);
          const auto    off_line  = [&](const Vector2 &d) {
            return std::abs(d[0] * direction[1] - d[1] * direction[0]);
          };
          bool straight = off_line(middle - a) <= 1e-6 * a.distance(b);
          for (const unsigned int v : { edge.first, edge.second })
            {
              const auto [known, is_new] = direction_at.emplace(v, direction);
              straight                   = straight && (is_new || off_line(known->second) <= 1e-6);
            }
          if (!straight)
            throw source.wrong(fmt::format("the physical curve \"symmetry\" is not straight at "
                                           "r = {:.6g}, z = {:.6g} mm",
                                           middle[0], middle[1]),
                               "A symmetry plane of the body is a straight line, as z = 0");
        }
    }

    void take_boundary(const Source                              &source,
                       const std::map<std::size_t, unsigned int> &numbers,
                       WorkpieceMesh                             &mesh)
    {
      std::map<Edge, Point>       boundary = find_boundary(source, mesh);
      std::map<Edge, std::string> names    = names_of_edges(source, numbers, boundary);
      name_axis(source, mesh, boundary, names);
      std::set<Edge> symmetry;
      for (const auto &[edge, name] : names)
        if (name == "symmetry")
          symmetry.insert(edge);
      put_on_symmetry(symmetry, mesh);
      boundary = find_boundary(source, mesh);
      check_symmetry(source, mesh, boundary, names);

      std::set<std::string> others;
      for (const auto &[edge, name] : names)
        if (name != "axis" && name != "symmetry" && name != "surface")
          others.insert(name);
      std::map<std::string, dealii::types::boundary_id> ids  = { { "surface", surface_id },
                                                                 { "axis", axis_id },
                                                                 { "symmetry", symmetry_id } };
      dealii::types::boundary_id                        next = symmetry_id + 1;
      for (const std::string &name : others)
        ids[name] = next++;

      for (const auto &[edge, middle] : boundary)
        {
          const auto        found = names.find(edge);
          const std::string name  = found == names.end() ? "surface" : found->second;
          mesh.boundary_ids[name] = ids.at(name);
          mesh.boundary_edges.push_back({ edge.first, edge.second, ids.at(name) });
        }
    }
  } // namespace

  WorkpieceMesh read_workpiece(const GeometryParameters &parameters,
                               const std::string        &section,
                               const std::string        &directory)
  {
    if (trim(parameters.file).empty())
      throw InputError::entry(section + "/Geometry file", parameters.file,
                              "a simulation needs a workpiece",
                              "a .geo, .msh, .step, .stp or .brep file");

    Source source{ parameters, section, resolve_path(directory, parameters.file), {} };
    set_mesh_options();
    source.session.open(
        source.file,
        parse_geometry_parameters(parameters.parameters, section + "/Geometry parameters"),
        section + "/Geometry file");
    const std::vector<int> surfaces = surfaces_of_workpiece(source);
    if (source.session.holds_mesh())
      note_idle_size(source, surfaces);
    else
      generate_mesh(source, surfaces);

    WorkpieceMesh                             mesh;
    const std::map<std::size_t, unsigned int> numbers = take_cells(source, surfaces, mesh);
    put_on_axis(mesh);
    take_boundary(source, numbers, mesh);
    const std::string fault = fault_of_mesh(mesh);
    if (!fault.empty())
      throw source.wrong(fault);
    return mesh;
  }
} // namespace axiforge::meshing
