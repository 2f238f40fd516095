// SPDX-License-Identifier: GPL-2.0-or-later
// Flows with a closed solution, each in the geometry of the start: expanding thick cylinder and
// spherical shell of a power law (Hill 1950, chapter 5, for the rigid-plastic limit), the
// converging Newtonian cone.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  const Entries at_start = { "Time stepping/Scheme = explicit euler", "Process/End time = 1",
                             "Time stepping/Time step = 1", "Flow solver/Tolerance = 1e-10",
                             "Flow solver/Regularisation = 1e-6" };

  constexpr double a = 10, b = 20, c = 5; // radii [mm], strength of the source

  /// C (2 c / sqrt3)^n / (sqrt3 n) (a^-2n - b^-2n), (2/sqrt3) sigma0 ln(b/a) for n = 0.
  double cylinder_pressure(const double C, const double n)
  {
    if (n == 0)
      return 2 / std::sqrt(3.) * C * std::log(b / a);
    return C / (std::sqrt(3.) * n) * std::pow(2 * c / std::sqrt(3.), n) *
           (std::pow(a, -2 * n) - std::pow(b, -2 * n));
  }


  /// 2 C / (3 n) (2 c)^n (a^-3n - b^-3n), 2 sigma0 ln(b/a) for n = 0.
  double sphere_pressure(const double C, const double n)
  {
    if (n == 0)
      return 2 * C * std::log(b / a);
    return 2 * C / (3 * n) * std::pow(2 * c, n) * (std::pow(a, -3 * n) - std::pow(b, -3 * n));
  }


  /// v = c r e_r: mean stress from sigma_rr(r) = -p(r, b) and the deviator.
  ExactFlow cylinder_flow(const Point &x, const double C, const double n)
  {
    const double r = x[0], rate = 2 * c / (std::sqrt(3.) * r * r);
    ExactFlow    flow;
    flow.velocity      = Vector2({ c / r, 0. });
    flow.gradient      = { { -c / (r * r), 0, 0, 0 } };
    const double sigma = C * std::pow(rate, n);
    const double rest  = n == 0 ? 2 / std::sqrt(3.) * C * std::log(b / r)
                                : C / (std::sqrt(3.) * n) * std::pow(2 * c / std::sqrt(3.), n) *
                                     (std::pow(r, -2 * n) - std::pow(b, -2 * n));
    flow.mean_stress   = -rest + sigma / std::sqrt(3.); // sigma_rr = mean - sigma/sqrt3
    return flow;
  }


  ExactFlow sphere_flow(const Point &x, const double C, const double n)
  {
    const double R = x.norm(), cubed = R * R * R;
    ExactFlow    flow;
    flow.velocity = c / cubed * x;
    for (unsigned int i = 0; i < 2; ++i)
      for (unsigned int j = 0; j < 2; ++j)
        flow.gradient[2 * i + j] = c / cubed * ((i == j) - 3 * x[i] * x[j] / (R * R));
    const double sigma = C * std::pow(2 * c / cubed, n);
    const double rest =
        n == 0 ? 2 * C * std::log(b / R)
               : 2 * C / (3 * n) * std::pow(2 * c, n) * (std::pow(R, -3 * n) - std::pow(b, -3 * n));
    flow.mean_stress = -rest + 2. / 3 * sigma; // sigma_RR = mean - 2/3 sigma
    return flow;
  }


  struct Study
  {
    std::vector<double> velocity, gradient, mean_stress, pressure;

    void add(const FlowErrors &errors, const double pressure_error)
    {
      const auto relative = errors.relative();
      velocity.push_back(relative[0]);
      gradient.push_back(relative[1]);
      mean_stress.push_back(relative[2]);
      pressure.push_back(std::abs(pressure_error));
    }

    void check(const std::string &what, const double largest_pressure_error) const
    {
      const std::string figures = what + "\nvelocity L2 " + table(velocity) + "\nvelocity H1 " +
                                  table(gradient) + "\nmean stress " + table(mean_stress) +
                                  "\ninner pressure " + table(pressure);
      if (std::getenv("AXIFORGE_TEST_FIGURES"))
        std::cout << figures << '\n';
      SCOPED_TRACE(figures);
      EXPECT_GE(orders(velocity).back(), 2.8);
      EXPECT_GE(orders(gradient).back(), 1.8);
      EXPECT_GE(orders(mean_stress).back(), 1.8);
      EXPECT_GE(orders(pressure).back(), 3.5); // it is a power: twice the order of H1
      EXPECT_LT(pressure.back(), largest_pressure_error);
    }
  };


  Entries material(const double C, const double n)
  {
    return n == 0 ? perfectly_plastic(C) : power_law(C, n);
  }
} // namespace


