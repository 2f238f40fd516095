// SPDX-License-Identifier: GPL-2.0-or-later
// Gauges on outlines that Q2 edges represent exactly: parabolas whose extremes and cuts lie between
// the nodes. Run on one and on two ranks.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/base/errors.h>
#include <axiforge/output/results.h>
#include <axiforge/process/step.h>
#include <axiforge/state/gauges.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double bore = 9, outside = 18, height = 6, exact = 1e-12; // mm, mm, mm, relative

  Entries gauge(const std::string &name, const std::string &measure, const std::string &at)
  {
    return { "Gauge " + name + "/Measure = " + measure, "Gauge " + name + "/At = " + at };
  }

  Entries ring(const std::string &gauges)
  {
    return Entries{ "Tools = upper", "Process/End time = 1", "Time stepping/Time step = 0.01",
                    "Gauges = " + gauges } +
           perfectly_plastic(100) +
           workpiece(geometry("ring.geo"), "RadialCells = 5, AxialCells = 4") +
           platen("upper", height, -1, { "Law = none" });
  }

  std::vector<double> read(const FlowProblem &problem)
  {
    return read_gauges(problem.scene, problem.state);
  }
} // namespace


/// r = r0 + c (z - a)^2: the bore is narrowest at z = a, which is no node's height.
TEST(Gauges, RadiiOfAParabolicBore)
{
  constexpr double a = 2.3, c = 0.11, line = 1.7;
  FlowProblem      problem(
           ring("waist, at_line, symmetric, widest, platen, outer_at_line") +
           gauge("waist", "inner radius", "") + gauge("at_line", "inner radius", number(line)) +
           gauge("symmetric", "inner radius", "0") + gauge("widest", "outer radius", "") +
           gauge("platen", "inner radius", number(height)) +
           gauge("outer_at_line", "outer radius", number(line)));
  const auto bulge = [&](const double z) { return c * (z - a) * (z - a); };
  problem.map_nodes([&](const Point &x) { return Point(x[0] + bulge(x[1]), x[1]); });
  const std::vector<double> found = read(problem);
  EXPECT_NEAR(found[0] / bore, 1, exact);
  EXPECT_NEAR(found[1] / (bore + bulge(line)), 1, exact);
  EXPECT_NEAR(found[2] / (bore + bulge(0)), 1, exact);
  EXPECT_NEAR(found[3] / (outside + bulge(height)), 1, exact);
  EXPECT_NEAR(found[4] / (bore + bulge(height)), 1, exact);
  EXPECT_NEAR(found[5] / (outside + bulge(line)), 1, exact);
}


/// An arched top, z = h - c (r - a)^2: its highest point and what a level line cuts off.
TEST(Gauges, HeightsAndCutsOfAnArch)
{
  constexpr double a = 12.9, c = 0.05, line = 5.6;
  FlowProblem      problem(
           ring("top, at_radius, left, right, bottom, mid, mid_inner, above") +
           gauge("top", "upper height", "") + gauge("at_radius", "upper height", "16.3") +
           gauge("left", "inner radius", number(line)) + gauge("right", "outer radius", number(line)) +
           gauge("bottom", "lower height", "") + gauge("mid", "upper height", "middle") +
           gauge("mid_inner", "inner radius", "middle") + gauge("above", "outer radius", "6.001"));
  problem.map_nodes([&](const Point &x) {
    return Point(x[0], x[1] * (1 - c * (x[0] - a) * (x[0] - a) / height));
  });
  const std::vector<double> found = read(problem);
  EXPECT_NEAR(found[0] / height, 1, exact);
  EXPECT_NEAR(found[1] / (height - c * std::pow(16.3 - a, 2)), 1, exact);
  const double half_width = std::sqrt((height - line) / c);
  EXPECT_NEAR(found[2] / (a - half_width), 1, exact);
  EXPECT_NEAR(found[3] / (a + half_width), 1, exact);
  // Of the surface: where the bore and the side meet the symmetry line.
  EXPECT_NEAR(found[4], 0, exact);
  EXPECT_NEAR(found[5] / (height - c * std::pow(0.5 * (bore + outside) - a, 2)), 1, exact);
  EXPECT_NEAR(found[6] / bore, 1, exact);
  EXPECT_TRUE(std::isnan(found[7])) << "the line is above the workpiece";
}


TEST(Gauges, SolidWorkpieceHasNoBore)
{
  FlowProblem problem(Entries{ "Tools = upper", "Process/End time = 1", "Gauges = in, out" } +
                      perfectly_plastic(100) +
                      workpiece(geometry("cylinder.geo"), "RadialCells = 4, AxialCells = 4") +
                      platen("upper", 25, -1, { "Law = none" }) +
                      gauge("in", "inner radius", "middle") +
                      gauge("out", "outer radius", "middle"));
  EXPECT_EQ(read(problem)[0], 0);
  EXPECT_NEAR(read(problem)[1] / 25, 1, exact);
}


/// Frictionless: the ring stays a ring, r^2 h = const to the midpoint rule's own factor, and the
/// gauges of the bore agree wherever they look. Before the first step nothing touches.
TEST(Gauges, FollowAFrictionlessRing)
{
  FlowProblem problem(
      ring("middle, platen, line, outer") + Entries{ "Flow solver/Tolerance = 1e-11" } +
      gauge("middle", "inner radius", "middle") + gauge("platen", "inner radius", "tool upper") +
      gauge("line", "inner radius", "0") + gauge("outer", "outer radius", "tool upper"));
  EXPECT_TRUE(std::isnan(read(problem)[1]));
  double     factor = 1, h = height;
  StepRecord record;
  for (unsigned int step = 0; step < 5; ++step)
    {
      record = process::advance(problem.scene, problem.state, problem.solver(), 0.1, record);
      const double q = 0.25 * 0.1 / (h - 0.05);
      factor *= (1 + q) / (1 - q);
      h -= 0.1;
      ASSERT_EQ(record.gauges.size(), 4u);
      for (unsigned int i = 0; i < 3; ++i)
        EXPECT_NEAR(record.gauges[i] / (bore * factor), 1, 1e-7) << "gauge " << i;
      EXPECT_NEAR(record.gauges[3] / (outside * factor), 1, 1e-7);
    }
}


TEST(Gauges, ColumnsOnlyWhereAskedFor)
{
  FlowProblem with(ring("waist")), without(ring(""));
  const auto  a = output::history_columns(with.scene), b = output::history_columns(without.scene);
  EXPECT_EQ(std::count(a.begin(), a.end(), "gauge_waist_mm"), 1);
  EXPECT_EQ(a.size(), b.size() + 1);
  EXPECT_TRUE(read(without).empty());
}


int main(int argc, char *argv[])
{
  ::testing::InitGoogleTest(&argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return RUN_ALL_TESTS();
}
