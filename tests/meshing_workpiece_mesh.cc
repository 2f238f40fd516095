// SPDX-License-Identifier: GPL-2.0-or-later
// The workpiece's mesh from gmsh, its checks, and its way into deal.II. Runs on several ranks, too.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_fe_field.h>

#include <gmsh.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/base/notes.h>
#include <axiforge/meshing/mesh_checks.h>
#include <axiforge/meshing/workpiece_mesh.h>

using namespace axiforge;
using namespace axiforge::meshing;
using Vector        = dealii::LinearAlgebra::distributed::Vector<double>;
using Triangulation = dealii::parallel::distributed::Triangulation<2>;

namespace
{
  const std::string geometry = AXIFORGE_PARAMETER_FILES "/geometry/";

  WorkpieceMesh read(const std::string &file,
                     const std::string &values = "",
                     const double       size   = 0,
                     const std::string &group  = "workpiece")
  {
    GeometryParameters parameters;
    parameters.file           = file;
    parameters.parameters     = values;
    parameters.element_size   = size;
    parameters.physical_group = group;
    return read_workpiece(parameters, "Workpiece", geometry);
  }

  unsigned int n_edges(const WorkpieceMesh &mesh, const std::string &name)
  {
    const auto id = mesh.boundary_ids.find(name);
    if (id == mesh.boundary_ids.end())
      return 0;
    return std::count_if(mesh.boundary_edges.begin(), mesh.boundary_edges.end(),
                         [&](const auto &edge) { return edge.id == id->second; });
  }

  class Files : public ::testing::Test
  {
  protected:
    void SetUp() override
    {
      folder =
          (std::filesystem::temp_directory_path() / ("axiforge_mesh_" + std::to_string(::getpid())))
              .string();
      std::filesystem::create_directories(folder);
    }

    void TearDown() override
    {
      std::filesystem::remove_all(folder);
    }

    std::string file(const std::string &name, const std::string &text) const
    {
      const std::string path = folder + "/" + name;
      std::ofstream(path) << text;
      return path;
    }

    /// A .msh of given nodes (z = 0) and elements, all in one physical surface "workpiece".
    std::string msh(const std::vector<Point>                     &nodes,
                    const std::vector<std::vector<unsigned int>> &elements) const
    {
      std::string text =
          "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"workpiece\"\n"
          "$EndPhysicalNames\n$Nodes\n" +
          std::to_string(nodes.size()) + "\n";
      for (unsigned int i = 0; i < nodes.size(); ++i)
        text += std::to_string(i + 1) + " " + std::to_string(nodes[i][0]) + " " +
                std::to_string(nodes[i][1]) + " 0\n";
      text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
      for (unsigned int e = 0; e < elements.size(); ++e)
        {
          text += std::to_string(e + 1) + (elements[e].size() == 4 ? " 3" : " 2") + " 2 1 1";
          for (const unsigned int v : elements[e])
            text += " " + std::to_string(v);
          text += "\n";
        }
      return file("mesh.msh", text + "$EndElements\n");
    }

    void expect_fault(const std::string              &path,
                      const std::vector<std::string> &parts,
                      const std::string              &group = "workpiece") const
    {
      try
        {
          read(path, "", 0, group);
          ADD_FAILURE() << "no InputError, expected: " << parts[0];
        }
      catch (const InputError &error)
        {
          const std::string text = error.what();
          EXPECT_NE(text.find("Workpiece/"), std::string::npos) << text;
          for (const std::string &part : parts)
            EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" in: " << text;
        }
    }

    std::string folder;
  };

  /// A section with a curved outline, z = 0 for symmetry: a quarter circle of radius 10 on r, z
  /// axes.
  const char *const quarter_disc = "Point(1) = {0, 0, 0, 2}; Point(2) = {10, 0, 0, 2};\n"
                                   "Point(3) = {0, 10, 0, 2};\n"
                                   "Line(1) = {1, 2}; Circle(2) = {2, 1, 3}; Line(3) = {3, 1};\n"
                                   "Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};\n"
                                   "Physical Surface(\"workpiece\") = {1};\n"
                                   "Physical Curve(\"symmetry\") = {1};\n";

