// SPDX-License-Identifier: GPL-2.0-or-later
// Forces of cylinders and rings against computations of independent codes and upper bounds, and the
// limits of the SMM layer.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  /// The upper half of a cylinder or ring.
  struct Body
  {
    double      inner, outer, half_height;
    std::string file, parameters;

    double area() const
    {
      return M_PI * (outer * outer - inner * inner);
    }
  };

  Body cylinder(const double radius, const double half_height, const unsigned int cells)
  {
    return { 0, radius, half_height, geometry("cylinder.geo"),
             fmt::format("Radius = {}, Height = {}, RadialCells = {}, AxialCells = {}", radius,
                         half_height, cells, cells) };
  }

  Body ring(const unsigned int radial, const unsigned int axial)
  {
    return { 9, 18, 6, geometry("ring.geo"),
             fmt::format("RadialCells = {}, AxialCells = {}", radial, axial) };
  }


  Entries
  scene(const Body &body, const Entries &material, const Entries &friction, const double speed)
  {
    return Entries{ "Tools = upper", "Process/End time = 1e9", "Time stepping/Time step = 1",
                    "Flow solver/Tolerance = 1e-7", "Flow solver/Regularisation = 1e-4" } +
           material + workpiece(body.file, body.parameters) +
           platen("upper", body.half_height, -speed, friction);
  }


  /// Mean pressure at the start, the mesh refined towards the edges of the platen.
  double first_pressure(const Body        &body,
                        const Entries     &material,
                        const Entries     &friction,
                        const double       speed  = 0.25,
                        const unsigned int levels = 4)
  {
    FlowProblem problem(scene(body, material, friction, speed) +
                        Entries{ "Time stepping/Scheme = explicit euler" });
    double      reach = 0.35 * std::min(body.outer - body.inner, body.half_height);
    for (unsigned int level = 0; level < levels; ++level, reach *= 0.6)
      problem.refine([&](const Point &x) {
        const Point edge(body.outer, body.half_height), bore(body.inner, body.half_height);
        return x.distance(edge) < reach || (body.inner > 0 && x.distance(bore) < reach);
      });
    const auto result = problem.solve_at_start(1e-4 * body.half_height / speed);
    return result.record.tools[0].force / body.area();
  }


  Entries shear(const double m)
  {
    return { "Law = shear", "Factor = " + number(m), "Regularisation velocity = 1e-5" };
  }
} // namespace


// Perfectly plastic, first increment, mean pressure over yield stress: figures that two or three
// independent codes agree on. The sticking ones are extrapolated.
TEST(MeanPressure, OfPerfectlyPlasticCylinders)
{
  const struct
  {
    double ratio, m, expected; // R over the whole height; m = 1: sticking
  } cases[] = { { 0.5, 0.1, 1.0156 },
                { 0.5, 0.3, 1.0303 },
                { 0.5, 0.5, 1.0331 },
                { 0.5, 1, 1.0329 },
                { 1, 1, 1.1726 } };
  for (const auto &entry : cases)
    {
      SCOPED_TRACE(fmt::format("R/h {} m {}", entry.ratio, entry.m));
      const Body   body = cylinder(25, 12.5 / entry.ratio, 8);
      const double p    = first_pressure(body, perfectly_plastic(100),
                                      entry.m < 1 ? shear(entry.m) : Entries{ "Law = sticking" }) /
                       100;
      EXPECT_NEAR(p / entry.expected, 1, 0.003);
      // power of the parallel field with this friction
      EXPECT_LT(p, 1 + 2 * entry.m * entry.ratio / (3 * std::sqrt(3.)));
      EXPECT_GT(p, 1);
      if (std::getenv("AXIFORGE_TEST_FIGURES"))
        fmt::print("R/h {} m {}: {:.5f}, expected {}\n", entry.ratio, entry.m, p, entry.expected);
    }
}


