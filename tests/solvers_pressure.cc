// SPDX-License-Identifier: GPL-2.0-or-later
// Boundaries with a pressure: on each side of a section and of a cell, at the right time, against
// the closed solutions of tube and block.
#include <set>

#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double a = 10, b = 20, height = 5; // [mm]

  const std::array<std::string, 4> sides = { "inner", "outer", "bottom", "top" };

  /// A tube in cells, each side with the name it is given; nothing: part of the free surface.
  std::string tube(const TemporaryFolder &folder, const std::array<std::string, 4> &names)
  {
    std::string            text     = R"(
Point(1) = {10, 0, 0};
Point(2) = {20, 0, 0};
Point(3) = {20, 5, 0};
Point(4) = {10, 5, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 9;
Transfinite Curve{2, 4} = 3;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};
Physical Surface("workpiece") = {1};
)";
    constexpr unsigned int curve[4] = { 4, 2, 1, 3 };
    for (const std::string &name : std::set<std::string>(names.begin(), names.end()))
      if (!name.empty())
        {
          std::vector<unsigned int> curves;
          for (unsigned int i = 0; i < 4; ++i)
            if (names[i] == name)
              curves.push_back(curve[i]);
          text += fmt::format("Physical Curve(\"{}\") = {{{}}};\n", name, fmt::join(curves, ", "));
        }
    return folder.file("tube.geo", text);
  }


  /// Turns every cell by so many quarters: its left side becomes the bottom, and so on.
  FlowProblem::MeshChange turned(const unsigned int quarters)
  {
    return [quarters](meshing::WorkpieceMesh &mesh) {
      constexpr unsigned int vertex[4] = { 1, 3, 0, 2 };
      constexpr unsigned int node[9]   = { 1, 3, 0, 2, 6, 7, 5, 4, 8 };
      for (unsigned int turn = 0; turn < quarters; ++turn)
        for (unsigned int cell = 0; cell < mesh.cells.size(); ++cell)
          {
            const auto vertices = mesh.cells[cell];
            const auto nodes    = mesh.cell_nodes[cell];
            for (unsigned int i = 0; i < 4; ++i)
              mesh.cells[cell][i] = vertices[vertex[i]];
            for (unsigned int i = 0; i < 9; ++i)
              mesh.cell_nodes[cell][i] = nodes[node[i]];
          }
    };
  }


  Entries pressed(const std::string &name, const std::string &pressure)
  {
    return { "Boundary " + name + "/Type = pressure",
             "Boundary " + name + "/Pressure = " + pressure };
  }


  const Entries slow = { "Process/End time = 1", "Time stepping/Time step = 1",
                         "Flow solver/Tolerance = 1e-10",
                         "Flow solver/Reference strain rate = 0.1" };

  const Entries at_start = slow + Entries{ "Time stepping/Scheme = explicit euler" };


  /// Source strength c of v_r = c/r that a pressure difference drives in sigma = C rate^n [mm^2/s]:
  /// p = C/(sqrt3 n) (2 c/sqrt3)^n (a^-2n - b^-2n) (Hill 1950, chapter 5, for n -> 0).
  double source(const double p,
                const double C,
                const double n,
                const double inner = a,
                const double outer = b)
  {
    const double of_one = C / (std::sqrt(3.) * n) * std::pow(2 / std::sqrt(3.), n) *
                          (std::pow(inner, -2 * n) - std::pow(outer, -2 * n));
    return std::copysign(std::pow(std::abs(p) / of_one, 1 / n), p);
  }


  void expect_closed_ledger(const StepRecord &record)
  {
    EXPECT_NEAR(record.power_residual, 0, 1e-7 * std::abs(record.power_plastic));
    EXPECT_NEAR(record.power_boundaries, record.power_plastic, 1e-7 * record.power_plastic);
  }
} // namespace


/// Side of the section, quarters by which the cells are turned.
class Side : public ::testing::TestWithParam<std::tuple<unsigned int, unsigned int>>
{
};


