// SPDX-License-Identifier: GPL-2.0-or-later
// Remeshing: what has to come through exactly, what is kept by construction, and runs that go on
// where the first mesh is used up.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/meshing/remesh.h>
#include <axiforge/meshing/transfer.h>
#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double radius = 25, half_height = 25, speed = 0.25; // mm, mm, mm/s

  Entries scene_with(const Entries &material, const Entries &friction, const unsigned int cells)
  {
    return Entries{ "Tools = upper", "Process/End time = 1e9", "Time stepping/Time step = 1",
                    "Flow solver/Tolerance = 1e-10", "Remeshing/Enabled = true" } +
           material +
           workpiece(geometry("cylinder.geo"),
                     fmt::format("RadialCells = {0}, AxialCells = {0}", cells)) +
           platen("upper", half_height, -speed, friction);
  }


  /// v = a (r/2, -z), incompressible.
  Vector2 linear_velocity(const Point &x)
  {
    return Vector2({ 0.5 * x[0], -x[1] }) * 0.1;
  }


  void set_fields(State &state, const std::function<double(unsigned int)> &strain)
  {
    for (unsigned int node = 0; node < state.tables.n_nodes; ++node)
      for (unsigned int c = 0; c < 2; ++c)
        state.velocity.local_element(2 * node + c) = linear_velocity(state.node_position(node))[c];
    for (unsigned int i = 0; i < state.strain.locally_owned_size(); ++i)
      state.strain.local_element(i) = strain(i);
    state.velocity.update_ghost_values();
  }


  double worst_velocity(const State &state)
  {
    double worst = 0;
    for (unsigned int node = 0; node < state.tables.n_nodes; ++node)
      {
        const Vector2 exact = linear_velocity(state.node_position(node));
        for (unsigned int c = 0; c < 2; ++c)
          worst = std::max(worst, std::abs(state.velocity.local_element(2 * node + c) - exact[c]));
      }
    return worst;
  }


  /// Nodes on the axis and the symmetry line are there, touching ones on the tool.
  void check_boundary(const FlowProblem &problem)
  {
    const State &state = problem.state;
    for (unsigned int b = 0; b < state.tables.boundary_nodes.size(); ++b)
      {
        const BoundaryNode &node = state.tables.boundary_nodes[b];
        const Point         x    = state.node_position(node.node);
        if (node.on_axis)
          {
            EXPECT_EQ(x[0], 0);
          }
        if (node.on_symmetry)
          {
            EXPECT_NEAR(x[1], 0, 1e-14);
          }
        if (state.contacts[b].active())
          {
            EXPECT_NEAR(x[1], half_height - speed * state.time, 1e-9);
          }
      }
  }
} // namespace


TEST(Transfer, LinearVelocityAndUniformStrainAreExact)
{
  for (const bool refined : { false, true })
    {
      SCOPED_TRACE(refined ? "hanging nodes" : "plain mesh");
      FlowProblem problem(scene_with(perfectly_plastic(100), {}, 6));
      // Distorted inside, the same outline.
      problem.map_nodes([](const Point &x) {
        const double bump = 0.02 * x[0] * x[1] * (radius - x[0]) * (half_height - x[1]) / 625;
        return Point(x[0] + bump, x[1] - 0.5 * bump);
      });
      if (refined)
        {
          problem.refine([](const Point &x) { return x[0] > 12 && x[1] > 12; });
          ASSERT_EQ(problem.state.tables.n_global_cells, 36u + 27u);
        }
      State &state = problem.state;
      set_fields(state, [](unsigned int) { return 0.37; });
      const double volume = measure(state).volume;

      const meshing::RemeshResult result = meshing::remesh(problem.scene, state);
      ASSERT_TRUE(result.done) << result.fault;
      EXPECT_LT(worst_velocity(state), 1e-10);
      for (const double strain : state.strain)
        EXPECT_NEAR(strain, 0.37, 1e-10);
      EXPECT_NEAR(result.volume_jump / volume, 0, 1e-10);
      EXPECT_NEAR(measure(state).volume / volume, 1, 1e-10);
      EXPECT_NEAR(result.strain_jump / result.strain_integral, 0, 1e-10);
      EXPECT_GT(result.jacobian, 0.3);
      EXPECT_EQ(state.remeshing.count, 1u);
      check_boundary(problem);
    }
}