TEST(MeanPressure, OfARateSensitiveStickingCylinder)
{
  const double p = first_pressure(cylinder(25, 25, 8), power_law(100, 0.2), { "Law = sticking" });
  EXPECT_NEAR(p / 42.676, 1, 0.001);
}


// 6:3:2, the ring of the friction test.
TEST(MeanPressure, OfRings)
{
  for (const auto &[m, expected] :
       { std::pair<double, double>{ 0.05, 1.0319 }, { 0.1, 1.0600 }, { 0.2, 1.1042 } })
    {
      SCOPED_TRACE(fmt::format("m {}", m));
      const double p = first_pressure(ring(9, 6), perfectly_plastic(100), shear(m), 0.25, 3) / 100;
      EXPECT_NEAR(p / expected, 1, 0.003);
      // All friction at its limit over the faces, with the velocity of the frictionless ring
      // (Avitzur's field with s = 0), is dearer.
      const double frictionless_slip =
          2 * m * (18 * 18 * 18 - 9 * 9 * 9) / (3 * std::sqrt(3.) * 12 * (18 * 18 - 9 * 9));
      EXPECT_LT(p, 1 + frictionless_slip);
      if (std::getenv("AXIFORGE_TEST_FIGURES"))
        fmt::print("ring m {}: {:.5f}, expected {}\n", m, p, expected);
    }
}


namespace
{
  std::vector<StepRecord>
  run(const Entries &material, const Entries &friction, const double dt, const unsigned int n_steps)
  {
    FlowProblem             problem(scene(cylinder(25, 25, 8), material, friction, 0.25));
    std::vector<StepRecord> records;
    for (unsigned int step = 0; step < n_steps; ++step)
      records.push_back(process::advance(problem.scene, problem.state, problem.solver(), dt));
    return records;
  }


  double largest_force_difference(const std::vector<StepRecord> &a,
                                  const std::vector<StepRecord> &b)
  {
    double worst = 0;
    for (unsigned int step = 0; step < a.size(); ++step)
      worst = std::max(worst, std::abs(a[step].tools[0].force / b[step].tools[0].force - 1));
    return worst;
  }
} // namespace


class SmmLimits : public ::testing::TestWithParam<const char *>
{
protected:
  Entries material() const
  {
    const std::string name = GetParam();
    return name == "plastic" ? perfectly_plastic(100)
           : name == "rate"  ? power_law(100, 0.2)
                             : swift_power(100, 0.01, 0.2, 0.02);
  }
};


TEST_P(SmmLimits, NoFactorIsFrictionless)
{
  const auto none  = run(material(), { "Law = none" }, 1, 15);
  const auto layer = run(material(), { "Law = smm", "Factor = 0" }, 1, 15);
  EXPECT_LT(largest_force_difference(layer, none), 1e-6);
  EXPECT_NEAR(layer.back().largest_radius / none.back().largest_radius, 1, 1e-6);
}


TEST_P(SmmLimits, FactorNearOneSticks)
{
  const auto sticking = run(material(), { "Law = sticking" }, 1, 15);
  const auto layer    = run(material(), { "Law = smm", "Factor = 0.9999" }, 1, 15);
  EXPECT_LT(largest_force_difference(layer, sticking), 1e-3);
  EXPECT_NEAR(layer.back().largest_radius / sticking.back().largest_radius, 1, 1e-4);
}


TEST_P(SmmLimits, ForceRisesWithTheFactor)
{
  double last = 0;
  for (const double factor : { 0., 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999 })
    {
      const auto records = run(material(), { "Law = smm", "Factor = " + number(factor) }, 1e-3, 1);
      EXPECT_GT(records[0].tools[0].force, last * (1 - 1e-6)) << factor;
      EXPECT_EQ(records[0].repeats, 0u);
      last = records[0].tools[0].force;
    }
}


INSTANTIATE_TEST_SUITE_P(Materials,
                         SmmLimits,
                         ::testing::Values("plastic", "rate", "hardening"),
                         [](const auto &info) { return std::string(info.param); });


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
