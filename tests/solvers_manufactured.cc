// SPDX-License-Identifier: GPL-2.0-or-later
// Manufactured solutions: any stream function gives an incompressible velocity v = curl(psi/r
// e_theta), and automatic differentiation gives the body force that drives it. Orders of
// convergence on straight, distorted, curved and hanging-node meshes.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"
#include <Sacado.hpp>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  using First  = Sacado::Fad::SFad<double, 2>; // value and gradient in (r, z)
  using Second = Sacado::Fad::SFad<First, 2>;

  constexpr double height = 1; // of the square [mm]

  /// sigma = K (prestrain + strain)^hardening epsdot^n, with a strain that is a given function of
  /// the position. hardening = 0: no dependence on the strain.
  struct Law
  {
    double strength, prestrain, hardening, n, smallest_rate;

    template <typename Number> static Number strain(const Number &r, const Number &z)
    {
      return 0.3 + 0.2 * cos(2. * r) * sin(1. + z);
    }

    template <typename Number> Number flow_stress(const Number &eps, const Number &rate) const
    {
      return strength * pow(prestrain + eps, hardening) * pow(rate, n);
    }
  };


  /// Velocity of psi = r^2 (1 + r^2/2) g(z) with g = 1 - z + 0.3 (1 - z)^3 + sin(pi z)/(2 pi). The
  /// shear rate vanishes at the end z = 1, and the strain rate nowhere.
  template <typename Number> std::array<Number, 2> velocity(const Number &r, const Number &z)
  {
    const Number y  = 1. - z;
    const Number g  = y + 0.3 * y * y * y + sin(M_PI * z) / (2 * M_PI);
    const Number dg = -1. - 0.9 * y * y + 0.5 * cos(M_PI * z);
    return { { -r * (1. + 0.5 * r * r) * dg, (2. + 2. * r * r) * g } };
  }


  struct Stress
  {
    First rr, zz, tt, rz;
  };


  /// Deviator at a point whose coordinates carry their own derivatives.
  Stress deviator(const Law &law, const First &r, const First &z)
  {
    // The outer derivative makes the strain rates, the inner one their gradient.
    Second R(r), Z(z);
    R.resize(2);
    Z.resize(2);
    R.fastAccessDx(0)              = 1;
    R.fastAccessDx(1)              = 0;
    Z.fastAccessDx(0)              = 0;
    Z.fastAccessDx(1)              = 1;
    const std::array<Second, 2> v  = velocity(R, Z);
    const First                 rr = v[0].dx(0), zz = v[1].dx(1), tt = v[0].val() / r;
    const First                 rz     = 0.5 * (v[0].dx(1) + v[1].dx(0));
    const First                 square = 2. / 3 * (rr * rr + zz * zz + tt * tt + 2. * rz * rz) +
                         law.smallest_rate * law.smallest_rate;
    const First rate  = sqrt(square);
    const First sigma = law.flow_stress(First(Law::strain(r, z)), rate);
    const First two_mu(2. / 3 * sigma / rate);
    return { two_mu * rr, two_mu * zz, two_mu * tt, two_mu * rz };
  }


  /// Mean stress: an arbitrary one, shifted so that the end z = height is free of normal stress.
  First mean_stress(const Law &law, const First &r, const First &z)
  {
    const auto arbitrary = [](const First &r, const First &z) -> First {
      return 0.5 * cos(3. * r) * exp(-z);
    };
    const First end(height); // without derivatives
    const First at_end = arbitrary(r, end) + deviator(law, r, end).zz;
    return arbitrary(r, z) - at_end;
  }


  ExactFlow exact_flow(const Law &law, const Point &x)
  {
    const First                r(2, 0, x[0]), z(2, 1, x[1]);
    const std::array<First, 2> v = velocity(r, z);
    ExactFlow                  flow;
    for (unsigned int i = 0; i < 2; ++i)
      {
        flow.velocity[i] = v[i].val();
        for (unsigned int j = 0; j < 2; ++j)
          flow.gradient[2 * i + j] = v[i].dx(j);
      }
    flow.mean_stress = mean_stress(law, r, z).val();
    return flow;
  }


  /// b = -div sigma in cylindrical coordinates.
  Vector2 body_force(const Law &law, const Point &x)
  {
    const First  r(2, 0, x[0]), z(2, 1, x[1]);
    const Stress s = deviator(law, r, z);
    const First  p = mean_stress(law, r, z);
    Vector2      b;
    b[0] = -(s.rr.dx(0) + p.dx(0) + s.rz.dx(1) + (s.rr.val() - s.tt.val()) / x[0]);
    b[1] = -(s.rz.dx(0) + s.zz.dx(1) + p.dx(1) + s.rz.val() / x[0]);
    return b;
  }


  enum class Mesh
  {
    straight,
    distorted, // trapezoids of the same shape on every level (Arnold, Boffi, Falk 2002)
    curved,
    hanging
  };

  const char *const mesh_names[] = { "straight", "distorted", "curved", "hanging" };

  struct LawCase
  {
    const char *name;
    double      hardening, n;
  };


  void change_mesh(FlowProblem &problem, const Mesh mesh, const unsigned int cells)
  {
    if (mesh == Mesh::hanging)
      {
        problem.refine([](const Point &x) { return x[0] > 0.5 && x[1] > 0.5; });
        return;
      }
    if (mesh == Mesh::distorted)
      problem.map_vertices([cells](const Point &x) {
        const long row = std::lround(x[1] * cells), column = std::lround(x[0] * cells);
        const bool inside = row % 2 == 1;
        return inside ? Point(x[0], x[1] + (column % 2 ? 0.25 : -0.25) / cells) : x;
      });
    if (mesh == Mesh::curved) // all of the side is curved, both ends stay straight
      problem.map_nodes([](const Point &x) {
        return Point(x[0] * (1 + 0.15 * std::sin(M_PI * x[1])),
                     x[1] + 0.1 * std::sin(M_PI * x[1]) * std::cos(M_PI * x[0]));
      });
  }
} // namespace