  const double sphere_volume = 2. / 3 * M_PI * 1000;

  /// The triangulation with its position field.
  struct Body
  {
    explicit Body(const WorkpieceMesh &mesh)
        : triangulation(MPI_COMM_WORLD)
        , element(dealii::FE_Q<2>(2), 2)
        , dofs(triangulation)
    {
      create_triangulation(mesh, triangulation);
      dofs.distribute_dofs(element);
      dealii::IndexSet relevant;
      dealii::DoFTools::extract_locally_relevant_dofs(dofs, relevant);
      position.reinit(dofs.locally_owned_dofs(), relevant, MPI_COMM_WORLD);
      interpolate_geometry(mesh, dofs, position);
    }

    /// Through deal.II's mapping.
    double volume() const
    {
      const dealii::MappingFEField<2, 2, Vector> mapping(dofs, position);
      dealii::FEValues<2>                        values(mapping, element, dealii::QGauss<2>(5),
                                                        dealii::update_JxW_values | dealii::update_quadrature_points);
      double                                     volume = 0;
      for (const auto &cell : dofs.active_cell_iterators())
        if (cell->is_locally_owned())
          {
            values.reinit(cell);
            for (const unsigned int q : values.quadrature_point_indices())
              {
                EXPECT_GT(values.JxW(q), 0);
                volume += 2 * M_PI * values.quadrature_point(q)[0] * values.JxW(q);
              }
          }
      return dealii::Utilities::MPI::sum(volume, MPI_COMM_WORLD);
    }

    Triangulation         triangulation;
    dealii::FESystem<2>   element;
    dealii::DoFHandler<2> dofs;
    Vector                position;
  };
} // namespace

TEST(Geometry, Cylinder)
{
  const WorkpieceMesh mesh =
      read("cylinder.geo", "Radius = 20, Height = 30, RadialCells = 5, AxialCells = 7");
  EXPECT_EQ(mesh.cells.size(), 35u);
  EXPECT_EQ(mesh.vertices.size(), 48u);
  EXPECT_EQ(n_edges(mesh, "axis"), 7u);
  EXPECT_EQ(n_edges(mesh, "symmetry"), 5u);
  EXPECT_EQ(n_edges(mesh, "surface"), 12u);
  EXPECT_EQ(mesh.boundary_ids.size(), 3u);
  EXPECT_NEAR(mesh.volume(), M_PI * 400 * 30, 1e-8);
  for (const auto &edge : mesh.boundary_edges)
    {
      const Point a = mesh.vertices[edge.v0], b = mesh.vertices[edge.v1];
      EXPECT_EQ(edge.id == axis_id, a[0] == 0 && b[0] == 0);
      EXPECT_EQ(edge.id == symmetry_id, std::abs(a[1]) < 1e-12 && std::abs(b[1]) < 1e-12);
    }
}

TEST(Geometry, GradedCylinderIsFinestAtThePlatenEdge)
{
  const WorkpieceMesh mesh = read(
      "cylinder.geo", "Radius = 20, Height = 30, RadialCells = 6, AxialCells = 6, Grading = 4");
  std::vector<double> r, z;
  for (const Point &x : mesh.vertices)
    {
      if (std::abs(x[1]) < 1e-9)
        r.push_back(x[0]);
      if (x[0] == 0)
        z.push_back(x[1]);
    }
  ASSERT_EQ(r.size(), 7u);
  ASSERT_EQ(z.size(), 7u);
  std::sort(r.begin(), r.end());
  std::sort(z.begin(), z.end());
  EXPECT_NEAR((r[1] - r[0]) / (r[6] - r[5]), 4, 1e-6);
  EXPECT_NEAR((z[1] - z[0]) / (z[6] - z[5]), 4, 1e-6);
}

