// SPDX-License-Identifier: GPL-2.0-or-later
// Frictionless upsetting, the patch test of the flow formulation: the exact velocity is linear, so
// every mesh has it to rounding errors. The midpoint rule's own answer is known in closed form,
// too. Then what must not change the answer: frame, units, solver options.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double radius = 25, half_height = 25, speed = 0.25; // mm, mm, mm/s

  const Entries tight = { "Process/End time = 1e9", "Time stepping/Time step = 1",
                          "Flow solver/Tolerance = 1e-12" };

  Entries upper_platen(const Entries &friction = {})
  {
    return Entries{ "Tools = upper" } + platen("upper", half_height, -speed, friction);
  }


  Entries cylinder(const unsigned int cells)
  {
    return workpiece(geometry("cylinder.geo"),
                     fmt::format("RadialCells = {0}, AxialCells = {0}", cells));
  }


  /**
   * What the implicit midpoint rule makes of uniform compression. With q = dt V/(4 h_m), h_m the
   * height in the middle of the step: r_{n+1}/r_n = (1 + q)/(1 - q), h_{n+1}/h_n = (1 - 2q)/(1 +
   * 2q).
   */
  struct MidpointCylinder
  {
    double r = radius, h = half_height, strain = 0;
    double middle_r = 0, middle_h = 0, middle_strain = 0, rate = 0;

    void step(const double dt)
    {
      const double next_h = h - speed * dt;
      middle_h            = 0.5 * (h + next_h);
      rate                = speed / middle_h;
      const double q      = 0.25 * dt * rate;
      const double next_r = r * (1 + q) / (1 - q);
      middle_r            = 0.5 * (r + next_r);
      middle_strain       = strain + 0.5 * dt * rate;
      strain += dt * rate;
      r = next_r;
      h = next_h;
    }

    /// pi r^2 s, s the stress with the regularised rate of the model.
    double force(const scene::Scene &scene) const
    {
      const double regular =
          std::hypot(rate, scene.flow.regularisation * scene.characteristic_rate);
      return M_PI * middle_r * middle_r * scene.material.flow_stress(middle_strain, regular).value *
             rate / regular;
    }
  };


  /// Runs to the given reduction in equal steps of the stroke and compares each with the closed
  /// form.
  void check_patch(FlowProblem       &problem,
                   const double       reduction,
                   const unsigned int n_steps,
                   const double       tolerance = 1e-8)
  {
    const scene::Scene &scene = problem.scene;
    State              &state = problem.state;
    const double        dt    = reduction * half_height / speed / n_steps;
    MidpointCylinder    exact;
    for (unsigned int step = 1; step <= n_steps; ++step)
      {
        const StepRecord record = process::advance(scene, state, problem.solver(), dt);
        exact.step(dt);
        SCOPED_TRACE(fmt::format("step {}", step));
        ASSERT_EQ(record.repeats, 0u);
        ASSERT_NEAR(record.tools[0].force / exact.force(scene), 1, tolerance);
        ASSERT_NEAR(record.largest_radius / exact.r, 1, tolerance);
        ASSERT_NEAR(record.power_residual / record.power_tools, 0, 10 * tolerance);
        double worst_velocity = 0, worst_strain = 0;
        for (unsigned int node = 0; node < state.tables.n_nodes; ++node)
          {
            const Point  now = state.node_position(node);
            const double vr  = state.velocity.local_element(2 * node),
                         vz  = state.velocity.local_element(2 * node + 1);
            worst_velocity   = std::max({ worst_velocity,
                                          std::abs(vr - 0.5 * exact.rate * (now[0] - 0.5 * dt * vr)),
                                          std::abs(vz + exact.rate * (now[1] - 0.5 * dt * vz)) });
          }
        for (const double strain : state.strain)
          worst_strain = std::max(worst_strain, std::abs(strain - exact.strain));
        ASSERT_LT(worst_velocity, tolerance * speed);
        ASSERT_LT(worst_strain, tolerance);
      }
    EXPECT_NEAR(measure(state).volume / (2 * M_PI * radius * radius * half_height / 2), 1, 1e-4);
    EXPECT_NEAR(exact.r, radius * std::sqrt(half_height / exact.h), 1e-4 * exact.r);
  }


  const Entries plastic = perfectly_plastic(100), rate_sensitive = power_law(100, 0.2),
                hardening = swift_power(100, 0.01, 0.2, 0.02);
} // namespace


TEST(PatchTest, StructuredMeshSixtyPercent)
{
  for (const Entries &material : { plastic, rate_sensitive, hardening })
    {
      FlowProblem problem(tight + material + cylinder(4) + upper_platen());
      check_patch(problem, 0.6, 30);
    }
}


