// SPDX-License-Identifier: GPL-2.0-or-later
// The figures of a step say what they are: forces where they hold, pressures that bear the force,
// contacts that end where they end.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/output/results.h>
#include <axiforge/process/step.h>
#include <axiforge/state/contact_ends.h>
#include <axiforge/state/gauges.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double radius = 25, height = 25; // of cylinder.geo, upper half

  Entries cylinder(const Entries &friction, const unsigned int cells, const double stroke_per_step)
  {
    return Entries{ "Tools = upper", "Process/End stroke = 20",
                    "Time stepping/Stroke per step = " + number(stroke_per_step),
                    "Flow solver/Tolerance = 1e-9" } +
           workpiece(geometry("cylinder.geo"),
                     fmt::format("RadialCells = {0}, AxialCells = {0}", cells)) +
           platen("upper", height, -1, friction);
  }

  std::vector<StepRecord> run(FlowProblem &problem, const double stroke)
  {
    std::vector<StepRecord> records(1);
    while (records.back().stroke < stroke * (1 - 1e-9))
      {
        const double step = process::choose_step_size(problem.scene, problem.state, records.back());
        records.push_back(
            process::advance(problem.scene, problem.state, problem.solver(), step, records.back()));
      }
    records.erase(records.begin());
    return records;
  }

  double value(const scene::Scene &scene, const StepRecord &record, const std::string &column)
  {
    const auto names = output::history_columns(scene);
    const auto found = std::find(names.begin(), names.end(), column);
    EXPECT_NE(found, names.end()) << column;
    return output::history_row(scene, record, 0).at(found - names.begin());
  }

  /// Force of the node's pressures: Simpson's rule over the surface, as the part along z, in the
  /// shape of the middle of the last step.
  double force_of_pressures(const State &state)
  {
    double sum = 0;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        if (!state.tables.boundary_nodes[edge.boundary_nodes[2]].free_surface)
          continue;
        std::array<Point, 3> x;
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            x[a][c] =
                state.position.local_element(2 * edge.nodes[a] + c) -
                0.5 * state.last_time_step * state.velocity.local_element(2 * edge.nodes[a] + c);
        const double chord     = x[1][0] - x[0][0];
        const double along[3]  = { 4 * (x[2][0] - x[0][0]) - chord, 4 * (x[1][0] - x[2][0]) - chord,
                                   chord };
        const double weight[3] = { 1. / 6, 1. / 6, 4. / 6 };
        const double sign      = edge.side == 0 || edge.side == 3 ? 1 : -1; // +: r grows, top
        for (unsigned int a = 0; a < 3; ++a)
          sum += sign * weight[a] * along[a] * 2 * M_PI * x[a][0] *
                 state.contacts[edge.boundary_nodes[a]].pressure;
      }
    return sum;
  }
} // namespace


// Without friction F = sigma pi R0^2 h0/h. The columns force and stroke_middle belong together, and
// so do end_force and stroke; force beside stroke would be wrong by half a step.
TEST(Force, BelongsToTheStrokeBesideIt)
{
  const auto exact = [](const double stroke) {
    const double h = height - stroke;
    return 100 * std::pow(0.1 + std::log(height / h), 0.3) * M_PI * radius * radius * height / h;
  };
  std::vector<double> middle, end;
  for (const double step : { 1., 0.5, 0.25 })
    {
      FlowProblem problem(cylinder({ "Law = none" }, 2, step) + swift_power(100, 0.1, 0.3, 0));
      const auto  records  = run(problem, 8);
      double      worst[2] = { 0, 0 };
      for (const StepRecord &record : records)
        {
          const auto column = [&](const std::string &name) {
            return value(problem.scene, record, name);
          };
          EXPECT_NEAR(column("stroke_middle_mm"), record.stroke - 0.5 * step, 1e-9);
          EXPECT_NEAR(column("time_middle_s"), record.time - 0.5 * step, 1e-9);
          if (record.stroke < 4)
            continue; // the first step knows no slope
          worst[0] = std::max(
              worst[0], std::abs(column("force_upper_N") / exact(column("stroke_middle_mm")) - 1));
          worst[1] = std::max(
              worst[1], std::abs(column("end_force_upper_N") / exact(column("stroke_mm")) - 1));
        }
      middle.push_back(worst[0]);
      end.push_back(worst[1]);
    }
  SCOPED_TRACE("middle " + table(middle) + "\nend " + table(end));
  EXPECT_GE(orders(middle).back(), 1.9);
  EXPECT_GE(orders(end).back(), 1.9);
  EXPECT_LT(middle.back(), 1e-4);
  EXPECT_LT(end.back(), 5e-4); // half a step is 0.7 % here
}


