// SPDX-License-Identifier: GPL-2.0-or-later
// What a chain of operations is made of: the workpiece turned over, moved and set down; tools that
// come until they touch; ends by force, height and fill; how full a cavity is.
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>

#include "flow_fixture.h"

#include <axiforge/base/errors.h>
#include <axiforge/meshing/transfer.h>
#include <axiforge/process/end_condition.h>
#include <axiforge/process/placement.h>
#include <axiforge/process/step.h>
#include <axiforge/state/fill.h>
#include <axiforge/state/turn_over.h>
#include <axiforge/tools/positioning.h>
#include <axiforge/tools/profile_reader.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double radius = 20, height = 30, speed = 0.3; // mm, mm, mm/s

  Entries whole_cylinder(const unsigned int cells = 4)
  {
    return workpiece(geometry("cylinder_full.geo"),
                     fmt::format("Radius = {}, Height = {}, RadialCells = {}, AxialCells = {}",
                                 radius, height, cells, cells));
  }


  Entries two_platens(const double gap = 0)
  {
    return Entries{ "Tools = upper, lower", "Process/End time = 1e9",
                    "Flow solver/Tolerance = 1e-10" } +
           platen("upper", height + gap, -speed, {}) + platen("lower", 0, 0, {});
  }


  const Entries plastic = perfectly_plastic(100);


  /// A shape without any symmetry in z, and strains that tell the places apart.
  void deform(FlowProblem &problem)
  {
    problem.map_nodes([](const Point &x) {
      return Point(x[0] * (1 + 0.01 * x[1] + 1e-4 * x[1] * x[1]), x[1] + 0.004 * x[0] * x[0]);
    });
    State                  &state = problem.state;
    const dealii::QGauss<2> gauss(3);
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      for (unsigned int q = 0; q < 9; ++q)
        state.strain.local_element(state.tables.first_strain_dof[cell] + q) =
            0.1 + 0.01 * state.node_position(state.tables.cells[cell][8])[1] +
            0.02 * gauss.point(q)[1] + 0.003 * gauss.point(q)[0];
  }


  /// int strain z^k dV
  double strain_moment(const State &state, const unsigned int k)
  {
    const dealii::QGauss<2> gauss(3);
    const dealii::FE_Q<2>   nodes(2);
    double                  sum = 0;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      sum += integral(state, cell, [&](const unsigned int q) {
        double z = 0;
        for (unsigned int a = 0; a < 9; ++a)
          z += nodes.shape_value(a, gauss.point(q)) *
               state.node_position(state.tables.cells[cell][a])[1];
        return state.strain.local_element(state.tables.first_strain_dof[cell] + q) * std::pow(z, k);
      });
    return dealii::Utilities::MPI::sum(sum, state.communicator);
  }
} // namespace


TEST(TurnOver, KeepsShapeAndStrainAlsoOnRefinedMeshes)
{
  for (const bool refined : { false, true })
    {
      SCOPED_TRACE(refined);
      FlowProblem problem(plastic + whole_cylinder() + two_platens());
      State      &state = problem.state;
      if (refined)
        for (unsigned int i = 0; i < 2; ++i)
          problem.refine([](const Point &x) { return x[0] > 8 && x[1] > 16; });
      deform(problem);
      const Measures before = measure(state);
      const double   sum = before.lowest + before.highest, whole = strain_moment(state, 0),
                   first = strain_moment(state, 1);
      const auto cells   = state.tables.n_global_cells;

      turn_over(state);
      const Measures after = measure(state);
      EXPECT_EQ(state.tables.n_global_cells, cells);
      EXPECT_NEAR(after.volume / before.volume, 1, 1e-12);
      EXPECT_NEAR(after.smallest_jacobian, before.smallest_jacobian, 1e-12);
      EXPECT_GT(after.smallest_jacobian, 0);
      EXPECT_NEAR(after.lowest, before.lowest, 1e-12 * height);
      EXPECT_NEAR(strain_moment(state, 0) / whole, 1, 1e-12);
      // z becomes sum - z: the first moment changes accordingly, which a wrong order of points
      // would miss.
      EXPECT_NEAR(strain_moment(state, 1) / (sum * whole - first), 1, 1e-12);
      EXPECT_GT(std::abs(first / (sum * whole - first) - 1), 0.01);

      turn_over(state);
      EXPECT_NEAR(strain_moment(state, 1) / first, 1, 1e-12);
      EXPECT_NEAR(measure(state).volume / before.volume, 1, 1e-12);
    }
}