TEST(PatchTest, UnstructuredMesh)
{
  TemporaryFolder   folder;
  const std::string file = folder.file("cylinder.geo", R"(
Point(1) = {0, 0, 0};
Point(2) = {25, 0, 0};
Point(3) = {25, 25, 0};
Point(4) = {0, 25, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
Physical Curve("axis") = {4};
)");
  FlowProblem       problem(tight + hardening + workpiece(file) +
                            Entries{ "Workpiece/Element size = 6" } + upper_platen());
  check_patch(problem, 0.6, 30);
}


TEST(PatchTest, DistortedAndCurvedMeshes)
{
  FlowProblem distorted(tight + rate_sensitive + cylinder(6) + upper_platen());
  distorted.map_vertices([](const Point &x) {
    const auto inside = [](const double s) { return s > 1e-6 && s < 25 - 1e-6; };
    // as good as random, and the same everywhere
    const double u = std::sin(12.9898 * x[0] + 78.233 * x[1]), v = std::cos(39.3468 * x[0] - x[1]);
    return Point(x[0] + (inside(x[0]) ? u : 0), x[1] + (inside(x[1]) ? v : 0));
  });
  check_patch(distorted, 0.6, 30);

  FlowProblem curved(tight + rate_sensitive + cylinder(4) + upper_platen());
  curved.map_nodes([](const Point &x) {
    const double bump = 1.5 * std::sin(M_PI * x[0] / 25) * std::sin(M_PI * x[1] / 25);
    return Point(x[0] + bump, x[1] - bump);
  });
  check_patch(curved, 0.6, 30);
}


TEST(PatchTest, HangingNodes)
{
  FlowProblem problem(tight + hardening + cylinder(4) + upper_platen());
  problem.refine([](const Point &x) { return x[0] > 12 && x[1] > 12; });
  problem.refine([](const Point &x) { return x[0] > 18 && x[1] > 18; });
  ASSERT_GT(problem.state.hanging_nodes.n_constraints(), 0u);
  check_patch(problem, 0.6, 30);
}


TEST(PatchTest, Picard)
{
  FlowProblem problem(
      tight + hardening + cylinder(3) + upper_platen() +
      Entries{ "Flow solver/Iteration = picard", "Flow solver/Most iterations = 400" });
  check_patch(problem, 0.1, 4);
}


TEST(PatchTest, PlainPenaltyErrorFallsWithThePenalty)
{
  // Of a body under pressure sigma/3 that can be compressed: the free side moves a little more.
  std::vector<double> errors;
  for (const std::string penalty : { "1e4", "1e5", "1e6" })
    {
      FlowProblem problem(
          tight + rate_sensitive + cylinder(3) + upper_platen() +
          Entries{ "Flow solver/Incompressibility = penalty", "Flow solver/Penalty = " + penalty });
      const StepRecord record = process::advance(problem.scene, problem.state, problem.solver(), 4);
      MidpointCylinder exact;
      exact.step(4);
      errors.push_back(std::abs(record.largest_radius / exact.r - 1));
    }
  SCOPED_TRACE(table(errors));
  EXPECT_NEAR(errors[0] / errors[1], 10, 0.1);
  EXPECT_NEAR(errors[1] / errors[2], 10, 0.1);
  EXPECT_LT(errors[2], 1e-7);
}


namespace
{
  struct Press
  {
    std::vector<double> lower, upper, radius;
    std::vector<Point>  nodes;
  };

  /// The whole cylinder between two platens, frame shifted by z0, with these velocities in z.
  Press press(const double z0, const double lower_velocity, const double upper_velocity)
  {
    TemporaryFolder   folder;
    const std::string file     = folder.file("whole.geo", fmt::format(R"(
z = {:.17g};
Point(1) = {{0, z, 0}};
Point(2) = {{25, z, 0}};
Point(3) = {{25, z + 50, 0}};
Point(4) = {{0, z + 50, 0}};
Line(1) = {{1, 2}};
Line(2) = {{2, 3}};
Line(3) = {{4, 3}};
Line(4) = {{1, 4}};
Curve Loop(1) = {{1, 2, -3, -4}};
Plane Surface(1) = {{1}};
Transfinite Curve{{1, 3}} = 6;
Transfinite Curve{{2, 4}} = 11;
Transfinite Surface{{1}} = {{1, 2, 3, 4}};
Recombine Surface{{1}};
Physical Surface("workpiece") = {{1}};
Physical Curve("axis") = {{4}};
)",
                                                                      z0));
    const Entries     friction = { "Law = smm", "Factor = 0.3" };
    FlowProblem       problem(
              tight + hardening + workpiece(file) +
              Entries{ "Tools = lower, upper", "Flow solver/Reference strain rate = 0.01" } +
              platen("lower", z0, lower_velocity, friction) +
              platen("upper", z0 + 50, upper_velocity, friction));
    Press result;
    for (unsigned int step = 0; step < 8; ++step)
      {
        const StepRecord record =
            process::advance(problem.scene, problem.state, problem.solver(), 1);
        result.lower.push_back(record.tools[0].force);
        result.upper.push_back(record.tools[1].force);
        result.radius.push_back(record.largest_radius);
      }
    for (unsigned int node = 0; node < problem.state.tables.n_nodes; ++node)
      result.nodes.push_back(problem.state.node_position(node));
    return result;
  }

  /// Distance of the nodes from those of another run after a mirroring and a shift in z [mm].
  double distance(const Press &a, const Press &b, const double sign, const double shift)
  {
    double worst = 0;
    for (const Point &x : a.nodes)
      {
        const Point moved(x[0], sign * x[1] + shift);
        double      nearest = 1e300;
        for (const Point &y : b.nodes)
          nearest = std::min(nearest, moved.distance(y));
        worst = std::max(worst, nearest);
      }
    return worst;
  }
} // namespace