class ExpandingShell : public ::testing::TestWithParam<double>
{
};


TEST_P(ExpandingShell, Cylinder)
{
  const double C = 100, n = GetParam();
  Study        study;
  for (unsigned int level = 0; level < 3; ++level)
    {
      FlowProblem problem(at_start + material(C, n) +
                          workpiece(geometry("tube.geo"), "RadialCells = 4, AxialCells = 2") +
                          Entries{ fmt::format("Workpiece/Refinement levels = {}", level),
                                   "Boundaries = inner", "Boundary inner/Velocity r = 5 / r" });
      const auto  result = problem.solve_at_start();
      study.add(flow_errors(problem.state, result,
                            [C, n](const Point &x) { return cylinder_flow(x, C, n); }),
                result.record.boundaries[0].pressure / cylinder_pressure(C, n) - 1);
    }
  study.check("cylinder", 1e-5);
}


TEST_P(ExpandingShell, Sphere)
{
  const double C = 100, n = GetParam();
  Study        study;
  for (unsigned int level = 0; level < 3; ++level)
    {
      const unsigned int cells = 4 << level;
      FlowProblem        problem(
                 at_start + material(C, n) +
                 workpiece(geometry("sphere.geo"),
                           fmt::format("RadialCells = {}, MeridionalCells = {}", cells, 3 * cells / 2)) +
                 Entries{ "Boundaries = inner", "Boundary inner/Velocity r = 5 * r / (r^2 + z^2)^1.5",
                   "Boundary inner/Velocity z = 5 * z / (r^2 + z^2)^1.5" });
      const auto result = problem.solve_at_start();
      study.add(flow_errors(problem.state, result,
                            [C, n](const Point &x) { return sphere_flow(x, C, n); }),
                result.record.boundaries[0].pressure / sphere_pressure(C, n) - 1);
    }
  study.check("sphere", 1e-4);
}