TEST(TurnOver, ForgingGoesOnTheSameUpsideDown)
{
  // With equal tools on both sides gravity is nowhere: a workpiece turned over takes the same
  // force.
  double force[2] = { 0, 0 };
  for (const bool turned : { false, true })
    {
      FlowProblem problem(
          swift_power(100, 0.01, 0.2, 0.1) + whole_cylinder(6) + two_platens() +
          Entries{ "Tool upper/Friction/Law = shear", "Tool upper/Friction/Factor = 0.2",
                   "Tool lower/Friction/Law = shear", "Tool lower/Friction/Factor = 0.2",
                   "Time stepping/Time step = 1" });
      // Waisted below the middle.
      problem.map_nodes([](const Point &x) {
        const double s = (x[1] - 10) / 10;
        return Point(x[0] * (1 - 0.1 * std::exp(-s * s)), x[1]);
      });
      if (turned)
        {
          turn_over(problem.state);
          problem.forget_solver();
        }
      let_go(problem.state);
      for (unsigned int i = 0; i < 4; ++i)
        force[turned] =
            process::advance(problem.scene, problem.state, problem.solver(), 1).tools[0].force;
    }
  EXPECT_NEAR(force[1] / force[0], 1, 1e-7);
}


TEST(Positioning, ToolsStopWhereTheyTouch)
{
  // A cone of 30 degrees comes down on the rim of a cylinder: it touches at (radius, height) when
  // its surface there is at the height of the rim.
  FlowProblem        problem(plastic + whole_cylinder() + two_platens());
  GeometryParameters cone;
  cone.file              = geometry("cone_tool.geo");
  cone.parameters        = "HalfAngle = 60, TipRadius = 0, CornerRadius = 1, Radius = 100, Z = 200";
  tools::Profile profile = tools::read_profile(cone, "Tool cone", ".");
  const auto     outline = meshing::outline_of(problem.state);
  // The tip, on the axis, touches first.
  Vector2 way = tools::bring_to_contact(profile, outline.boundary_points, Vector2({ 0., -1. }),
                                        1e-9, "Tool cone");
  EXPECT_NEAR(way[1], height - 200, 2e-9);

  // Turned round (a funnel that opens downwards: z falls with r): the rim touches.
  std::vector<tools::Segment> funnel = { tools::Segment::line(Point(0, 100), Point(60, 40)) };
  tools::Profile              hat(funnel, "hat");
  way = tools::bring_to_contact(hat, outline.boundary_points, Vector2({ 0., -1. }), 1e-9, "hat");
  // At r = 20 the funnel is at 80: it comes down by 50.
  EXPECT_NEAR(way[1], -50, 2e-9);
  std::array<tools::Contact, 2> found;
  ASSERT_GE(hat.find(Point(radius, height), 1, found), 1u);
  EXPECT_GE(found[0].gap, 0);
  EXPECT_LE(found[0].gap, 2e-9);

  // One that passes beside the workpiece never touches.
  tools::Profile ring({ tools::Segment::line(Point(25, 100), Point(60, 100)) }, "ring");
  EXPECT_THROW(tools::bring_to_contact(ring, outline.boundary_points, Vector2({ 0., -1. }), 1e-9,
                                       "Tool ring"),
               InputError);
}


TEST(Positioning, ALooseWorkpieceWaitsForTheTool)
{
  FlowProblem  problem(plastic + whole_cylinder() + two_platens(1.5));
  const auto   outline = meshing::outline_of(problem.state);
  const double time    = process::time_of_first_contact(problem.scene, outline, problem.state);
  EXPECT_NEAR(time, 1.5 / speed, 3e-9 * 36 / speed); // stops so short of touching
  problem.state.time      = time;
  const StepRecord record = process::advance(problem.scene, problem.state, problem.solver(), 1);
  EXPECT_NEAR(record.height, height - speed, 1e-6);
}