TEST(Geometry, TheOthers)
{
  const WorkpieceMesh full = read("cylinder_full.geo", "Grading = 3");
  EXPECT_EQ(full.cells.size(), 18u * 36u);
  EXPECT_EQ(n_edges(full, "symmetry"), 0u);
  EXPECT_EQ(n_edges(full, "surface"), 18u * 2 + 36u);
  EXPECT_NEAR(full.volume(), M_PI * 625 * 50, 1e-7);

  for (const std::string grading : { "", "Grading = 3" })
    {
      const WorkpieceMesh ring = read("ring.geo", grading);
      EXPECT_EQ(n_edges(ring, "axis"), 0u);
      EXPECT_EQ(n_edges(ring, "symmetry"), 24u);
      EXPECT_EQ(n_edges(ring, "surface"), 24u + 2 * 16u);
      EXPECT_NEAR(ring.volume(), M_PI * (18 * 18 - 9 * 9) * 6, 1e-8);
    }

  const WorkpieceMesh tube = read("tube.geo");
  EXPECT_EQ(n_edges(tube, "symmetry"), 16u);
  EXPECT_EQ(n_edges(tube, "inner"), 4u);
  EXPECT_EQ(n_edges(tube, "outer"), 4u);
  EXPECT_EQ(n_edges(tube, "surface"), 0u);
  EXPECT_EQ(tube.boundary_ids.at("inner"), 3u);
  EXPECT_EQ(tube.boundary_ids.at("outer"), 4u);

  const WorkpieceMesh sphere = read("sphere.geo");
  EXPECT_EQ(n_edges(sphere, "axis"), 8u);
  EXPECT_EQ(n_edges(sphere, "symmetry"), 8u);
  EXPECT_EQ(n_edges(sphere, "inner"), 12u);
  EXPECT_EQ(n_edges(sphere, "outer"), 12u);
}

TEST(Geometry, CurvedShellConvergesWithOrderFour)
{
  const double exact = 2. / 3 * M_PI * (8000 - 1000);
  const auto   error = [&](const std::string &cells) {
    return std::abs(read("sphere.geo", cells).volume() / exact - 1);
  };
  const double coarse = error("RadialCells = 2, MeridionalCells = 4");
  const double fine   = error("RadialCells = 4, MeridionalCells = 8");
  EXPECT_LT(coarse, 1e-3);
  EXPECT_GT(std::log2(coarse / fine), 3.8);
}

TEST_F(Files, UnstructuredQuadrilateralsWithACurvedOutline)
{
  const std::string   path = file("disc.geo", quarter_disc);
  const WorkpieceMesh mesh = read(path);
  EXPECT_GT(mesh.cells.size(), 15u);
  EXPECT_NEAR(mesh.volume(), sphere_volume, 1e-4 * sphere_volume);
  EXPECT_GT(n_edges(mesh, "axis"), 2u); // found by itself
  EXPECT_GT(n_edges(mesh, "symmetry"), 2u);

  // the same to the last bit
  const WorkpieceMesh again = read(path);
  EXPECT_EQ(mesh.vertices, again.vertices);
  EXPECT_EQ(mesh.cells, again.cells);
  EXPECT_EQ(mesh.cell_nodes, again.cell_nodes);

  // an element size of one half quadruples the elements, more or less
  const double ratio = double(read(path, "", 1).cells.size()) / read(path, "", 2).cells.size();
  EXPECT_GT(ratio, 2.5);
  EXPECT_LT(ratio, 6);
}

