// SPDX-License-Identifier: GPL-2.0-or-later
// Where folds are found, with velocities for which place and time are known; and a bore that closes
// in a flow whose answer is exact. Run on one and on two ranks.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/base/errors.h>
#include <axiforge/meshing/folding.h>
#include <axiforge/process/fold_watch.h>
#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;
using meshing::find_fold;
using Kind = meshing::Fold::Kind;

namespace
{
  constexpr double radius = 25, bottom = 15, groove = 2, speed = 0.5; // mm, mm, mm, mm/s
  constexpr double exact = 1e-9;

  Entries body(const Entries &shape)
  {
    return Entries{ "Tools = upper", "Process/End time = 1" } + perfectly_plastic(100) + shape +
           platen("upper", 60, -1, { "Law = none" });
  }

  Entries grooved(const bool full)
  {
    return body(workpiece(geometry("grooved_billet.geo"),
                          fmt::format("GrooveRadius = {}, GrooveHeight = {}, CoreCells = 4, "
                                      "FlangeCells = 3, HeightCells = 3, Full = {}",
                                      bottom, groove, full ? 1 : 0)));
  }

  void set_velocity(State &state, const std::function<Vector2(const Point &)> &velocity)
  {
    for (unsigned int node = 0; node < state.tables.n_nodes; ++node)
      for (unsigned int c = 0; c < 2; ++c)
        state.velocity.local_element(2 * node + c) = velocity(state.node_position(node))[c];
    state.velocity.update_ghost_values();
  }

  /// The halves move towards each other, what is between them is compressed.
  Vector2 closing(const Point &x)
  {
    return Vector2({ 0, -speed * std::clamp(x[1] / groove, -1., 1.) });
  }
} // namespace


TEST(Folding, FlanksOfAGrooveMeet)
{
  for (const bool full : { true, false })
    {
      SCOPED_TRACE(full ? "whole billet" : "half of it, with a symmetry line");
      FlowProblem problem(grooved(full));
      State      &state = problem.state;
      set_velocity(state, closing);
      const double meet = groove / speed;
      EXPECT_FALSE(find_fold(state, 0.999 * meet, 0.05));
      const auto fold = find_fold(state, 1.001 * meet, 0.05);
      ASSERT_TRUE(fold);
      EXPECT_EQ(fold->kind, full ? Kind::surfaces : Kind::symmetry);
      EXPECT_NEAR(fold->time_left / meet, 1, exact);
      EXPECT_NEAR(fold->opening / (2 * groove), 1, exact);
      EXPECT_NEAR(fold->place[1], 0, exact);
      EXPECT_GE(fold->place[0], bottom - exact);
      set_velocity(state, [](const Point &x) { return Vector2({ 0, -closing(x)[1] }); });
      EXPECT_FALSE(find_fold(state, 10 * meet, 0.05)) << "it opens";
    }
}


/// Flanks that lean towards each other meet at the mouth.
TEST(Folding, LeaningFlanksMeetAtTheMouth)
{
  constexpr double lean = 0.12; // of the flank
  for (const bool full : { true, false })
    {
      SCOPED_TRACE(full ? "whole billet" : "half of it, with a symmetry line");
      FlowProblem problem(grooved(full));
      problem.map_nodes([](const Point &x) {
        const double side = x[1] > 0 ? 1 : x[1] < 0 ? -1 : 0;
        return x[0] <= bottom ? x : Point(x[0], x[1] - side * lean * (x[0] - bottom));
      });
      set_velocity(problem.state, [](const Point &x) {
        // What has been mapped moves as a whole.
        return x[0] > bottom ? Vector2({ 0, x[1] > 0 ? -speed : speed }) : closing(x);
      });
      const double meet = (groove - lean * (radius - bottom)) / speed;
      EXPECT_FALSE(find_fold(problem.state, 0.999 * meet, 0));
      const auto fold = find_fold(problem.state, 1.001 * meet, 0);
      ASSERT_TRUE(fold);
      EXPECT_NEAR(fold->time_left / meet, 1, exact);
      EXPECT_NEAR(fold->place[0], radius, exact);
      EXPECT_NEAR(fold->place[1], 0, exact);
    }
}


/// Parts nearer than a share of their edges, 10/3 mm: found if they close, whatever the step.
TEST(Folding, SmallestGap)
{
  FlowProblem problem(grooved(true));
  State      &state = problem.state;
  set_velocity(state, [](const Point &x) { return 1e-3 * closing(x); });
  const double share = 2 * groove / (10. / 3);
  EXPECT_FALSE(find_fold(state, 1e-3, 0.99 * share));
  const auto fold = find_fold(state, 1e-3, std::min(1., 1.01 * share));
  EXPECT_FALSE(fold) << "a groove that wide has its way out";
  problem.map_nodes([](const Point &x) {
    return Point(x[0], std::abs(x[1]) <= groove ? 0.05 * x[1]
                                                : x[1] - 0.95 * std::copysign(groove, x[1]));
  });
  set_velocity(state, [](const Point &x) { return Vector2({ 0, -1e-3 * x[1] }); });
  EXPECT_FALSE(find_fold(state, 1e-3, 0.99 * 0.05 * share));
  EXPECT_TRUE(find_fold(state, 1e-3, 1.01 * 0.05 * share));
}