TEST_P(Side, TubeAndBlockMoveAsTheyMust)
{
  const auto [side, quarters] = GetParam();
  const bool radial           = side < 2;
  // Radial pressure: plane strain. Axial pressure: against a symmetry line, the rest is free.
  std::array<std::string, 4> names;
  names[side] = sides[side];
  if (radial)
    names[2] = names[3] = "symmetry";
  else
    names[side ^ 1] = "symmetry";
  constexpr double C = 100, n = 0.5, p = 30;
  TemporaryFolder  folder;
  FlowProblem      problem(at_start + power_law(C, n) + workpiece(tube(folder, names)) +
                               Entries{ "Boundaries = " + sides[side] } +
                               pressed(sides[side], number(p)),
                           turned(quarters));
  // left, right, bottom, top are bottom, top, right, left after a quarter
  constexpr unsigned int local[4][4] = {
    { 0, 1, 2, 3 }, { 3, 2, 0, 1 }, { 1, 0, 3, 2 }, { 2, 3, 1, 0 }
  };
  for (const BoundaryEdge &edge : problem.state.tables.edges)
    if (edge.id == problem.state.boundary_ids.at(sides[side]))
      ASSERT_EQ(edge.side, local[quarters][side]) << "the mesh does not test what it should";

  const auto   result = problem.solve_at_start();
  const double c      = source(side == 0 ? p : -p, C, n);
  const double rate   = std::pow(p / C, 1 / n); // uniaxial: sigma = p
  const double wall   = side == 2 ? height : 0; // the symmetry line
  for (unsigned int node = 0; node < problem.state.tables.n_nodes; ++node)
    {
      const Point  x = problem.state.node_position(node);
      const double r = radial ? c / x[0] : 0.5 * rate * x[0];
      const double z = radial ? 0 : -rate * (x[1] - wall);
      EXPECT_NEAR(result.velocity.local_element(2 * node), r, (radial ? 2e-4 : 2e-6) * std::abs(r));
      EXPECT_NEAR(result.velocity.local_element(2 * node + 1), z,
                  2e-6 * std::max(std::abs(r), std::abs(z)));
    }

  const BoundaryRecord &entry = result.record.boundaries[0];
  const double          end   = M_PI * (b * b - a * a);
  const double          force = side == 2 ? p * end : side == 3 ? -p * end : 0;
  const double power = radial ? 2 * M_PI * height * p * std::abs(c) : p * end * rate * height;
  EXPECT_NEAR(entry.pressure / p, 1, 1e-12);
  EXPECT_NEAR(entry.force, force, 1e-9 * p * end);
  EXPECT_NEAR(entry.power / power, 1, radial ? 2e-4 : 2e-6);
  expect_closed_ledger(result.record);
}


INSTANTIATE_TEST_SUITE_P(All,
                         Side,
                         ::testing::Combine(::testing::Range(0u, 4u), ::testing::Range(0u, 4u)),
                         [](const auto &info) {
                           return sides[std::get<0>(info.param)] + "_turned_" +
                                  std::to_string(std::get<1>(info.param));
                         });


// Pressed from all sides nothing moves, whatever the cells look like: the mean stress is -p.
TEST(Pressure, FromAllSidesMovesNothing)
{
  TemporaryFolder folder;
  Entries entries = at_start + power_law(100, 1) + Entries{ "Boundaries = inner, outer, top" } +
                    workpiece(tube(folder, { { "inner", "outer", "symmetry", "top" } }));
  for (const std::string name : { "inner", "outer", "top" })
    entries = entries + pressed(name, "30");
  FlowProblem problem(entries);
  problem.map_nodes([](const Point &x) {
    const double bulge = 0.05 * x[1] * (x[0] - 15);
    return Point(x[0] + bulge, x[1] * (1 + 0.01 * (x[0] - a)));
  });
  const auto result = problem.solve_at_start();
  EXPECT_LT(result.velocity.linfty_norm(), 1e-6 * 0.1 * height);
  for (const CellHistory &cell : result.cell_history)
    for (const double mean : cell.mean_stress)
      EXPECT_NEAR(mean, -30, 1e-4);
}