TEST(Transfer, StrainStaysWithinItsRange)
{
  FlowProblem problem(scene_with(perfectly_plastic(100), {}, 6));
  State      &state = problem.state;
  // Zero and one in turn: a polynomial that is not limited would leave the range.
  set_fields(state, [](const unsigned int i) { return i % 2; });
  ASSERT_TRUE(meshing::remesh(problem.scene, state).done);
  double least = 1e300, most = -1e300;
  for (const double strain : state.strain)
    {
      least = std::min(least, strain);
      most  = std::max(most, strain);
    }
  EXPECT_GE(least, 0);
  EXPECT_LE(most, 1);
  EXPECT_GT(most - least, 0.5);
}


TEST(Remeshing, VolumeIsRestoredByTheFreeSurface)
{
  FlowProblem problem(scene_with(perfectly_plastic(100), {}, 4));
  // A barrel: the side is curved, and the division of its edges changes the volume.
  problem.map_nodes([](const Point &x) {
    return Point(x[0] * (1 + 0.3 * std::cos(M_PI * x[1] / (2 * half_height))), x[1]);
  });
  State       &state  = problem.state;
  const double volume = measure(state).volume, largest = measure(state).largest_radius;
  set_fields(state, [](unsigned int) { return 0.1; });
  const meshing::RemeshResult result = meshing::remesh(problem.scene, state);
  ASSERT_TRUE(result.done) << result.fault;
  EXPECT_GT(std::abs(result.volume_jump / volume), 1e-9) << "nothing to restore";
  EXPECT_LT(std::abs(result.volume_jump / volume), 2e-3);
  EXPECT_TRUE(result.restored);
  EXPECT_NEAR(measure(state).volume / volume, 1, 1e-10);
  EXPECT_NEAR(measure(state).largest_radius / largest, 1, 1e-3);
  EXPECT_NEAR(measure(state).highest, half_height, 1e-3);
  check_boundary(problem);
}


/// The midpoint rule's own answer, as in process_upsetting.cc: remeshing every 5 steps must not
/// change it. The linear velocity is in every mesh, and the strain is uniform.
TEST(Remeshing, FrictionlessUpsettingStaysExact)
{
  FlowProblem         problem(scene_with(swift_power(100, 0.01, 0.2, 0.02), {}, 4) +
                              Entries{ "Remeshing/Every steps = 5" });
  const scene::Scene &scene = problem.scene;
  State              &state = problem.state;
  const double        dt    = 0.5 * half_height / speed / 25;
  double              r = radius, h = half_height, strain = 0;
  StepRecord          record;
  for (unsigned int step = 1; step <= 25; ++step)
    {
      if (!meshing::reason_to_remesh(scene, state).empty())
        {
          const meshing::RemeshResult result = meshing::remesh(scene, state);
          ASSERT_TRUE(result.done) << result.fault;
          problem.forget_solver();
          check_boundary(problem);
          unsigned int active = 0;
          for (const NodeContact &contact : state.contacts)
            active += contact.active();
          EXPECT_GT(active, 4u);
        }
      record              = process::advance(scene, state, problem.solver(), dt, record);
      const double middle = h - 0.5 * speed * dt;
      const double rate   = speed / middle;
      const double q      = 0.25 * dt * rate;
      const double next_r = r * (1 + q) / (1 - q);
      const double regular =
          std::hypot(rate, scene.flow.regularisation * scene.characteristic_rate);
      const double force = M_PI * std::pow(0.5 * (r + next_r), 2) *
                           scene.material.flow_stress(strain + 0.5 * dt * rate, regular).value *
                           rate / regular;
      strain += dt * rate;
      r = next_r;
      h -= speed * dt;
      ASSERT_NEAR(record.tools[0].force / force, 1, 1e-6) << "step " << step;
      ASSERT_NEAR(record.largest_radius / r, 1, 1e-6) << "step " << step;
      ASSERT_EQ(record.repeats, 0u);
    }
  EXPECT_EQ(state.remeshing.count, 4u);
  for (const double e : state.strain)
    EXPECT_NEAR(e, strain, 1e-6);
}


TEST(Remeshing, NothingHappensUnlessAskedFor)
{
  FlowProblem problem(scene_with(perfectly_plastic(100), {}, 2) +
                      Entries{ "Remeshing/Enabled = false", "Remeshing/Every steps = 1" });
  process::advance(problem.scene, problem.state, problem.solver(), 1);
  EXPECT_EQ(meshing::reason_to_remesh(problem.scene, problem.state), "");
}


int main(int argc, char *argv[])
{
  ::testing::InitGoogleTest(&argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return RUN_ALL_TESTS();
}
