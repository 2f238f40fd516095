// SPDX-License-Identifier: GPL-2.0-or-later
// CSV tables, geometry parameters and the gmsh session.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <deal.II/base/parameter_handler.h>

#include <gmsh.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/forked.h>
#include <axiforge/base/geometry_parameters.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/base/input_files.h>

using namespace axiforge;

namespace
{
  class Input : public ::testing::Test
  {
  protected:
    void SetUp() override
    {
      folder = (std::filesystem::temp_directory_path() /
                ("axiforge_input_" + std::to_string(::getpid())))
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

  template <typename Action>
  void expect_fault(const Action &action, const std::vector<std::string> &parts)
  {
    try
      {
        action();
        ADD_FAILURE() << "no InputError, expected: " << parts[0];
      }
    catch (const InputError &error)
      {
        for (const std::string &part : parts)
          EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
              << "\"" << part << "\" in: " << error.what();
      }
  }

  /// r of the model's last point.
  double radius()
  {
    std::vector<double> x;
    gmsh::model::getValue(0, 2, {}, x);
    return x.at(0);
  }

  const char *const line_geo =
      "DefineConstant[ Radius = {25, Name \"Radius\"} ];\n"
      "DefineConstant[ Plain = 3 ];\n"
      "Point(1) = {0, 0, 0}; Point(2) = {Radius, Plain, 0}; Line(1) = {1, 2};\n"
      "Physical Curve(\"tool\") = {-1}; Physical Curve(7) = {1};\n";
} // namespace

TEST_F(Input, CsvInItsVariants)
{
  for (const std::string text :
       { "# about\ntime_s, force_N\n0, 1.5 # first\n\n+2e-1,\t-3\n",
         "time_s;force_N\n0;1.5\n.2;-3\n", "\xEF\xBB\xBFtime_s force_N\r\n0   1.5\r\n0.2\t-3\r\n" })
    {
      const CsvTable table = read_csv(file("a.csv", text), "Entry");
      EXPECT_EQ(table.header, std::vector<std::string>({ "time_s", "force_N" }));
      EXPECT_EQ(table.find_column("force_N"), 1);
      EXPECT_EQ(table.find_column("force"), -1);
      EXPECT_EQ(table.rows, std::vector<std::vector<double>>({ { 0, 1.5 }, { 0.2, -3 } }));
    }
  // As spreadsheets write them.
  for (const std::string text :
       { "sep=;\ntime_s;force_N;\n0;1.5;\n;;\n0.2;-3;\n",
         "\"sep=,\"\n\"time_s\",\"force_N\"\n\"0\",1.5\n0.2,\"-3\"\n",
         "time_s,force_N\r0,1.5\r0.2,-3\r", "SEP=\t\ntime_s\tforce_N\n0\t1.5\n0.2\t-3\n" })
    {
      const CsvTable table = read_csv(file("a.csv", text), "Entry");
      EXPECT_EQ(table.header, std::vector<std::string>({ "time_s", "force_N" })) << text;
      EXPECT_EQ(table.rows, std::vector<std::vector<double>>({ { 0, 1.5 }, { 0.2, -3 } })) << text;
    }
  const CsvTable plain = read_csv(file("a.csv", "\n1,2\n3,4"), "Entry");
  EXPECT_TRUE(plain.header.empty());
  EXPECT_EQ(plain.columns(), 2u);
  EXPECT_EQ(plain.lines, std::vector<unsigned int>({ 2, 3 }));
  EXPECT_NE(plain.where(1).find("a.csv\", line 3"), std::string::npos);
}

TEST_F(Input, FaultyCsv)
{
  const auto fault = [&](const std::string &text, const std::vector<std::string> &parts) {
    expect_fault([&]() { read_csv(file("a.csv", text), "Tool/Table"); }, parts);
  };
  fault("a,b\n1,2\n1,x\n", { "Tool/Table", "a.csv", "\"x\"", "line 3" });
  fault("a,b\n1,2\n1\n", { "line 3", "1 entries", "2" });
  fault("a,b\n1,2,3\n", { "line 2", "3 entries" });
  fault("1,nan\n", { "nan" });
  fault("1,5;2,5\n1,5;3,5\n", { "1,5" }); // decimal commas: taken for a header, then found out
  fault("1,5;2,5\n1,5;3,5\n", { "line 1", "The decimal sign is a point" });
  fault("a,b\n1,5,2,5\n", { "line 2 has 4 entries", "The decimal sign is a point" });
  fault("a,b\n1,\xE2\x88\x92\x32\n", { "line 2", "U+2212 (minus sign)" });
  fault(std::string("\xFF\xFE"
                    "1\0,\0"
                    "2\0",
                    8),
        { "UTF-16" });
  fault("# nothing\n", { "0 row" });
  expect_fault([&]() { read_csv(folder + "/none.csv", "Tool/Table"); },
               { "Tool/Table", "none.csv" });
}

// Copies keep their places, whatever they are called, and a `.geo` finds what it includes.
TEST_F(Input, FilesOfAScene)
{
  namespace fs = std::filesystem;
  for (const char *sub : { "/scene/parts", "/library" })
    fs::create_directories(folder + sub);
  file("library/part.geo", "// of all\n");
  file("scene/parts/part.geo", "Point(1) = {0, 0, 0};\n");
  file("scene/billet.geo", "/* Include \"none.geo\"; */ // Merge \"none.geo\";\n"
                           "Include \"parts/part.geo\"; Name = \"Include\";\nMerge \"" +
                               folder + "/library/part.geo\";\nInclude \"missing.geo\";\n");
  file("library/billet.csv", "0, 1\n");
  const auto scene = [&](const std::string &table) {
    return "subsection Workpiece\n  set Geometry file    = billet.geo # default: x\nend\n"
           "subsection Material\n  set Table file = " +
           table + "\n  set Other = billet.geo\nend\n";
  };
  const std::string relative = scene("../library/billet.csv");
  const InputFiles  files(relative, folder + "/scene");
  EXPECT_EQ(
      files.with_copies(relative, "input"),
      "subsection Workpiece\n  set Geometry file    = input/scene/billet.geo # default: x\nend\n"
      "subsection Material\n  set Table file = input/library/billet.csv\n"
      "  set Other = billet.geo\nend\n");
  EXPECT_TRUE(files.has(folder + "/library/part.geo"));
  EXPECT_FALSE(files.has(folder + "/library/none.geo"));

  files.write(folder + "/results/input");
  for (const char *copy :
       { "scene/billet.geo", "scene/parts/part.geo", "library/part.geo", "library/billet.csv" })
    EXPECT_TRUE(fs::exists(folder + "/results/input/" + copy)) << copy;

  // The copies are the same scene, and they stay when they are kept where they lie.
  const InputFiles copies(files.with_copies(relative, "input"), folder + "/results");
  EXPECT_FALSE(copies.has(folder + "/library/part.geo"));
  copies.write(folder + "/results/input");
  const auto before = fingerprints_in(files.fingerprints()),
             after  = fingerprints_in(copies.fingerprints());
  ASSERT_EQ(before.size(), 2u);
  ASSERT_EQ(after.size(), 2u);
  for (unsigned int i = 0; i < 2; ++i)
    {
      EXPECT_EQ(before[i].entry, i == 0 ? "Workpiece/Geometry file" : "Material/Table file");
      EXPECT_EQ(before[i].checksum, after[i].checksum);
    }

  // An included file counts, and an absolute name is as good as a relative one.
  file("library/part.geo", "// of some\n");
  const auto changed = fingerprints_in(
      InputFiles(scene(folder + "/library/billet.csv"), folder + "/scene").fingerprints());
  EXPECT_NE(before[0].checksum, changed[0].checksum);
  EXPECT_EQ(before[1].checksum, changed[1].checksum);
}

TEST_F(Input, GeometryValues)
{
  EXPECT_TRUE(parse_geometry_parameters("  ", "E").empty());
  EXPECT_EQ(parse_geometry_parameters(" Radius = 25,Part/Height=1.5e1 ", "E"),
            GeometryValues({ { "Radius", 25 }, { "Part/Height", 15 } }));
  const auto fault = [](const std::string &text, const std::string &part) {
    expect_fault([&]() { parse_geometry_parameters(text, "Workpiece/Geometry parameters"); },
                 { "Workpiece/Geometry parameters", part });
  };
  fault("Radius", "\"Radius\" has no \"=\"");
  fault("Radius = x", "\"x\" for Radius");
  fault("= 3", "no name");
  fault("R = 3, R = 4", "twice");
  fault("R = 3,", "has no \"=\"");
}

TEST_F(Input, PathsCountFromTheFolderOfTheParameterFile)
{
  EXPECT_EQ(resolve_path("scenes", "geometry/a.geo"), "scenes/geometry/a.geo");
  EXPECT_EQ(resolve_path("scenes", "../a.geo"), "a.geo");
  EXPECT_EQ(resolve_path("scenes", "/tmp/a.geo"), "/tmp/a.geo");
  EXPECT_EQ(resolve_path("", "a.geo"), "a.geo");
}

TEST_F(Input, EntriesOfAGeometry)
{
  GeometryParameters       workpiece, tool;
  dealii::ParameterHandler prm;
  prm.enter_subsection("Workpiece");
  workpiece.declare_workpiece(prm);
  prm.leave_subsection();
  prm.enter_subsection("Tool upper");
  tool.declare_profile(prm);
  prm.leave_subsection();
  EXPECT_EQ(workpiece.physical_group, "workpiece");
  prm.parse_input_from_string("subsection Workpiece\n set Geometry file = a.geo\n"
                              " set Geometry parameters = Radius = 25, Height = 3\n"
                              " set Element size = 0.5\n set Refinement levels = 2\nend\n"
                              "subsection Tool upper\n set Physical group = upper die\nend\n");
  EXPECT_EQ(workpiece.file, "a.geo");
  EXPECT_EQ(workpiece.parameters, "Radius = 25, Height = 3");
  EXPECT_EQ(workpiece.element_size, 0.5);
  EXPECT_EQ(workpiece.refinement_levels, 2u);
  EXPECT_EQ(tool.physical_group, "upper die");
}

TEST_F(Input, GmshTakesParametersByTheirName)
{
  const std::string path = file("line.geo", line_geo);
  GmshSession       session;
  session.open(path);
  EXPECT_EQ(radius(), 25);
  session.open(path, { { "Radius", 31.5 } });
  EXPECT_EQ(radius(), 31.5);
  session.open(path); // nothing is left over
  EXPECT_EQ(radius(), 25);
  EXPECT_EQ(session.group_names(1), std::vector<std::string>({ "tool", "7" }));
  EXPECT_EQ(session.entities_of_group(1, "tool"), std::vector<int>({ 1 }));
  EXPECT_EQ(session.entities_of_group(1, "7"), std::vector<int>({ 1 }));
  EXPECT_TRUE(session.entities_of_group(1, "die").empty());

  for (const std::string name : { "Radios", "Plain" }) // the second has no Name
    expect_fault(
        [&]() {
          session.open(path, { { name, 3 } }, "Tool/Geometry file");
        },
        { "Tool/Geometry file", "\"" + name + "\"", "\"Radius\"", "DefineConstant" });
}

TEST_F(Input, GmshSessionsNestAndSurviveErrors)
{
  const std::string good = file("line.geo", line_geo);
  GmshSession       outer;
  {
    GmshSession inner;
    expect_fault(
        [&]() {
          inner.open(file("bad.geo", "Point(1) = {0, 0, 0};\nLine(1) = {1, 7};\nx = y;\n"), {},
                     "E");
        },
        { "E", "bad.geo", "line 2", "Unknown variable 'y'" });
    inner.open(good);
  }
  EXPECT_EQ(radius(), 25);
  outer.open(good, { { "Radius", 4 } });
  EXPECT_EQ(radius(), 4);
}

TEST_F(Input, GmshAfterGmsh)
{
  for (unsigned int i = 0; i < 3; ++i)
    {
      GmshSession session;
      session.open(file("line.geo", line_geo), { { "Radius", 1. + i } });
      EXPECT_EQ(radius(), 1. + i);
    }
}

TEST(Forked, TellsHowTheChildEnded)
{
  EXPECT_EQ(fate_of([] {}), "");
  EXPECT_EQ(fate_of([] { throw InputError("the parent meets it again"); }), "");
  EXPECT_EQ(fate_of([] { std::exit(0); }), "ended the process");
  EXPECT_EQ(fate_of([] { std::abort(); }).rfind("crashed (", 0), 0u);
  EXPECT_EQ(fate_of([] { std::raise(SIGSEGV); }).rfind("crashed (", 0), 0u);
}

TEST_F(Input, CommandsThatReachBeyondTheGeometry)
{
  const auto refused = [&](const std::string &text, const std::vector<std::string> &parts) {
    expect_fault([&]() { GmshSession().open(file("a.geo", line_geo + text), {}, "E"); }, parts);
  };
  const std::string called = folder + "/called";
  refused("SystemCall \"touch " + called + "\";", { "E", "a.geo", "SystemCall", "runs a program" });
  refused("NonBlockingSystemCall(\"touch " + called + "\");", { "runs a program" });
  EXPECT_FALSE(std::filesystem::exists(called));
  refused("Exit ;", { "would end the program" });
  file("b.geo", "/* Exit; */ If (1)\n Exit;\nEndIf\n");
  refused("Include \"b.geo\";", { "a.geo", "b.geo", "Exit" });
  refused("Merge \"b.geo\";", { "b.geo", "Exit" });
  GmshSession().open(
      file("c.geo", std::string(line_geo) + "// Exit;\nExited = 1; /* SystemCall */"));
}

TEST_F(Input, DamagedStepFiles)
{
  const std::string path = folder + "/disc.step";
  {
    GmshSession session;
    session.run("writing", [&] {
      gmsh::clear();
      gmsh::model::occ::addRectangle(0, 0, 0, 10, 5);
      gmsh::model::occ::synchronize();
      gmsh::write(path);
    });
  }
  std::ifstream     in(path);
  const std::string text{ std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>() };
  GmshSession().open(path);
  const auto damaged = [&](const std::string &name, const std::string &part,
                           const std::string &other) {
    std::string       changed = text;
    const std::size_t at      = text.find(part);
    ASSERT_NE(at, std::string::npos) << text;
    changed.replace(at, part.size(), other);
    const std::string damaged_path = file(name, changed);
    expect_fault([&]() { GmshSession().open(damaged_path, {}, "E"); },
                 { "E", name, "it is damaged", "Export it anew" });
  };
  damaged("cut.step", "END-ISO-10303-21;", "");
  const std::size_t line  = text.rfind('\n', text.find("= LINE("));
  const std::string curve = text.substr(line + 1, text.find(';', line) - line);
  damaged("missing.step", curve, "");
  damaged("point.step", curve,
          curve.substr(0, curve.find('=')) + "= CARTESIAN_POINT('',(0.,0.,0.));");
}

TEST_F(Input, FaultyGmshFiles)
{
  GmshSession session;
  expect_fault([&]() { session.open(folder + "/none.geo", {}, "E"); },
               { "E", "none.geo", "no such file" });
  expect_fault([&]() { session.open(folder + "/a.txt", {}, "E"); }, { "a.txt", ".geo, .msh" });
  expect_fault(
      [&]() {
        session.open(file("a.msh", ""), { { "R", 1 } }, "E");
      },
      { "parameters", ".geo only" });
  expect_fault([&]() { session.open(file("a.geo", "x = 1; Exit ;\n"), {}, "E"); }, { "Exit" });
  session.open(
      file("a.geo", "// Exit;\nPrintf(\"Exit;\"); /* Exit; */ DoExit = 1;\n")); // none of these
  expect_fault([&]() { session.open(file("a.step", "nonsense\n"), {}, "E"); }, { "E", "a.step" });
  expect_fault([&]() { session.open(file("a.msh", "nonsense\n"), {}, "E"); }, { "E", "a.msh" });
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