TEST_F(Files, PositionFieldLiesOnTheOutline)
{
  for (const double size : { 3., 1.5, 0.8 })
    {
      WorkpieceMesh mesh       = read(file("disc.geo", quarter_disc), "", size);
      const double  own_volume = mesh.volume();
      share_from_first_rank(mesh, MPI_COMM_WORLD);
      EXPECT_NEAR(mesh.volume(), own_volume, 1e-8 * own_volume);
      const Body body(mesh);
      EXPECT_EQ(body.triangulation.n_global_active_cells(), mesh.cells.size());
      EXPECT_NEAR(body.volume(), mesh.volume(), 1e-10 * mesh.volume());

      std::set<dealii::types::boundary_id>         ids;
      std::vector<dealii::types::global_dof_index> dofs(body.element.n_dofs_per_face());
      for (const auto &cell : body.dofs.active_cell_iterators())
        if (cell->is_locally_owned())
          for (const auto &face : cell->face_iterators())
            if (face->at_boundary())
              {
                ids.insert(face->boundary_id());
                face->get_dof_indices(dofs);
                for (unsigned int i = 0; i < dofs.size(); i += 2) // r and z of a node in turn
                  {
                    const double r = body.position(dofs[i]), z = body.position(dofs[i + 1]);
                    const double off_outline = face->boundary_id() == axis_id ? r
                                               : face->boundary_id() == symmetry_id
                                                   ? z
                                                   : std::hypot(r, z) - 10;
                    EXPECT_NEAR(off_outline, 0, 1e-9);
                  }
              }
      if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
        {
          const std::set<dealii::types::boundary_id> expected = { surface_id, axis_id,
                                                                  symmetry_id };
          EXPECT_EQ(ids, expected);
        }
    }
}

TEST_F(Files, FieldOfEveryCellIsThatOfTheMeshWhateverItsRotation)
{
  // Cells that begin with any of their vertices: deal.II has to rotate some.
  WorkpieceMesh mesh = read(file("disc.geo", quarter_disc), "", 1.5);
  for (unsigned int c = 0; c < mesh.cells.size(); ++c)
    for (unsigned int turn = 0; turn < c % 4; ++turn)
      {
        const auto v       = mesh.cells[c];
        const auto x       = mesh.cell_nodes[c];
        mesh.cells[c]      = { { v[2], v[0], v[3], v[1] } };
        mesh.cell_nodes[c] = { { x[2], x[0], x[3], x[1], x[7], x[6], x[4], x[5], x[8] } };
      }
  share_from_first_rank(mesh, MPI_COMM_WORLD);
  const Body body(mesh);
  EXPECT_NEAR(body.volume(), mesh.volume(), 1e-10 * mesh.volume());
  unsigned int n_rotated = 0;
  for (const auto &cell : body.dofs.active_cell_iterators())
    if (cell->is_locally_owned())
      {
        std::vector<dealii::types::global_dof_index> dofs(18);
        cell->get_dof_indices(dofs);
        const std::array<Point, 9> &nodes = mesh.cell_nodes[cell->index()];
        for (unsigned int i = 0; i < 18; i += 2)
          {
            const Point x(body.position(dofs[i]), body.position(dofs[i + 1]));
            EXPECT_TRUE(std::any_of(nodes.begin(), nodes.end(),
                                    [&](const Point &y) { return x.distance(y) < 1e-12; }));
          }
        n_rotated += cell->vertex_index(0) != mesh.cells[cell->index()][0];
      }
  if (dealii::Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD) == 1)
    {
      EXPECT_GT(n_rotated, 0u);
    }
}

TEST_F(Files, ToolsInTheSameFileAreLeftOut)
{
  const WorkpieceMesh mesh =
      read(file("both.geo", std::string(quarter_disc) +
                                "Point(11) = {0, 11, 0, 1}; Point(12) = {30, 11, 0, 1};\n"
                                "Point(13) = {30, 15, 0, 1}; Point(14) = {0, 15, 0, 1};\n"
                                "Line(11) = {11, 12}; Line(12) = {12, 13}; Line(13) = {13, 14};\n"
                                "Line(14) = {14, 11}; Curve Loop(11) = {11, 12, 13, 14};\n"
                                "Plane Surface(11) = {11}; Physical Surface(\"die\") = {11};\n"
                                "Physical Curve(\"upper\") = {11};\n"));
  for (const Point &x : mesh.vertices)
    EXPECT_LT(x[1], 10.5);
  EXPECT_EQ(mesh.boundary_ids.count("upper"), 0u);
}

