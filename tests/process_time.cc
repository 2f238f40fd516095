// SPDX-License-Identifier: GPL-2.0-or-later
// Orders of the time schemes while the contact set stands still, and the volume that they lose.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double half_height = 25, speed = 0.25;

  Entries cylinder(const std::string &scheme, const Entries &friction, const unsigned int cells = 4)
  {
    return Entries{ "Tools = upper", "Process/End time = 1e9", "Time stepping/Time step = 1",
                    "Time stepping/Scheme = " + scheme, "Flow solver/Tolerance = 1e-10" } +
           swift_power(100, 0.2, 0.3, 0.1) +
           workpiece(geometry("cylinder.geo"),
                     fmt::format("RadialCells = {0}, AxialCells = {0}", cells)) +
           platen("upper", half_height, -speed, friction);
  }


  struct Answer
  {
    double             force;  ///< at the end, not in the middle of the last step [N]
    double             radius; ///< [mm]
    std::vector<Point> nodes;
    double             volume_change;
  };


  Answer compress(const Entries &entries, const double reduction, const unsigned int n_steps)
  {
    FlowProblem  problem(entries);
    const double dt = reduction * half_height / speed / n_steps;
    StepRecord   record;
    for (unsigned int step = 0; step < n_steps; ++step)
      {
        record = process::advance(problem.scene, problem.state, problem.solver(), dt);
        EXPECT_EQ(record.set_changes, 0u);
        EXPECT_EQ(record.repeats, 0u);
      }
    const auto at_end = problem.solver().solve(0.005); // the same after all steps
    if (!at_end.converged)
      throw std::runtime_error(at_end.failure);
    Answer answer{
      at_end.record.tools[0].force, record.largest_radius, {}, record.relative_volume_change
    };
    for (unsigned int node = 0; node < problem.state.tables.n_nodes; ++node)
      answer.nodes.push_back(problem.state.node_position(node));
    return answer;
  }


  double distance(const Answer &a, const Answer &b)
  {
    double worst = 0;
    for (unsigned int node = 0; node < a.nodes.size(); ++node)
      worst = std::max(worst, a.nodes[node].distance(b.nodes[node]));
    return worst;
  }


  /// Orders of force, radius and shape from three runs with halved steps (Richardson).
  std::array<double, 3>
  temporal_orders(const Entries &entries, const double reduction, const unsigned int n_steps)
  {
    const Answer a = compress(entries, reduction, n_steps),
                 b = compress(entries, reduction, 2 * n_steps),
                 c = compress(entries, reduction, 4 * n_steps);
    if (std::getenv("AXIFORGE_TEST_FIGURES"))
      fmt::print("force {} {} {}  radius {} {}  shape {} {}\n", a.force, a.force - b.force,
                 b.force - c.force, a.radius - b.radius, b.radius - c.radius, distance(a, b),
                 distance(b, c));
    return { { std::log2((a.force - b.force) / (b.force - c.force)),
               std::log2((a.radius - b.radius) / (b.radius - c.radius)),
               std::log2(distance(a, b) / distance(b, c)) } };
  }
} // namespace


class Friction : public ::testing::TestWithParam<Entries>
{
};


TEST_P(Friction, MidpointIsOfSecondOrder)
{
  const auto order =
      temporal_orders(cylinder("midpoint", GetParam()), 0.1, 4); // 2.5 % each and finer
  EXPECT_GE(order[0], 1.9) << "force";
  EXPECT_GE(order[1], 1.9) << "radius";
  EXPECT_GE(order[2], 1.9) << "shape";
}


TEST_P(Friction, VolumeErrorOfAStepIsOfThirdOrder)
{
  std::vector<double> change;
  for (const double reduction : { 0.04, 0.02, 0.01 })
    change.push_back(
        std::abs(compress(cylinder("midpoint", GetParam()), reduction, 1).volume_change));
  SCOPED_TRACE(table(change));
  EXPECT_GE(orders(change).back(), 2.9);
  EXPECT_LE(orders(change).back(), 3.1);
}


INSTANTIATE_TEST_SUITE_P(Laws,
                         Friction,
                         ::testing::Values(Entries{ "Law = none" },
                                           Entries{ "Law = sticking" },
                                           Entries{ "Law = smm", "Factor = 0.3" },
                                           Entries{ "Law = shear", "Factor = 0.3" },
                                           Entries{ "Law = coulomb", "Coefficient = 0.1" },
                                           Entries{ "Law = norton", "Viscosity = 10" }),
                         [](const auto &info) { return info.param[0].substr(6); });


TEST(ExplicitEuler, IsOfFirstOrder)
{
  const auto order = temporal_orders(cylinder("explicit euler", { "Law = sticking" }), 0.1, 4);
  EXPECT_NEAR(order[0], 1, 0.1) << "force";
  EXPECT_NEAR(order[2], 1, 0.1) << "shape";
}


// v_r = V r/(2h): a step multiplies r by 1 + d/2 and h by 1 - d, d = dh/h, so the volume by
// (1 + d/2)^2 (1 - d) = 1 - 3/4 d^2 + O(d^3); summed up over equal steps dh, 3/4 (dh/h0)(h0/hf -
// 1).
TEST(ExplicitEuler, LosesTheKnownVolume)
{
  const unsigned int n_steps  = 64;
  const double       dh       = 0.5 / n_steps;
  double             discrete = 1;
  for (unsigned int step = 0; step < n_steps; ++step)
    {
      const double d = dh / (1 - step * dh);
      discrete *= std::pow(1 + 0.5 * d, 2) * (1 - d);
    }
  const Answer euler = compress(cylinder("explicit euler", {}, 2), 0.5, n_steps);
  EXPECT_NEAR(euler.volume_change, discrete - 1, 1e-9);
  EXPECT_NEAR(euler.volume_change, -0.75 * dh * (1 / 0.5 - 1), 0.05 * 0.0059);
  const Answer midpoint = compress(cylinder("midpoint", {}, 2), 0.5, n_steps);
  EXPECT_LT(std::abs(midpoint.volume_change), 1e-5);
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
