// SPDX-License-Identifier: GPL-2.0-or-later
// Newtonian squeeze between plates with Navier slip of length b, exact at any aspect ratio: with
// W(z) = a z + c z^3, c = -U/(2 H^2 (H + 3b)), a = U (3H + 6b)/(2 H (H + 3b)),
//   v_z = -W, v_r = (r/2) W', p = p0 + mu (W''' r^2/4 - W').
// The plate is a tool with linear viscous friction, mu/b, or with the SMM layer of the workpiece's
// viscosity, b = 3 t/(7 beta); the velocity is imposed on the outer edge.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double H = 10, R = 20, U = 1, mu = 1; // mm, mm, mm/s, MPa s

  struct Squeeze
  {
    explicit Squeeze(const double slip_length)
        : c(-U / (2 * H * H * (H + 3 * slip_length)))
        , a(U * (3 * H + 6 * slip_length) / (2 * H * (H + 3 * slip_length)))
    {
    }

    ExactFlow operator()(const Point &x) const
    {
      const double r = x[0], z = x[1], W = a * z + c * z * z * z, dW = a + 3 * c * z * z;
      ExactFlow    flow;
      flow.velocity    = Vector2({ 0.5 * r * dW, -W });
      flow.gradient    = { { 0.5 * dW, 3 * r * c * z, 0, -dW } };
      flow.mean_stress = -mu * (1.5 * c * r * r - dW);
      return flow;
    }

    /// Power of the friction on the plate [mW]: traction -mu v_r,z times slip.
    double friction_power() const
    {
      return 2 * M_PI * mu * -3 * c * H * 0.5 * (a + 3 * c * H * H) * std::pow(R, 4) / 4;
    }

    double c, a;
  };


  struct SlipStudy
  {
    std::vector<double> velocity, gradient, power;
    double              waviness = 0; ///< of the slip on the finest mesh, relative

    std::string text() const
    {
      return fmt::format(
          "velocity L2 {}: {}\nvelocity H1 {}: {}\nfriction power {}\nwaviness {:.3g}",
          table(velocity), table(orders(velocity)), table(gradient), table(orders(gradient)),
          table(power), waviness);
    }
  };


  SlipStudy study(const double slip_length, const Entries &friction, const unsigned int finest = 16)
  {
    TemporaryFolder   folder;
    const std::string file = folder.file("squeeze.geo", R"(
DefineConstant[ Cells = {4, Name "Cells"} ];
Point(1) = {0, 0, 0};
Point(2) = {20, 0, 0};
Point(3) = {20, 10, 0};
Point(4) = {0, 10, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 2 * Cells + 1;
Transfinite Curve{2, 4} = Cells + 1;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};
Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
Physical Curve("outer") = {2};
Physical Curve("axis") = {4};
)");
    const Squeeze     exact(slip_length);
    SlipStudy         result;
    for (unsigned int cells = 2; cells <= finest; cells *= 2)
      {
        FlowProblem problem(
            Entries{ "Tools = upper", "Boundaries = outer", "Boundary outer/Velocity r = 1",
                     "Boundary outer/Velocity z = 1", "Time stepping/Scheme = explicit euler",
                     "Time stepping/Time step = 1", "Process/End time = 1",
                     "Flow solver/Tolerance = 1e-10", "Flow solver/Most iterations = 300" } +
            power_law(3 * mu, 1) + workpiece(file, fmt::format("Cells = {}", cells)) +
            platen("upper", H, -U, friction));
        const double dt = 1e-3;
        for (unsigned int i = 0; i < 2; ++i)
          problem.scene.boundaries[0].velocity[i] = [=](const Point &x, double) {
            return exact(x).velocity[i];
          };
        // All velocities normal to the boundary are given, so the mean of the mean stress is free:
        // it stays what it is at the start. Pressed together, nothing comes off the plate.
        for (CellHistory &history : problem.state.cell_history)
          history.pressure[0] = -100;
        const auto result_here = problem.solve_at_start(dt);
        const auto errors      = flow_errors(problem.state, result_here, exact, false).relative();
        result.velocity.push_back(errors[0]);
        result.gradient.push_back(errors[1]);
        result.power.push_back(
            std::abs(result_here.record.power_friction / exact.friction_power() - 1));
        // Slip against the exact one on the plate, the nodes beside the imposed edge left out.
        result.waviness = 0;
        for (unsigned int b = 0; b < result_here.contacts.size(); ++b)
          {
            const unsigned int node = problem.state.tables.boundary_nodes[b].node;
            const Point        x    = problem.state.node_position(node);
            if (result_here.contacts[b].active() && x[0] > 0.2 * R && x[0] < 0.9 * R)
              result.waviness =
                  std::max(result.waviness, std::abs(result_here.velocity.local_element(2 * node) /
                                                         exact(x).velocity[0] -
                                                     1));
          }
      }
    if (std::getenv("AXIFORGE_TEST_FIGURES"))
      std::cout << "b = " << slip_length << '\n' << result.text() << '\n';
    return result;
  }


  void expect_orders(const SlipStudy &study)
  {
    SCOPED_TRACE(study.text());
    EXPECT_GE(orders(study.velocity).back(), 2.8);
    EXPECT_GE(orders(study.gradient).back(), 1.8);
    EXPECT_LT(study.power.back(), 1e-4);
  }
} // namespace


TEST(NavierSlip, LinearViscousFriction)
{
  for (const double b : { 0.1, 1., 10., 100. })
    expect_orders(study(b, { "Law = norton", "Exponent = 1", "Viscosity = " + number(mu / b) }));
}


TEST(NavierSlip, SmmLayerWithTheViscosityOfTheWorkpiece)
{
  constexpr double t = 1e-3; // thin, so that the layer's own hoop and radial strains vanish
  for (const double b : { 0.1, 1., 10., 100. })
    {
      const double beta = 3 * t / (7 * b);
      expect_orders(
          study(b, { "Law = smm", "Layer viscosity = workpiece", "Layer thickness = " + number(t),
                     "Factor = " + number(beta / (1 + beta)) }));
    }
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