TEST_F(Files, AHubIsMeshedWithGoodQuadrilaterals)
{
  const std::string path = file(
      "hub.geo",
      "Point(1) = {0, 0, 0}; Point(2) = {30, 0, 0}; Point(3) = {30, 8, 0}; Point(4) = {14, 8, 0};\n"
      "Point(5) = {12, 10, 0}; Point(6) = {12, 25, 0}; Point(7) = {5, 25, 0}; Point(8) = {5, 18, "
      "0};\n"
      "Point(9) = {0, 18, 0}; Point(10) = {14, 10, 0};\n"
      "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Circle(4) = {4, 10, 5};\n"
      "Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 9}; Line(9) = {9, 1};\n"
      "Curve Loop(1) = {1 : 9}; Plane Surface(1) = {1};\n");
  for (const double size : { 3., 2., 1.3, 1. })
    {
      const WorkpieceMesh mesh  = read(path, "", size);
      double              worst = 1;
      for (const auto &nodes : mesh.cell_nodes)
        {
          double smallest = 1e300, largest = 0;
          for (const double x : { 0., 1. })
            for (const double y : { 0., 1. })
              {
                const double j = jacobian(nodes, Point(x, y));
                smallest       = std::min(smallest, j);
                largest        = std::max(largest, j);
              }
          worst = std::min(worst, smallest / largest);
        }
      EXPECT_GT(worst, 0.1) << size;
      EXPECT_GT(mesh.cells.size(), 410 / (size * size)); // the section has 410 mm^2
      EXPECT_LT(mesh.cells.size(), 4 * 410 / (size * size));
    }
}

TEST_F(Files, TheAlgorithmThatCrashesIsReplaced)
{
  const std::string text = quarter_disc;
  EXPECT_GT(read(file("eight.geo", text + "Mesh.Algorithm = 8;\n")).cells.size(), 15u);
  EXPECT_GT(read(file("eight.geo", text + "MeshAlgorithm Surface{1} = 8;\n")).cells.size(), 15u);
}

TEST_F(Files, FourAndNineNodesAndCad)
{
  const std::string step = folder + "/disc.step", first = folder + "/first.msh",
                    second = folder + "/second.msh";
  {
    GmshSession session;
    session.open(
        file("make.geo",
             "SetFactory(\"OpenCASCADE\");\nDisk(1) = {0, 0, 0, 10};\n"
             "Rectangle(2) = {0, 0, 0, 20, 20};\nBooleanIntersection(3) = {Surface{1}; Delete;}"
             "{Surface{2}; Delete;};\nPhysical Surface(\"workpiece\") = {3};\n"));
    session.run("writing", [&]() {
      gmsh::write(step);
      gmsh::option::setNumber("Mesh.Algorithm", 9);
      gmsh::option::setNumber("Mesh.RecombinationAlgorithm", 3);
      gmsh::option::setNumber("Mesh.RecombineAll", 1);
      gmsh::option::setNumber("Mesh.MeshSizeMax", 2);
      gmsh::model::mesh::generate(2);
      gmsh::write(first);
      gmsh::model::mesh::setOrder(2);
      gmsh::write(second);
    });
  }
  const WorkpieceMesh straight = read(first), curved = read(second), cad = read(step, "", 2);
  EXPECT_EQ(straight.cells.size(), curved.cells.size());
  EXPECT_LT(straight.volume(), 0.999 * sphere_volume); // chords
  EXPECT_NEAR(curved.volume(), sphere_volume, 1e-4 * sphere_volume);
  EXPECT_NEAR(cad.volume(), sphere_volume, 1e-4 * sphere_volume);
  EXPECT_GT(n_edges(curved, "axis"), 2u);
}