// Where nodes are caught the force jumps from step to step: the force at the end is not carried
// beyond what the forces of the steps around it make of it.
TEST(Force, AtTheEndDoesNotCarryOnASawTooth)
{
  FlowProblem problem(cylinder({ "Law = shear", "Factor = 0.5" }, 4, 0.25) +
                      swift_power(100, 0.1, 0.3, 0.1));
  const auto  records = run(problem, 10);
  double      slope   = std::abs(records[1].tools[0].force - records[0].tools[0].force);
  for (unsigned int i = 2; i < records.size(); ++i)
    {
      const double f0 = records[i - 1].tools[0].force, f1 = records[i].tools[0].force,
                   end = records[i].tools[0].end_force;
      // At most the line through both, and at most twice the slope before.
      EXPECT_LE(std::abs(end - f1), 0.5 * std::abs(f1 - f0) * (1 + 1e-9)) << i;
      EXPECT_LE(std::abs(end - f1), slope * (1 + 1e-9)) << i;
      slope = std::abs(f1 - f0);
    }
}


// Uniform pressure is uniform, up to the edge of the cylinder and on the axis; and it bears the
// force.
TEST(ContactPressure, OfUniformCompressionIsTheFlowStress)
{
  FlowProblem problem(cylinder({ "Law = none" }, 4, 0.5) + perfectly_plastic(100));
  const auto  records = run(problem, 2);
  for (const NodeContact &contact : problem.state.contacts)
    if (contact.active())
      {
        EXPECT_NEAR(contact.pressure, 100, 1e-3);
      }
  EXPECT_NEAR(force_of_pressures(problem.state) / records.back().tools[0].force, 1, 1e-7);
}


// A barrel that rolls on to the platen: in every step the pressures bear the force, but for the
// reaction of the node on the axis, whose area is 0, and the last node that touches does not stand
// out. (Over the touching parts of the edges alone it has up to four times its neighbour's.)
TEST(ContactPressure, HasNoPeakAtTheEndAndBearsTheForce)
{
  FlowProblem  problem(cylinder({ "Law = shear", "Factor = 0.5" }, 8, 0.25) +
                       swift_power(100, 0.1, 0.3, 0.1));
  StepRecord   record;
  double       worst   = 0;
  unsigned int n_nodes = 0;
  while (record.stroke < 10 * (1 - 1e-9))
    {
      record = process::advance(problem.scene, problem.state, problem.solver(), 0.25, record);
      EXPECT_NEAR(force_of_pressures(problem.state) / record.tools[0].force, 1, 1e-4)
          << record.stroke;
      std::vector<std::array<double, 2>> pressures;
      for (unsigned int b = 0; b < problem.state.contacts.size(); ++b)
        if (problem.state.contacts[b].active())
          pressures.push_back(
              { { problem.state.node_position(problem.state.tables.boundary_nodes[b].node)[0],
                  problem.state.contacts[b].pressure } });
      std::sort(pressures.begin(), pressures.end());
      const std::size_t n = pressures.size();
      n_nodes             = std::max<unsigned int>(n_nodes, n);
      const double before = std::max(pressures[n - 2][1], pressures[n - 3][1]);
      worst               = std::max(worst, pressures[n - 1][1] / before);
      EXPECT_GT(pressures[n - 1][1], 0) << record.stroke;
      if (std::getenv("AXIFORGE_TEST_FIGURES"))
        fmt::print("{:.2f}  {:.0f} {:.0f} {:.0f} {:.0f}  radius {:.3f}\n", record.stroke,
                   pressures[n - 4][1], pressures[n - 3][1], pressures[n - 2][1],
                   pressures[n - 1][1], record.tools[0].contact_radius);
    }
  EXPECT_GT(n_nodes, 17u) << "nothing rolled over";
  EXPECT_LT(worst, 1.6);
}


namespace
{
  /// A top that touches the platen up to a radius and leaves it as a gap of c (r - end)^p; the
  /// contact set of the nodes as the solver would have it.
  void touch_up_to(FlowProblem &problem, const double end, const double c, const double power)
  {
    problem.map_nodes([&](const Point &x) {
      const double gap = x[1] > height - 1e-9 && x[0] > end ? c * std::pow(x[0] - end, power) : 0;
      return Point(x[0], x[1] - gap);
    });
    for (unsigned int b = 0; b < problem.state.contacts.size(); ++b)
      {
        const BoundaryNode &node  = problem.state.tables.boundary_nodes[b];
        const Point         x     = problem.state.node_position(node.node);
        problem.state.contacts[b] = NodeContact();
        if (node.free_surface && x[1] > height - 1e-12)
          {
            problem.state.contacts[b].tool[0]   = 0;
            problem.state.contacts[b].normal[0] = Vector2({ 0., -1. });
          }
      }
  }

