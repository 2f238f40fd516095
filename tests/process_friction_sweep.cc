// SPDX-License-Identifier: GPL-2.0-or-later

// Example 1 (50 x 50 mm to 30 mm, 18 x 18 cells) with the SMM layer from frictionless to sticking,
// at the default settings: no step may fail. What a perfectly plastic material does beyond 25 %
// reduction is the mesh's affair: sliding without any rate sensitivity turns cells over.

#include "flow_fixture.h"

#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  const double factors[] = { 0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999 };

  Entries example_1(const Entries &material, const Entries &friction, const double stroke)
  {
    return Entries{ "Tools = upper", "Process/End stroke = " + number(stroke) } +
           workpiece(geometry("cylinder.geo"), "Radius = 25, Height = 25") + material +
           platen("upper", 25, -0.25, friction);
  }

  Entries smm(const double factor)
  {
    return { "Law = smm", "Factor = " + number(factor) };
  }

  struct UpsettingRun
  {
    std::vector<double> forces;
    unsigned int        repeats       = 0;
    double              volume_change = 0, power_residual = 0;
  };

  UpsettingRun run(const Entries &entries)
  {
    FlowProblem  problem(entries);
    StepRecord   record;
    UpsettingRun result;
    while (problem.state.time < problem.scene.end_time() * (1 - 1e-12))
      {
        const double step = process::choose_step_size(problem.scene, problem.state, record);
        record            = process::advance(problem.scene, problem.state, problem.solver(), step);
        result.forces.push_back(record.tools[0].force);
        result.repeats += record.repeats;
        result.volume_change =
            std::max(result.volume_change, std::abs(record.relative_volume_change));
        result.power_residual =
            std::max(result.power_residual, std::abs(record.power_residual / record.power_tools));
      }
    return result;
  }

  void expect_same_forces(const UpsettingRun &a, const UpsettingRun &b, const double tolerance)
  {
    ASSERT_EQ(a.forces.size(), b.forces.size());
    for (unsigned int i = 0; i < a.forces.size(); ++i)
      EXPECT_NEAR(a.forces[i] / b.forces[i], 1, tolerance) << "step " << i + 1;
  }

  void sweep(const Entries &material, const double stroke, const bool no_failed_step)
  {
    UpsettingRun first, last;
    for (const double factor : factors)
      {
        SCOPED_TRACE(fmt::format("f' = {}", factor));
        const UpsettingRun result = run(example_1(material, smm(factor), stroke));
        if (no_failed_step)
          {
            EXPECT_EQ(result.repeats, 0u);
          }
        EXPECT_LT(result.volume_change, 1e-4);
        // The default tolerance of 1e-5 is one for forces; the power is their sum over all nodes.
        EXPECT_LT(result.power_residual, 1e-4);
        if (factor == 0)
          first = result;
        last = result;
      }
    expect_same_forces(first, run(example_1(material, { "Law = none" }, stroke)), 1e-3);
    expect_same_forces(last, run(example_1(material, { "Law = sticking" }, stroke)), 1e-3);
  }
} // namespace

TEST(FrictionSweep, rate_sensitive)
{
  sweep(power_law(100, 0.2), 10, true);
}

TEST(FrictionSweep, hardening)
{
  sweep(swift_power(100, 0.01, 0.2, 0), 10, true);
}

TEST(FrictionSweep, perfectly_plastic_to_a_quarter)
{
  sweep(perfectly_plastic(100), 6.25, false);
}

// The other laws on the same problem: they reach the end, and their order is that of their
// friction.
TEST(FrictionSweep, other_laws)
{
  const Entries material = swift_power(100, 0.01, 0.2, 0.02);
  const auto    last     = [&](const Entries &friction) {
    const UpsettingRun result = run(example_1(material, friction, 10));
    EXPECT_LT(result.volume_change, 1e-4);
    EXPECT_LT(result.power_residual, 1e-4);
    return result.forces.back();
  };
  const double none    = last({ "Law = none" });
  const double coulomb = last({ "Law = coulomb", "Coefficient = 0.05" });
  const double norton  = last({ "Law = norton", "Viscosity = 10", "Exponent = 0.3" });
  const double shear   = last({ "Law = shear", "Factor = 0.3" });
  const double arctan  = last({ "Law = arctan", "Factor = 0.3" });
  const double forces  = last({ "Law = tangential forces", "Factor = 0.3" });
  EXPECT_GT(coulomb, none);
  EXPECT_GT(norton, none);
  EXPECT_GT(shear, coulomb);
  // The same friction factor, regularised in two ways or explicit: only the neutral zone and the
  // catching of nodes differ.
  EXPECT_NEAR(arctan / shear, 1, 3e-3);
  EXPECT_NEAR(forces / shear, 1, 3e-3);
}

// A tool that stands off first: the workpiece rests, and then everything is as without the gap.
TEST(Approach, is_free_and_changes_nothing)
{
  const Entries material = swift_power(100, 0.01, 0.2, 0.02);
  const auto    forces   = [&](const double gap) {
    return run(Entries{ "Tools = upper", "Process/End stroke = " + number(1 + gap),
                        "Time stepping/Stroke per step = 0.25" } +
                    workpiece(geometry("cylinder.geo"), "RadialCells = 8, AxialCells = 8") + material +
                    platen("upper", 25 + gap, -0.25, smm(0.5)))
        .forces;
  };
  const std::vector<double> without = forces(0), with = forces(0.5);
  ASSERT_EQ(without.size(), 4u);
  ASSERT_EQ(with.size(), 6u);
  EXPECT_EQ(with[0], 0);
  EXPECT_EQ(with[1], 0);
  for (unsigned int i = 0; i < 4; ++i)
    EXPECT_NEAR(with[i + 2] / without[i], 1, 1e-4); // the solver stops at 1e-5 of the forces
}

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