TEST(Frame, PositionMotionAndSideOfThePressDoNotMatter)
{
  const Press upper = press(0, 0, -0.5), shifted = press(-700, 0, -0.5), lower = press(0, 0.5, 0),
              both = press(0, 0.2, -0.3);
  for (unsigned int step = 0; step < upper.upper.size(); ++step)
    {
      SCOPED_TRACE(fmt::format("step {}", step + 1));
      const double force = upper.upper[step];
      EXPECT_GT(force, 0);
      for (const double other : { upper.lower[step], shifted.upper[step], lower.lower[step],
                                  lower.upper[step], both.upper[step] })
        EXPECT_NEAR(std::abs(other) / force, 1, 1e-8);
      EXPECT_NEAR(shifted.radius[step] / upper.radius[step], 1, 1e-10);
      EXPECT_NEAR(lower.radius[step] / upper.radius[step], 1, 1e-10);
      EXPECT_NEAR(both.radius[step] / upper.radius[step], 1, 1e-10);
    }
  EXPECT_LT(distance(shifted, upper, 1, 700), 1e-8);
  EXPECT_LT(distance(lower, upper, -1, 50), 1e-8); // upside down
  EXPECT_LT(distance(both, upper, 1, -0.2 * 8), 1e-8);
}


namespace
{
  /// Example 1 in small, with all lengths, stresses and times in other units.
  std::array<double, 4>
  scaled(const double L, const double S, const double T, const Entries &friction)
  {
    FlowProblem problem(
        Entries{ "Process/End time = 1e9", "Time stepping/Time step = 1",
                 "Flow solver/Tolerance = 1e-9", "Tools = upper" } +
        workpiece(
            geometry("cylinder.geo"),
            fmt::format("Radius = {0:.17g}, Height = {0:.17g}, RadialCells = 5, AxialCells = 5",
                        25 * L)) +
        swift_power(100 * S, 0.01, 0.2, 0.1) +
        Entries{ "Material/Reference strain rate = " + number(0.01 / T) } +
        platen("upper", 25 * L, -0.25 * L / T, friction, 200 * L));
    StepRecord record;
    for (unsigned int step = 0; step < 12; ++step)
      record = process::advance(problem.scene, problem.state, problem.solver(), 2 * T);
    return { { record.tools[0].force / (S * L * L), record.largest_radius / L,
               record.power_friction / (S * L * L * L / T), record.largest_strain } };
  }
} // namespace


TEST(Units, AnswersScaleWithLengthStressAndTime)
{
  for (const Entries &friction :
       { Entries{ "Law = smm", "Factor = 0.5" }, Entries{ "Law = shear", "Factor = 0.3" },
         Entries{ "Law = coulomb", "Coefficient = 0.1" } })
    {
      SCOPED_TRACE(friction[0]);
      const auto reference = scaled(1, 1, 1, friction);
      for (const auto &units : { std::array<double, 3>{ { 1e-3, 1, 1 } },
                                 { { 1e3, 1, 1 } },
                                 { { 1, 1e-6, 1 } },
                                 { { 1, 1e6, 1 } },
                                 { { 1, 1, 1e-5 } },
                                 { { 1e3, 1e-6, 1e4 } } })
        {
          const auto other = scaled(units[0], units[1], units[2], friction);
          for (unsigned int i = 0; i < reference.size(); ++i)
            EXPECT_NEAR(other[i] / reference[i], 1, 1e-7)
                << "figure " << i << ", units " << units[0] << " " << units[1] << " " << units[2];
        }
    }
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