/// The workpiece of a STEP file that gmsh writes of a .geo with OpenCASCADE.
class CadFiles : public Files
{
protected:
  WorkpieceMesh read_step(const std::string &geo,
                          const std::string &face = "",
                          const std::string &unit = "") const
  {
    const std::string path = folder + "/part.step";
    std::filesystem::remove(path);
    {
      GmshSession session;
      session.open(file("make.geo", "SetFactory(\"OpenCASCADE\");\n" + geo));
      session.run("writing", [&]() { gmsh::write(path); });
    }
    if (!unit.empty())
      {
        const std::string millimetre = "SI_UNIT(.MILLI.,.METRE.)";
        std::ifstream     stream(path);
        std::string       text{ std::istreambuf_iterator<char>(stream), {} };
        const std::size_t at = text.find(millimetre);
        EXPECT_NE(at, std::string::npos);
        file("part.step", text.replace(at, millimetre.size(), unit));
      }
    GeometryParameters parameters;
    parameters.file         = path;
    parameters.face         = face;
    parameters.element_size = 2;
    return read_workpiece(parameters, "Workpiece", "");
  }

  std::string message(const std::string &geo, const std::string &face = "") const
  {
    try
      {
        read_step(geo, face);
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    return "no error";
  }
};

// A tube of 4 and 10 mm, 6 mm high, from z = 3 on, about each axis of the file.
TEST_F(CadFiles, SolidsAreCutAtTheirMeridian)
{
  const double volume = M_PI * (100 - 16) * 6;
  for (const std::string axis : { "0, 0, 6", "0, 6, 0", "6, 0, 0" })
    {
      const std::string start = axis[0] == '6' ? "3, 0, 0" : axis[3] == '6' ? "0, 3, 0" : "0, 0, 3";
      const WorkpieceMesh mesh = read_step(
          "Cylinder(1) = {" + start + ", " + axis + ", 10};\nCylinder(2) = {" + start + ", " +
          axis + ", 4};\nBooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n");
      EXPECT_NEAR(mesh.volume(), volume, 1e-6 * volume) << axis;
      for (const Point &x : mesh.vertices)
        {
          EXPECT_GT(x[0], 4 - 1e-6);
          if (axis[0] != '6')
            EXPECT_NEAR(x[1], 6, 3 + 1e-6);
        }
    }
  EXPECT_NEAR(read_step("Sphere(1) = {0, 0, 0, 10};\n").volume(), 2 * sphere_volume,
              1e-3 * sphere_volume);
  EXPECT_NE(message("Box(1) = {0, 0, 0, 3, 4, 5};\n").find("none of revolution"),
            std::string::npos);
}

// The same numbers in other units of the file: the mesh is in mm.
TEST_F(CadFiles, UnitsOfTheFileAreConverted)
{
  const std::string disc   = "Rectangle(1) = {0, 0, 0, 10, 5};\n";
  const double      volume = M_PI * 100 * 5;
  EXPECT_NEAR(read_step(disc).volume(), volume, 1e-6 * volume);
  EXPECT_NEAR(read_step(disc, "", "SI_UNIT(.CENTI.,.METRE.)").volume(), 1e3 * volume,
              1e-3 * volume);
  const std::string small = "Rectangle(1) = {0, 0, 0, 0.01, 0.005};\n";
  EXPECT_NEAR(read_step(small, "", "SI_UNIT($,.METRE.)").volume(), volume, 1e-6 * volume);
}

TEST_F(CadFiles, FacesAreChosenAndTurnedIntoThePlane)
{
  const std::string two  = "Rectangle(1) = {0, 0, 0, 10, 5};\nRectangle(2) = {20, 0, 0, 4, 5};\n";
  const double      disc = M_PI * 100 * 5, ring = M_PI * (24 * 24 - 20 * 20) * 5;
  EXPECT_NEAR(read_step(two, "largest").volume(), disc, 1e-6 * disc);
  EXPECT_NEAR(read_step(two, "2").volume(), ring, 1e-6 * ring);
  const std::string text = message(two);
  EXPECT_NE(text.find("its faces are 1 (50 mm^2), 2 (20 mm^2)"), std::string::npos) << text;
  EXPECT_NE(text.find("Set \"Workpiece/Face\""), std::string::npos) << text;
  EXPECT_NE(message(two, "3").find("\"Workpiece/Face\" = \"3\""), std::string::npos);

  const std::string one  = "Rectangle(1) = {2, 3, 0, 8, 5};\n";
  const double      tube = M_PI * (100 - 4) * 5;
  // Where rounding leaves the turned section off its plane, on the axis too.
  for (const std::string axis : { "1, 0, 0", "0, 1, 0" })
    for (const double size : { 7., 10., 12.5, 25., 80. })
      {
        const std::string text = fmt::format(
            "Rectangle(1) = {{0, 0, 0, {0}, {0}}};\nRotate{{ {{{1}}}, {{0, 0, 0}}, Pi/2 }}"
            "{{ Surface{{1}}; }}\n",
            size, axis);
        const double full = M_PI * std::pow(size, 3);
        EXPECT_NEAR(read_step(text).volume(), full, 1e-6 * full) << axis << ' ' << size;
      }
  for (const double r : { 12.5, 25. })
    {
      const double full = M_PI * r * r * r;
      EXPECT_NEAR(
          read_step(fmt::format("Cylinder(1) = {{0, 0, 0, {0}, 0, 0, {0}}};\n", r)).volume(), full,
          1e-6 * full);
    }
  for (const std::string turn : { "", "Rotate{ {1, 0, 0}, {0, 0, 0}, Pi/2 }{ Surface{1}; }\n",
                                  "Rotate{ {1, 0, 0}, {0, 0, 0}, Pi/2 }{ Surface{1}; }\nRotate{ "
                                  "{0, 0, 1}, {0, 0, 0}, Pi/2 }{ "
                                  "Surface{1}; }\n",
                                  "Translate{0, 0, 7}{ Surface{1}; }\n",
                                  "Rotate{ {0, 1, 0}, {0, 0, 0}, Pi }{ Surface{1}; }\n" })
    {
      const WorkpieceMesh mesh = read_step(one + turn);
      EXPECT_NEAR(mesh.volume(), tube, 1e-6 * tube) << turn;
      for (const Point &x : mesh.vertices)
        EXPECT_NEAR(x[1], 5.5, 2.5 + 1e-6) << turn;
    }
  EXPECT_NE(message(one + "Rotate{ {1, 0, 0}, {0, 0, 0}, 1 }{ Surface{1}; }\n")
                .find("plane of the file's axes"),
            std::string::npos);
}

TEST_F(Files, ASizeThatDoesNothingIsNoted)
{
  take_notes();
  const std::string free = file("disc.geo", quarter_disc);
  read(free, "", 2);
  EXPECT_TRUE(take_notes().empty());
  const std::string transfinite =
      file("square.geo",
           "Point(1) = {0, 0, 0, 2}; Point(2) = {10, 0, 0, 2}; Point(3) = {10, 10, 0, 2};\n"
           "Point(4) = {0, 10, 0, 2}; Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4};\n"
           "Line(4) = {4, 1}; Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};\n"
           "Transfinite Curve{1, 2, 3, 4} = 4; Transfinite Surface{1};\n");
  read(transfinite, "", 0);
  EXPECT_TRUE(take_notes().empty());
  EXPECT_EQ(read(transfinite, "", 1).cells.size(), 9u);
  const std::vector<std::string> notes = take_notes();
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("\"Workpiece/Element size\" = \"1\" does nothing"), std::string::npos);
}