class Manufactured : public ::testing::TestWithParam<std::tuple<Mesh, LawCase>>
{
};


TEST_P(Manufactured, Converges)
{
  const Mesh      mesh     = std::get<0>(GetParam());
  const LawCase   law_case = std::get<1>(GetParam());
  TemporaryFolder folder;
  // Corners belong to the velocity: the end z = 1 is free, with zero traction in the exact
  // solution.
  const std::string square = folder.file("square.geo", R"(
DefineConstant[ Cells = {4, Name "Cells"} ];
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 1, 0};
Point(4) = {0, 1, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = Cells + 1;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};
Physical Surface("workpiece") = {1};
Physical Curve("bottom") = {1};
Physical Curve("side") = {2};
Physical Curve("axis") = {4};
)");

  std::vector<double>       velocity_errors, gradient_errors, stress_errors;
  std::vector<unsigned int> iterations;
  for (unsigned int cells = 4; cells <= 16; cells *= 2)
    {
      const Entries material = law_case.hardening > 0
                                   ? swift_power(10, 0.1, law_case.hardening, law_case.n)
                                   : power_law(10, law_case.n);
      FlowProblem   problem(
            material + workpiece(square, fmt::format("Cells = {}", cells)) +
            Entries{ "Time stepping/Scheme = explicit euler", "Process/End time = 1",
                   "Time stepping/Time step = 1", "Boundaries = bottom, side",
                   "Boundary bottom/Velocity r = 1", "Boundary bottom/Velocity z = 1",
                   "Boundary side/Velocity r = 1", "Boundary side/Velocity z = 1",
                   "Flow solver/Reference strain rate = 1", "Flow solver/Tolerance = 1e-9" });
      change_mesh(problem, mesh, cells);
      const Law    law{ 10, 0.1, law_case.hardening, law_case.n,
                     problem.scene.flow.regularisation * problem.scene.characteristic_rate };
      const double sample = law_case.hardening > 0 ? 0.4 : 0;
      ASSERT_NEAR(problem.scene.material.flow_stress(sample, 0.7).value,
                  law.flow_stress(sample, 0.7), 1e-12);

      State &state = problem.state;
      for (scene::BoundaryCondition &boundary : problem.scene.boundaries)
        for (unsigned int i = 0; i < 2; ++i)
          boundary.velocity[i] = [i](const Point &x, double) { return velocity(x[0], x[1])[i]; };
      problem.scene.body_force = [law](const Point &x) { return body_force(law, x); };
      const solvers::ReferenceCell &reference = solvers::ReferenceCell::get();
      for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
        for (unsigned int q = 0; q < 9; ++q)
          {
            Point x;
            for (unsigned int a = 0; a < 9; ++a)
              x += reference.shape[q][a] * state.node_position(state.tables.cells[cell][a]);
            state.strain.local_element(state.tables.first_strain_dof[cell] + q) =
                Law::strain(x[0], x[1]);
          }

      const auto result = problem.solve_at_start();
      const auto errors = flow_errors(state, result, [law](const Point &x) {
                            return exact_flow(law, x);
                          }).relative();
      velocity_errors.push_back(errors[0]);
      gradient_errors.push_back(errors[1]);
      stress_errors.push_back(errors[2]);
      iterations.push_back(result.record.iterations);
    }
  SCOPED_TRACE(
      fmt::format("velocity L2 {}: {}\nvelocity H1 {}: {}\nmean stress {}: {}\niterations {}",
                  table(velocity_errors), table(orders(velocity_errors)), table(gradient_errors),
                  table(orders(gradient_errors)), table(stress_errors),
                  table(orders(stress_errors)), fmt::join(iterations, " ")));
  if (std::getenv("AXIFORGE_TEST_FIGURES"))
    std::cout << table(velocity_errors) << " | " << table(gradient_errors) << " | "
              << table(stress_errors) << '\n';
  EXPECT_GE(orders(velocity_errors).back(), 2.8);
  EXPECT_GE(orders(gradient_errors).back(), 1.8);
  EXPECT_GE(orders(stress_errors).back(), 1.8);
}


INSTANTIATE_TEST_SUITE_P(
    Meshes,
    Manufactured,
    ::testing::Combine(
        ::testing::Values(Mesh::straight, Mesh::distorted, Mesh::curved, Mesh::hanging),
        ::testing::Values(LawCase{ "newtonian", 0, 1 },
                          LawCase{ "rate_02", 0, 0.2 },
                          LawCase{ "hardening", 0.3, 0.1 })),
    [](const auto &info) {
      return std::string(mesh_names[static_cast<int>(std::get<0>(info.param))]) + "_" +
             std::get<1>(info.param).name;
    });


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