/// Surfaces that come together through the workpiece are no fold: a thin disc or a flash.
TEST(Folding, ThinWorkpieceIsNoFold)
{
  for (const char *file : { "cylinder_full.geo", "cylinder.geo" })
    {
      FlowProblem problem(body(workpiece(geometry(file))));
      set_velocity(problem.state, [](const Point &x) { return Vector2({ 0, -x[1] }); });
      EXPECT_FALSE(find_fold(problem.state, 2, 1)) << file;
      problem.map_nodes([](const Point &x) { return Point(x[0], 1e-4 * x[1]); });
      set_velocity(problem.state, [](const Point &x) { return Vector2({ 0.5 * x[0], -x[1] }); });
      EXPECT_FALSE(find_fold(problem.state, 2, 1)) << file;
      // Neither is the side of it that moves inwards, nor a sharp edge that becomes sharper.
      set_velocity(problem.state, [](const Point &x) { return Vector2({ -x[0], 2 * x[1] }); });
      const auto fold = find_fold(problem.state, 2, 1);
      EXPECT_FALSE(fold) << file << ": " << fold->describe();
    }
}


/// r v_r = -c: the bore closes after r^2 / (2 c).
TEST(Folding, BoreCloses)
{
  FlowProblem problem(body(workpiece(geometry("ring.geo"), "RadialCells = 5, AxialCells = 4")));
  set_velocity(problem.state, [](const Point &x) { return Vector2({ -2 / x[0], 0 }); });
  const double meet = 81. / 4;
  EXPECT_FALSE(find_fold(problem.state, 0.999 * meet, 0.05));
  const auto fold = find_fold(problem.state, 1.001 * meet, 0.05);
  ASSERT_TRUE(fold);
  EXPECT_EQ(fold->kind, Kind::axis);
  EXPECT_NEAR(fold->time_left / meet, 1, exact);
  EXPECT_NEAR(fold->opening / 18, 1, exact);
  EXPECT_NEAR(fold->place[0], 0, exact);
}


/// A pocket on a tool: a dent with both rims on a platen. Deep and narrow it is one, shallow it is
/// not.
TEST(Folding, PocketOnATool)
{
  for (const double depth : { 1., 8. })
    {
      FlowProblem problem(
          body(workpiece(geometry("cylinder.geo"), "RadialCells = 10, AxialCells = 10")));
      State &state = problem.state;
      // The vertex in the middle of two edges of the end is pushed in, with what is below.
      problem.map_vertices([&](const Point &x) {
        return std::abs(x[0] - 12.5) < 0.1 ? Point(x[0], x[1] * (1 - depth / 25)) : x;
      });
      for (unsigned int b = 0; b < state.tables.boundary_nodes.size(); ++b)
        if (state.node_position(state.tables.boundary_nodes[b].node)[1] > 25 - 1e-9)
          state.contacts[b].tool[0] = 0;
      const auto squeeze = [](const double sign) {
        return [=](const Point &x) { return Vector2({ sign * 1e-3 * (x[0] - 12.5), 0 }); };
      };
      set_velocity(state, squeeze(-1));
      // The mouth is 5 mm wide, the surface of the deep one 16.8 mm long.
      const auto fold = find_fold(state, 1e-3, 0);
      EXPECT_EQ(fold.has_value(), depth > 5);
      if (fold)
        {
          EXPECT_EQ(fold->kind, Kind::pocket);
          EXPECT_NEAR(fold->place[0], 12.5, exact);
          EXPECT_NEAR(fold->place[1], 25, exact);
          EXPECT_NEAR(fold->opening, 5, exact);
        }
      set_velocity(state, squeeze(1));
      EXPECT_FALSE(find_fold(state, 1e-3, 0)) << "it opens";
    }
}


/// A tube whose outside is pushed inwards with v_r = -c / r, no change of length: the bore closes
/// after R^2 / (2 c) whatever the material. The run ends shortly before, and tells the time.
TEST(Folding, TubeThatIsPressedShutEndsItsRun)
{
  const double       c = 5, inner = 10; // mm^2/s, mm
  FlowProblem        problem(Entries{ "Boundaries = outer", "Boundary outer/Velocity r = -5 / r",
                               "Boundary outer/Velocity z = free", "Process/End time = 20",
                               "Flow solver/Tolerance = 1e-8",
                               "Time stepping/Largest strain increment = 0.2" } +
                             swift_power(100, 0.01, 0.2, 0.1) + workpiece(geometry("tube.geo")));
  const State       &state = problem.state;
  process::FoldWatch watch(problem.scene, true);
  StepRecord         record;
  std::string        message;
  while (message.empty() && state.time < 19.9)
    {
      const double step = process::choose_step_size(problem.scene, problem.state, record);
      record = process::advance(problem.scene, problem.state, problem.solver(), step, record);
      try
        {
          watch.after_step(state, record);
        }
      catch (const ComputationError &error)
        {
          message = error.what();
        }
    }
  const double closes = inner * inner / (2 * c);
  EXPECT_LT(state.time, closes);
  EXPECT_GT(state.time, 0.98 * closes);
  EXPECT_NE(message.find("the bore closes"), std::string::npos) << message;
  const auto fold = find_fold(state, closes, 0.05);
  ASSERT_TRUE(fold);
  EXPECT_NEAR((state.time + fold->time_left) / closes, 1, 1e-4);
}


int main(int argc, char *argv[])
{
  ::testing::InitGoogleTest(&argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return RUN_ALL_TESTS();
}