TEST_F(Files, ClockwiseElementsAreTurnedOver)
{
  const WorkpieceMesh mesh =
      read(msh({ Point(0, 0), Point(0, 2), Point(3, 2), Point(3, 0) }, { { 1, 2, 3, 4 } }));
  EXPECT_NEAR(mesh.volume(), M_PI * 9 * 2, 1e-10);
  EXPECT_GT(jacobian(mesh.cell_nodes[0], Point(0.3, 0.8)), 0);
}

TEST_F(Files, FaultyMeshes)
{
  expect_fault(msh({ Point(0, 0), Point(2, 0), Point(2, 2), Point(0, 2), Point(4, 1) },
                   { { 1, 2, 3, 4 }, { 2, 5, 3 } }),
               { "1 element(s)", "not quadrilaterals" });
  expect_fault(msh({ Point(0, 0), Point(2, 0), Point(0.3, 0.3), Point(0, 2) }, { { 1, 2, 3, 4 } }),
               { "1 of 1 elements are inverted" });
  expect_fault(msh({ Point(0, 0), Point(2, 0), Point(1, 1), Point(0, 2) }, { { 1, 2, 3, 4 } }),
               { "angle of 180 degrees" });
  expect_fault(msh({ Point(-1, 0), Point(2, 0), Point(2, 2), Point(0, 2) }, { { 1, 2, 3, 4 } }),
               { "r = -1", "axis" });
  expect_fault(msh({ Point(0, 0), Point(2, 0), Point(2, 2), Point(0, 2), Point(2, 0), Point(4, 0),
                     Point(4, 2), Point(2, 2) },
                   { { 1, 2, 3, 4 }, { 5, 6, 7, 8 } }),
               { "same place", "r = 2, z = 0" });
  expect_fault(msh({ Point(0, 0), Point(2, 0), Point(2, 2), Point(0, 2), Point(3, 0), Point(4, 0),
                     Point(4, 2), Point(3, 2) },
                   { { 1, 2, 3, 4 }, { 5, 6, 7, 8 } }),
               { "not connected" });
  expect_fault(msh({ Point(0, 0), Point(2, 0), Point(2, 2), Point(0, 2), Point(4, 0), Point(4, 1),
                     Point(2, 1), Point(4, 2) },
                   { { 1, 2, 3, 4 }, { 2, 5, 6, 7 }, { 7, 6, 8, 3 } }),
               { "hangs on the edge", "r = 2, z = 1" });
}