// The mean is that over the area, and a load may vary along the surface: p = z on a bore bears
// nothing axially, p = r on a top end bears 2 pi (b^3 - a^3)/3.
TEST(Pressure, ThatVariesAlongTheSurface)
{
  TemporaryFolder folder;
  FlowProblem     problem(at_start + power_law(100, 1) + Entries{ "Boundaries = inner, top" } +
                          workpiece(tube(folder, { { "inner", "", "symmetry", "top" } })) +
                          pressed("inner", "z") + pressed("top", "r"));
  const auto     &record = problem.solve_at_start().record;
  EXPECT_NEAR(record.boundaries[0].pressure, height / 2, 1e-9);
  EXPECT_NEAR(record.boundaries[0].force, 0, 1e-9);
  const double force = 2 * M_PI / 3 * (b * b * b - a * a * a);
  EXPECT_NEAR(record.boundaries[1].force / -force, 1, 1e-9);
  EXPECT_NEAR(record.boundaries[1].pressure / (force / (M_PI * (b * b - a * a))), 1, 1e-9);
  EXPECT_NEAR(record.boundaries[0].power + record.boundaries[1].power, record.power_boundaries,
              1e-9 * record.power_boundaries);
  expect_closed_ledger(record);
}


// 50 MPa on a block of 10 mm radius are 15,708 N, at rest or not.
TEST(Pressure, OfABlockIsItsForce)
{
  TemporaryFolder   folder;
  const std::string block = folder.file("block.geo", R"(
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 10, 12};
Transfinite Curve{1, 3} = 3;
Transfinite Curve{2, 4} = 3;
Transfinite Surface{1};
Recombine Surface{1};
Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
Physical Curve("top") = {3};
)");
  FlowProblem       problem(at_start + power_law(100, 1) + workpiece(block) +
                            Entries{ "Boundaries = top" } + pressed("top", "50"));
  const auto        record = problem.solve_at_start().record;
  EXPECT_NEAR(record.boundaries[0].force, -50 * M_PI * 100, 1e-6);
  EXPECT_NEAR(record.boundaries[0].power, 50 * M_PI * 100 * 0.5 * 12, 1e-3);
}


// A load that changes with time: it counts where the equations are written, at the middle of a step
// (and in the shape of the middle), with the explicit scheme at its start.
TEST(Pressure, CountsAtTheTimeOfTheEquations)
{
  constexpr double  C = 100, n = 0.5, start = 0.7, step = 0.4;
  const auto        load = [](const double t) { return 20 + 15 * t * t; };
  TemporaryFolder   folder;
  const std::string file = tube(folder, { { "inner", "", "symmetry", "symmetry" } });
  for (const bool midpoint : { true, false })
    {
      FlowProblem problem((midpoint ? slow : at_start) + power_law(C, n) + workpiece(file) +
                          Entries{ "Boundaries = inner" } + pressed("inner", "20 + 15 * t^2"));
      problem.state.time  = start;
      const auto   result = problem.solve_at_start(step);
      const double theta  = midpoint ? 0.5 : 0;
      // v_r = c/r in the shape at theta, where r = r0 + theta dt c/r
      double inner = a, outer = b, c = 0;
      for (unsigned int pass = 0; pass < 50; ++pass)
        {
          c     = source(load(start + theta * step), C, n, inner, outer);
          inner = a + theta * step * c / inner;
          outer = b + theta * step * c / outer;
        }
      for (unsigned int node = 0; node < problem.state.tables.n_nodes; ++node)
        if (problem.state.node_position(node)[0] < a + 1e-9)
          {
            EXPECT_NEAR(result.velocity.local_element(2 * node) / (c / inner), 1, 5e-4)
                << (midpoint ? "midpoint" : "explicit euler");
          }
      EXPECT_NEAR(result.record.boundaries[0].pressure, load(start + theta * step), 1e-9);
      expect_closed_ledger(result.record);
    }
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
