// SPDX-License-Identifier: GPL-2.0-or-later
// Tool profiles from CSV and gmsh, and the tools in parameter_files/geometry.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmsh.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <axiforge/base/errors.h>
#include <axiforge/tools/profile_reader.h>

using namespace axiforge;
using namespace axiforge::tools;

namespace
{
  const std::string geometry = AXIFORGE_PARAMETER_FILES "/geometry/";

  /// A folder for the files of this test, removed at its end.
  class Reader : public ::testing::Test
  {
  protected:
    void SetUp() override
    {
      folder = (std::filesystem::temp_directory_path() /
                ("axiforge_reader_" + std::to_string(::getpid())))
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

    std::string folder;
  };

  Contact nearest(const Profile &profile, const Point &x)
  {
    std::array<Contact, 2> contacts;
    EXPECT_GE(profile.find(x, 1e9, contacts), 1u);
    return contacts[0];
  }

  /// The message of the InputError that @p action throws.
  template <typename Action> std::string message(const Action &action)
  {
    try
      {
        action();
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    ADD_FAILURE() << "no InputError";
    return "";
  }

  void expect_all_in(const std::vector<std::string> &parts, const std::string &text)
  {
    for (const std::string &part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" in: " << text;
  }
} // namespace

TEST_F(Reader, CsvPolyline)
{
  Profile profile = read_profile_csv(
      file("die.csv", "# a die\nr_mm, z_mm\n0, 0\n8, 0 # the floor\n\n8, 20\n"), "Tool lower");
  profile.orient({ Point(0, 1), Point(7, 1), Point(7, 9) });
  EXPECT_EQ(profile.n_faces(), 2u);
  EXPECT_DOUBLE_EQ(profile.length(), 28);
  EXPECT_DOUBLE_EQ(nearest(profile, Point(7.5, 3)).gap, 0.5);

  // closed, with its middle on the axis, which is no surface
  const Profile block =
      read_profile_csv(file("block.csv", "0,0\n5,0\n5,3\n0,3\n0,0\n"), "Tool lower");
  EXPECT_DOUBLE_EQ(block.length(), 13);
}

TEST_F(Reader, CsvColumnsGoByTheirHeader)
{
  for (const std::string text : { "z_mm,r_mm\n2,0\n2,8\n", "z [mm];r [mm];\n2;0;\n2;8;\n",
                                  "Z,R\n2,0\n2,8\n", "y,x\n2,0\n2,8\n", "r_mm,z_mm\n0,2\n8,2\n",
                                  "0,2\n8,2\n", "\"height (mm)\",\"radius (mm)\"\n2,0\n2,8\n" })
    {
      Profile profile = read_profile_csv(file("die.csv", text), "Tool lower");
      profile.orient({ Point(1, 3), Point(4, 3), Point(4, 5) });
      EXPECT_DOUBLE_EQ(nearest(profile, Point(5, 3)).gap, 1) << text;
    }
  for (const std::string header : { "r_in,z_in", "r_m,z_m", "a,b", "r,r", "t,z" })
    {
      const std::string path = file("bad.csv", header + "\n0,2\n8,2\n");
      expect_all_in({ "bad.csv", "its header names the columns", "r_mm and z_mm" },
                    message([&]() { read_profile_csv(path, "Tool lower"); }));
    }
}

// A tool as a solid: its section's outline; a platen of 10 mm radius from z = 4 to 6.
TEST_F(Reader, SolidsOfCadFilesAreCut)
{
  const std::string step = folder + "/tool.step";
  for (const std::string axis : { "{0, 0, 4, 0, 0, 2, 10}", "{0, 4, 0, 0, 2, 0, 10}" })
    {
      {
        GmshSession session;
        session.open(
            file("make.geo", "SetFactory(\"OpenCASCADE\");\nCylinder(1) = " + axis + ";\n"));
        session.run("writing", [&]() { gmsh::write(step); });
      }
      Profile tool = read_profile_gmsh(step, "", {}, "Tool upper");
      tool.orient({ Point(0, 0), Point(5, 0) });
      EXPECT_NEAR(tool.length(), 10 + 2 + 10, 1e-9);
      EXPECT_NEAR(nearest(tool, Point(5, 1)).gap, 3, 1e-9);
    }
}

TEST_F(Reader, FaultyCsv)
{
  const auto fault = [&](const std::string &text) {
    const std::string path = file("bad.csv", text);
    return message([&]() { read_profile_csv(path, "Tool lower"); });
  };
  expect_all_in({ "Tool lower/Geometry file", "bad.csv", "1 row" }, fault("r_mm,z_mm\n0,0\n"));
  expect_all_in({ "line 3", "same" }, fault("0,0\n1,2\n1,2\n"));
  expect_all_in({ "line 2", "-1", "r >= 0" }, fault("0,0\n-1,2\n"));
  expect_all_in({ "line 2", "two" }, fault("0,0\n1,two\n"));
  expect_all_in({ "3 columns" }, fault("0,0,1\n1,2,3\n"));
  expect_all_in({ "line 2", "3 entries" }, fault("0,0\n1,2,3\n"));
  expect_all_in({ "Tool lower/Geometry file", "opened" },
                message([&]() { read_profile_csv(folder + "/none.csv", "Tool lower"); }));
}

TEST_F(Reader, LinesAndArcsOfAGeoAreExact)
{
  for (const std::string kernel : { "", "SetFactory(\"OpenCASCADE\");\n" })
    {
      const std::string path = file(
          "arc.geo", kernel + "Point(1) = {2, 0, 0}; Point(2) = {5, 0, 0}; Point(3) = {5, 3, 0};\n"
                              "Point(4) = {8, 3, 0}; Point(5) = {8, 9, 0};\n"
                              "Line(1) = {1, 2}; Circle(2) = {4, 3, 2}; Line(3) = {4, 5};\n"
                              "Physical Curve(\"die\") = {1, -2, 3};\n");
      Profile profile = read_profile_gmsh(path, "die", {}, "Tool lower");
      profile.orient({ Point(3, 5), Point(5, 5), Point(6, 8) });
      EXPECT_EQ(profile.n_faces(), 1u);
      EXPECT_NEAR(profile.length(), 3 + 1.5 * M_PI + 6, 1e-12);
      EXPECT_NEAR(nearest(profile, Point(6, 2)).gap, 3 - std::sqrt(2.), 1e-13);
      EXPECT_NEAR(nearest(profile, Point(6, 2)).curvature, -1. / 3, 1e-12);
    }
}

TEST_F(Reader, EllipsesAndSplinesToTheirTolerance)
{
  // Ellipse with the half axes 6 and 3 around (10, 0): radius of curvature 6^2/3 = 12 and 3^2/6
  // = 1.5.
  for (const std::string kernel : { "", "SetFactory(\"OpenCASCADE\");\n" })
    {
      const std::string path =
          file("ellipse.geo",
               kernel + "Point(1) = {10, 0, 0}; Point(2) = {16, 0, 0}; Point(3) = {10, 3, 0};\n"
                        "Ellipse(1) = {2, 1, 2, 3};\nPhysical Curve(\"tool\") = {1};\n");
      Profile profile = read_profile_gmsh(path, "tool", {}, "Tool upper");
      profile.orient({ Point(10, 5), Point(17, 5) });
      EXPECT_EQ(profile.n_faces(), 1u);
      const double size = std::hypot(6, 3);
      for (double a = 0.01; a < M_PI / 2; a += 0.01)
        {
          const Point   on(10 + 6 * std::cos(a), 3 * std::sin(a));
          const Vector2 normal({ std::cos(a) / 6, std::sin(a) / 3 });
          EXPECT_LT(std::abs(nearest(profile, on).gap), 1e-6 * size);
          const Contact contact = nearest(profile, on + normal / normal.norm());
          EXPECT_NEAR(contact.gap, 1, 1e-6 * size);
          EXPECT_LT((contact.normal - normal / normal.norm()).norm(), 1e-4);
        }
      EXPECT_NEAR(nearest(profile, Point(10.3, 4)).curvature, 1. / 12, 0.02 / 12);
      EXPECT_NEAR(nearest(profile, Point(17, 0.1)).curvature, 1. / 1.5, 0.02 / 1.5);
    }
}

TEST_F(Reader, SplineGoesThroughItsPoints)
{
  const std::string path = file(
      "spline.geo",
      "Point(1) = {0, 4, 0}; Point(2) = {3, 5, 0}; Point(3) = {6, 4.5, 0}; Point(4) = {9, 2, 0};\n"
      "Spline(1) = {1, 2, 3, 4}; Bezier(2) = {1, 2, 3, 4};\n"
      "Physical Curve(\"spline\") = {1}; Physical Curve(\"bezier\") = {2};\n");
  Profile spline = read_profile_gmsh(path, "spline", {}, "Tool upper");
  spline.orient({ Point(0, 0), Point(5, 0) });
  EXPECT_LT(std::abs(nearest(spline, Point(3, 5)).gap), 1e-5);
  EXPECT_LT(std::abs(nearest(spline, Point(6, 4.5)).gap), 1e-5);
  EXPECT_EQ(spline.n_faces(), 1u);

  // de Casteljau at 1/2
  Profile bezier = read_profile_gmsh(path, "bezier", {}, "Tool upper");
  bezier.orient({ Point(0, 0), Point(5, 0) });
  EXPECT_LT(std::abs(nearest(bezier, Point(36. / 8, (4 + 15 + 13.5 + 2) / 8)).gap), 1e-5);
}

TEST_F(Reader, MshAndCad)
{
  const std::string msh = folder + "/tool.msh", step = folder + "/tool.step";
  {
    GmshSession session;
    session.open(file("make.geo",
                      "SetFactory(\"OpenCASCADE\");\nRectangle(1) = {0, 2, 0, 10, 4, 1};\n"
                      "Physical Curve(\"all\") = Boundary{ Surface{1}; };\n"));
    session.run("writing", [&]() {
      gmsh::option::setNumber("Mesh.MeshSizeMax", 0.25);
      gmsh::write(step);
      gmsh::model::mesh::generate(1);
      gmsh::write(msh);
    });
  }
  // A rectangle with corners rounded by 1 mm; the CAD file's part on the axis is left out.
  Profile cad = read_profile_gmsh(step, "tool", {}, "Tool upper");
  cad.orient({ Point(0, 0), Point(5, 0) });
  EXPECT_NEAR(cad.length(), 8 + 2 + 8 + 2 * M_PI, 1e-9);
  EXPECT_NEAR(nearest(cad, Point(10, 2)).gap, std::sqrt(2.) - 1, 1e-9);
  EXPECT_NEAR(nearest(cad, Point(4, 3)).gap, -1, 1e-9);

  Profile mesh = read_profile_gmsh(msh, "all", {}, "Tool upper");
  mesh.orient({ Point(0, 0), Point(5, 0) });
  EXPECT_NEAR(nearest(mesh, Point(10, 2)).gap, std::sqrt(2.) - 1, 0.01);
  EXPECT_NEAR(nearest(mesh, Point(4, 1)).gap, 1, 1e-12);
}

TEST_F(Reader, FaultyFiles)
{
  const auto fault = [](const std::string &path, const std::string &group,
                        const GeometryValues &values = {}) {
    return message([&]() { read_profile_gmsh(path, group, values, "Tool upper"); });
  };
  expect_all_in({ "Tool upper/Physical group", "die", "\"tool\"" },
                fault(geometry + "platen.geo", "die"));
  expect_all_in({ "Tool upper/Geometry file", "Radios", "\"Radius\"", "\"Z\"" },
                fault(geometry + "platen.geo", "tool", { { "Radios", 3 } }));
  expect_all_in(
      { "r = -1" },
      fault(file("left.geo", "Point(1) = {-1, 0, 0}; Point(2) = {5, 0, 0}; Line(1) = {1, 2};\n"
                             "Physical Curve(\"tool\") = {1};\n"),
            "tool"));
  expect_all_in(
      { "plane z = 0" },
      fault(file("out.geo", "Point(1) = {1, 0, 0}; Point(2) = {5, 0, 3}; Line(1) = {1, 2};\n"
                            "Physical Curve(\"tool\") = {1};\n"),
            "tool"));
  expect_all_in({ "EdgeRadius = 11" },
                fault(geometry + "punch.geo", "tool", { { "EdgeRadius", 11 } }));
  expect_all_in(
      { "Tool upper", "empty" },
      fault(file("axis.geo", "Point(1) = {0, 0, 0}; Point(2) = {0, 5, 0}; Line(1) = {1, 2};\n"
                             "Physical Curve(\"tool\") = {1};\n"),
            "tool"));

  GeometryParameters parameters;
  expect_all_in({ "Tool upper/Geometry file" },
                message([&]() { read_profile(parameters, "Tool upper", folder); }));
  parameters.file       = "a.csv";
  parameters.parameters = "Radius = 3";
  expect_all_in({ "Tool upper/Geometry parameters" },
                message([&]() { read_profile(parameters, "Tool upper", folder); }));
}

TEST(ToolGeometry, Platen)
{
  GeometryParameters parameters;
  parameters.file           = "platen.geo";
  parameters.physical_group = "tool";
  parameters.parameters     = "Z = 12, Radius = 70";
  Profile platen            = read_profile(parameters, "Tool upper", geometry);
  platen.orient({ Point(0, 0), Point(30, 12), Point(30, 0) });
  EXPECT_DOUBLE_EQ(nearest(platen, Point(60, 10)).gap, 2);
  EXPECT_DOUBLE_EQ(platen.length(), 70);
}

TEST(ToolGeometry, Punch)
{
  const std::vector<Point> billet = { Point(0, 0), Point(40, 0), Point(40, 25), Point(0, 25) };
  Profile round = read_profile_gmsh(geometry + "punch.geo", "tool", {}, "Tool upper");
  round.orient(billet);
  EXPECT_EQ(round.n_faces(), 1u);
  EXPECT_NEAR(nearest(round, Point(10, 25)).gap, std::sqrt(2.) - 1, 1e-12);

  Profile sharp =
      read_profile_gmsh(geometry + "punch.geo", "tool", { { "EdgeRadius", 0 } }, "Tool upper");
  sharp.orient(billet);
  EXPECT_EQ(sharp.n_faces(), 2u);
  EXPECT_NEAR(nearest(sharp, Point(10, 25)).gap, 0, 1e-12);

  Profile ball =
      read_profile_gmsh(geometry + "punch.geo", "tool", { { "EdgeRadius", 10 } }, "Tool upper");
  ball.orient(billet);
  EXPECT_NEAR(nearest(ball, Point(0, 20)).gap, 5, 1e-12);
}

TEST(ToolGeometry, Cone)
{
  const GeometryValues values = {
    { "HalfAngle", 60 }, { "TipRadius", 5 }, { "CornerRadius", 3 }, { "Z", 10 }
  };
  Profile cone = read_profile_gmsh(geometry + "cone_tool.geo", "tool", values, "Tool upper");
  cone.orient({ Point(0, 0), Point(30, 0), Point(0, 10) });
  EXPECT_EQ(cone.n_faces(), 1u);
  EXPECT_NEAR(nearest(cone, Point(2, 9)).gap, 1, 1e-12);
  // the cone rises by 30 degrees
  EXPECT_NEAR(nearest(cone, Point(40, 20)).normal[0], 0.5, 1e-12);
  EXPECT_NEAR(nearest(cone, Point(40, 20)).normal[1], -std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(nearest(cone, Point(6, 11)).curvature, 1. / 3, 1e-12);

  Profile ball =
      read_profile_gmsh(geometry + "cone_tool.geo", "tool", { { "TipRadius", 0 } }, "Tool upper");
  ball.orient({ Point(0, 0), Point(30, 0) });
  EXPECT_NEAR(nearest(ball, Point(0, 24)).gap, 1, 1e-12);
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