  Entries bulged()
  {
    return Entries{ "Gauges = contact", "Gauge contact/Measure = outer radius",
                    "Gauge contact/At = tool upper" };
  }
} // namespace


// Wherever in an edge a contact ends: with a smooth surface exactly there, with a kink at the last
// node that touches. Nodes alone would jump by half an edge, 1.56 mm.
TEST(ContactEnd, LiesWhereTheSurfaceLeavesTheTool)
{
  for (const double end : { 12.6, 13.3, 14., 14.05, 14.7, 15.5, 15.62 })
    {
      FlowProblem smooth(cylinder({}, 8, 1) + perfectly_plastic(100) + bulged());
      touch_up_to(smooth, end, 0.01, 2);
      EXPECT_NEAR(read_gauges(smooth.scene, smooth.state)[0], end, 2e-3);
      FlowProblem kinked(cylinder({}, 8, 1) + perfectly_plastic(100) + bulged());
      touch_up_to(kinked, 12.5, 0.1, 1);
      EXPECT_NEAR(read_gauges(kinked.scene, kinked.state)[0], 12.5, 1e-9);
    }
}


// All of the end face touches: the contact ends at the edge of the billet, not on its side.
TEST(ContactEnd, IsTheEdgeOfAFullFace)
{
  FlowProblem problem(cylinder({}, 4, 1) + perfectly_plastic(100) + bulged());
  touch_up_to(problem, 100, 0, 1);
  EXPECT_NEAR(read_gauges(problem.scene, problem.state)[0], radius, 1e-9);
}


// A tube between frictionless platens whose bore is closed at a given speed: v_r = V r / (2 H) + C
// / r, which is zero at one radius. It is found wherever it lies in an edge, to the error of the
// flow.
TEST(NeutralRadius, LiesWhereTheRadialVelocityIsZero)
{
  constexpr double  H = 4, V = 1, bore = 10;
  TemporaryFolder   folder;
  const std::string ring = folder.file(
      "ring.geo",
      "Point(1) = {10, 0, 0}; Point(2) = {20, 0, 0}; Point(3) = {20, 4, 0}; Point(4) = {10, 4, "
      "0};\n"
      "Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};\n"
      "Curve Loop(1) = {1:4}; Plane Surface(1) = {1};\n"
      "Transfinite Curve{1, 3} = 5; Transfinite Curve{2, 4} = 2; Transfinite Surface{1};\n"
      "Recombine Surface{1}; Physical Curve(\"inner\") = {4};\n"
      "Physical Curve(\"symmetry\") = {1}; Physical Surface(\"workpiece\") = {1};\n");
  for (const double neutral : { 12.1, 13., 14.37, 15.01, 16.6, 18. })
    {
      double error[2];
      for (const unsigned int level : { 0u, 1u })
        {
          const double inwards = (neutral * neutral - bore * bore) * V / (2 * bore * H);
          FlowProblem  problem(
               Entries{ "Tools = upper", "Tool upper/Geometry file = " + geometry("platen.geo"),
                       fmt::format("Tool upper/Geometry parameters = Z = {}, Radius = 40", H),
                       "Tool upper/Motion/Type = constant velocity",
                       fmt::format("Tool upper/Motion/Velocity = 0, {}", -V),
                       "Process/End stroke = 1", "Boundaries = inner",
                       fmt::format("Boundary inner/Velocity r = {}", -inwards),
                       fmt::format("Workpiece/Refinement levels = {}", level) } +
               power_law(100, 1) + workpiece(ring));
          const StepRecord record =
              process::advance(problem.scene, problem.state, problem.solver(), 1e-7, StepRecord());
          error[level] = record.tools[0].neutral_radius / neutral - 1;
        }
      // The line between two nodes h apart: h^2 / 8 of the curvature over the slope, 1 / r.
      for (const unsigned int level : { 0u, 1u })
        {
          const double h = level ? 0.625 : 1.25;
          EXPECT_LT(std::abs(error[level]), 1.2 * h * h / (8 * neutral * neutral)) << neutral;
        }
    }
}

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