TEST_F(Files, FaultyGeometry)
{
  expect_fault("none.geo", { "Workpiece/Geometry file", "none.geo", "no such file" });
  expect_fault("", { "Workpiece/Geometry file", "needs a workpiece" });
  expect_fault(geometry + "cylinder.geo", { "Workpiece/Physical group", "billet", "\"workpiece\"" },
               "billet");
  expect_fault(geometry + "platen.geo", { "0 surfaces" });
  const std::string text = quarter_disc;
  expect_fault(file("a.geo", text + "Physical Curve(\"axis\") = {2};\n"),
               { "\"axis\"", "not on r = 0" });
  expect_fault(file("a.geo", text + "Physical Curve(\"wall\") = {3};\n"),
               { "\"wall\"", "axis r = 0" });
  expect_fault(file("a.geo", text + "Physical Curve(\"floor\") = {1};\n"),
               { "\"floor\"", "\"symmetry\"", "in common" });
  expect_fault(file("a.geo", text.substr(0, text.find("Physical Curve")) +
                                 "Physical Curve(\"symmetry\") = {2};\n"),
               { "\"symmetry\" is not straight" });
  expect_fault(file("a.geo", "Point(1) = {0, 0, 0};\nLine(1) = {1, 2};\n"),
               { "gmsh failed", "line 2" });
}

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