TEST(Placement, SetsTheWorkpieceDown)
{
  FlowProblem problem(plastic + whole_cylinder() + two_platens() +
                      Entries{ "Placement/Rest on = lower", "Placement/Move = 2" } +
                      platen("lower", -7, 0, {}));
  process::place_workpiece(problem.parameters, problem.state);
  const Measures measures = measure(problem.state);
  EXPECT_NEAR(measures.lowest, -5, 1e-6);
  EXPECT_NEAR(measures.highest - measures.lowest, height, 1e-12);

  problem.parameters.placement.rest_on = "table";
  EXPECT_THROW(process::place_workpiece(problem.parameters, problem.state), InputError);
}


TEST(EndCondition, StopsAtForceAndHeight)
{
  // Frictionless: F = pi r^2 s0 with r^2 h constant.
  const double volume = M_PI * radius * radius * height;
  const auto   run    = [&](const std::string &end) {
    FlowProblem  problem(plastic + whole_cylinder(3) + two_platens() +
                              Entries{ end, "Process/End stroke = 20", "Process/End time = 0" });
    StepRecord   record;
    unsigned int steps = 0;
    while (process::ended_by(problem.scene, record).empty() && steps++ < 1000)
      record =
          process::advance(problem.scene, problem.state, problem.solver(),
                                process::choose_step_size(problem.scene, problem.state, record), record);
    return std::make_pair(process::ended_by(problem.scene, record), record);
  };
  auto [why, record] = run("Process/End force = 200000");
  EXPECT_EQ(why, "force");
  // The height at which the force is reached, to the tolerance of the end and what the line
  // through the last two steps is off.
  EXPECT_NEAR(record.height / (volume * 100 / 2e5), 1, 1.2e-3);

  std::tie(why, record) = run("Process/End height = 23.4");
  EXPECT_EQ(why, "height");
  EXPECT_NEAR(record.height / 23.4, 1, 1e-3);

  std::tie(why, record) = run("Process/End force = 1e9");
  EXPECT_EQ(why, "stroke");
  EXPECT_NEAR(record.stroke, 20, 1e-9);
}


TEST(Fill, IsTheShareOfTheCavity)
{
  // Between platens 40 mm apart the cylinder fills (20/R)^2 30/40 within a larger radius, 30/40
  // within its own.
  FlowProblem problem(plastic + whole_cylinder() + two_platens(10));
  const auto  fill = [&](const double r) {
    return fill_fraction(problem.scene, problem.state, r, 0);
  };
  EXPECT_NEAR(fill(15), 0.75, 1e-6);
  EXPECT_NEAR(fill(25), 0.75 * 0.64, 1e-6);
  // The tool moves: 5 mm later.
  EXPECT_NEAR(fill_fraction(problem.scene, problem.state, 15, 5 / speed), 30. / 35, 1e-6);
  // Curved sides that cross the radius.
  problem.map_nodes([](const Point &x) { return Point(x[0] * (1 + 0.01 * x[1]), x[1]); });
  EXPECT_NEAR(volume_within(problem.state, 1e3) / measure(problem.state).volume, 1, 1e-12);
  // r < 22 of a cone frustum with radius 20 + 0.2 z: whole below z = 10.
  const double below = M_PI / 3 * 10 * (20 * 20 + 20 * 22 + 22 * 22), above = M_PI * 22 * 22 * 20;
  EXPECT_NEAR(volume_within(problem.state, 22) / (below + above), 1, 1e-3);
}


TEST(Fill, SeesDiesAndSymmetryLines)
{
  // A half model: the symmetry line at z = 0 is the floor.
  FlowProblem problem(plastic + Entries{ "Tools = upper", "Process/End time = 1e9" } +
                      workpiece(geometry("cylinder.geo"),
                                "Radius = 20, Height = 30, RadialCells = 3, AxialCells = 3") +
                      platen("upper", 40, -speed, {}));
  EXPECT_NEAR(fill_fraction(problem.scene, problem.state, 25, 0), 0.75 * 0.64, 1e-6);
}


int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return RUN_ALL_TESTS();
}