// A Newtonian fluid in a cone of half angle alpha: v_R = A (cos^2 theta - cos^2 alpha)/R^2. All of
// the boundary is prescribed, and on curved edges the interpolated flux is not zero to the last
// digit: only the plain penalty has an answer, with a mean stress that is free by a constant.
TEST(ConvergingCone, VelocityConverges)
{
  const double      cos_alpha = std::cos(M_PI / 6), A = -1000;
  TemporaryFolder   folder;
  const std::string cone  = folder.file("cone.geo", R"(
DefineConstant[ Cells = {4, Name "Cells"} ];
s = Sin(Pi / 6); c = Cos(Pi / 6);
Point(1) = {0, 0, 0};
Point(2) = {0, 10, 0};
Point(3) = {0, 20, 0};
Point(4) = {20 * s, 20 * c, 0};
Point(5) = {10 * s, 10 * c, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {5, 4};
Circle(4) = {2, 1, 5};
Curve Loop(1) = {-1, 4, 3, -2};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 3 * Cells / 2 + 1;
Transfinite Curve{2, 4} = Cells + 1;
Transfinite Surface{1} = {2, 3, 4, 5};
Recombine Surface{1};
Physical Surface("workpiece") = {1};
Physical Curve("inner") = {4};
Physical Curve("outer") = {2};
Physical Curve("wall") = {3};
)");
  const auto        exact = [=](const Point &x) {
    const double r = x[0], z = x[1], R2 = x.square(), R = std::sqrt(R2), R5 = R2 * R2 * R;
    // v = f x with f = A (z^2 - cos^2 alpha R^2)/R^5
    const double f   = A * (z * z - cos_alpha * cos_alpha * R2) / R5;
    const double f_r = -2 * A * cos_alpha * cos_alpha * r / R5 - 5 * f * r / R2;
    const double f_z = 2 * A * (1 - cos_alpha * cos_alpha) * z / R5 - 5 * f * z / R2;
    ExactFlow    flow;
    flow.velocity = f * x;
    flow.gradient = { { f + f_r * r, f_z * r, f_r * z, f + f_z * z } };
    return flow;
  };

  std::vector<double> velocity, gradient;
  for (unsigned int level = 0; level < 3; ++level)
    {
      Entries entries =
          at_start + power_law(3, 1) + workpiece(cone, fmt::format("Cells = {}", 4 << level)) +
          Entries{ "Boundaries = inner, outer, wall", "Flow solver/Incompressibility = penalty",
                   "Flow solver/Penalty = 1e6", "Flow solver/Tolerance = 1e-8" };
      for (const std::string name : { "inner", "outer", "wall" })
        entries = entries + Entries{ "Boundary " + name + "/Velocity r = 1",
                                     "Boundary " + name + "/Velocity z = 1" };
      FlowProblem problem(entries);
      for (scene::BoundaryCondition &boundary : problem.scene.boundaries)
        for (unsigned int i = 0; i < 2; ++i)
          boundary.velocity[i] = [=](const Point &x, double) { return exact(x).velocity[i]; };
      const auto result = problem.solve_at_start();
      const auto errors = flow_errors(problem.state, result, exact, false).relative();
      velocity.push_back(errors[0]);
      gradient.push_back(errors[1]);
    }
  SCOPED_TRACE("velocity L2 " + table(velocity) + "\nvelocity H1 " + table(gradient));
  EXPECT_GE(orders(velocity).back(), 2.8);
  EXPECT_GE(orders(gradient).back(), 1.8);
}


// 0.02 is near-plastic, 0 is the perfectly plastic limit itself.
INSTANTIATE_TEST_SUITE_P(RateExponent,
                         ExpandingShell,
                         ::testing::Values(1., 0.2, 0.02, 0.),
                         [](const auto &info) {
                           return "n" + std::to_string(std::lround(100 * info.param));
                         });


// Where two parts with a velocity each meet, both hold: a tube whose end planes are held as named
// parts is the tube between symmetry planes.
TEST(PrescribedParts, BothHoldInTheirCorners)
{
  TemporaryFolder   folder;
  const std::string tube = folder.file("tube.geo", R"(
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
Transfinite Curve{1, 3} = 5;
Transfinite Curve{2, 4} = 3;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};
Physical Surface("workpiece") = {1};
Physical Curve("inner") = {4};
Physical Curve("bottom") = {1};
Physical Curve("top") = {3};
)");
  const Entries     inner =
      at_start + power_law(100, 0.2) + Entries{ "Boundary inner/Velocity r = 5 / r" };
  FlowProblem symmetric(inner + Entries{ "Boundaries = inner" } +
                        workpiece(geometry("tube.geo"), "RadialCells = 4, AxialCells = 2"));
  FlowProblem held(inner +
                   Entries{ "Boundaries = inner, bottom, top", "Boundary bottom/Velocity z = 0",
                            "Boundary top/Velocity z = 0" } +
                   workpiece(tube));
  const auto  expected = symmetric.solve_at_start(), result = held.solve_at_start();
  EXPECT_NEAR(result.record.boundaries[0].pressure / expected.record.boundaries[0].pressure, 1,
              1e-9);
  for (unsigned int node = 0; node < held.state.tables.n_nodes; ++node)
    EXPECT_NEAR(result.velocity.local_element(2 * node + 1), 0, 1e-9);
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
