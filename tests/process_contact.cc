// SPDX-License-Identifier: GPL-2.0-or-later

// Contact with corners, with two tools at once, with curved profiles, and its release. Every step
// of every run is held to the conditions of contact themselves: no node is inside a tool, a node
// that touches lies on the profile, and no reaction pulls.

#include "flow_fixture.h"

#include <axiforge/process/step.h>
#include <axiforge/solvers/contact_set.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  const Entries material = swift_power(100, 0.05, 0.2, 0.05);

  Entries tool(const std::string &name, const std::string &file, const std::string &parameters = "")
  {
    return { "Tool " + name + "/Geometry file = " + file,
             "Tool " + name + "/Geometry parameters = " + parameters };
  }

  Entries moving(const std::string &name, const double v)
  {
    return { "Tool " + name + "/Motion/Type = constant velocity",
             "Tool " + name + "/Motion/Velocity = 0, " + number(v) };
  }

  void expect_conditions(const FlowProblem &problem)
  {
    const State &state = problem.state;
    // Of a body that is carried along only round-off is left.
    double largest_reaction = 1e-4 * problem.scene.size * problem.scene.size;
    for (const NodeContact &contact : state.contacts)
      largest_reaction = std::max(largest_reaction, contact.reaction[0]);
    for (unsigned int b = 0; b < state.contacts.size(); ++b)
      {
        const BoundaryNode &node    = state.tables.boundary_nodes[b];
        const NodeContact  &contact = state.contacts[b];
        if (!node.free_surface)
          continue;
        for (const scene::Tool &tool : problem.scene.tools)
          {
            std::array<tools::Contact, 2> found;
            const Point x = state.node_position(node.node) - tool.motion.displacement(state.time);
            if (tool.profile.find(x, 0, found) > 0)
              {
                EXPECT_GT(found[0].gap, -1e-6 * problem.scene.size) << tool.name << " at " << x;
              }
          }
        if (contact.active())
          {
            const scene::Tool            &touched = problem.scene.tools[contact.tool[0]];
            std::array<tools::Contact, 2> found;
            const Point                   x =
                state.node_position(node.node) - touched.motion.displacement(state.time);
            ASSERT_GT(touched.profile.find(x, problem.scene.size, found), 0u);
            EXPECT_NEAR(found[0].gap, 0, 1e-6 * problem.scene.size);
            if (node.axis_neighbour == no_tool) // there the weight is zero
              {
                EXPECT_GT(contact.reaction[0], -1e-5 * largest_reaction);
              }
          }
      }
  }

  std::vector<StepRecord> run(FlowProblem &problem)
  {
    std::vector<StepRecord> records(1);
    while (problem.state.time < problem.scene.end_time() * (1 - 1e-12))
      {
        const double step = process::choose_step_size(problem.scene, problem.state, records.back());
        records.push_back(
            process::advance(problem.scene, problem.state, problem.solver(), step, records.back()));
        expect_conditions(problem);
        EXPECT_EQ(records.back().repeats, 0u);
        EXPECT_LE(std::abs(records.back().power_residual), 1e-4 * records.back().power_tools);
        EXPECT_LT(std::abs(records.back().relative_volume_change), 1e-4);
      }
    records.erase(records.begin());
    return records;
  }
} // namespace


// Backward extrusion: wall and bottom are two tools, and the node in their corner touches both, on
// the faces of a concave corner of one tool as well.
TEST(Corner, holds_a_node_between_two_tools_or_two_faces)
{
  TemporaryFolder   folder;
  const std::string wall = folder.file("wall.csv", "r_mm,z_mm\n25,0\n25,100\n");
  const std::string die  = folder.file("die.csv", "r_mm,z_mm\n0,0\n25,0\n25,100\n");
  const Entries     common =
      Entries{ "Process/End stroke = 1", "Process/Driving tool = punch",
               "Time stepping/Stroke per step = 0.25" } +
      workpiece(geometry("cylinder_full.geo"),
                "Radius = 25, Height = 30, RadialCells = 10, AxialCells = 12") +
      material + tool("punch", geometry("punch.geo"), "Radius = 12, EdgeRadius = 4, Z = 30") +
      moving("punch", -1);
  FlowProblem two(common + Entries{ "Tools = punch, wall, bottom" } + tool("wall", wall) +
                  tool("bottom", geometry("platen.geo"), "Z = 0"));
  FlowProblem one(common + Entries{ "Tools = punch, die" } + tool("die", die));
  const auto  of_two = run(two), of_one = run(one);
  ASSERT_EQ(of_two.size(), of_one.size());
  for (unsigned int i = 0; i < of_two.size(); ++i)
    {
      // Without friction the wall takes no axial force, so the bottom takes that of the punch.
      EXPECT_NEAR(of_two[i].tools[1].force / of_two[i].tools[0].force, 0, 1e-4);
      EXPECT_NEAR(of_two[i].tools[2].force / of_two[i].tools[0].force, 1, 1e-4);
      EXPECT_NEAR(of_one[i].tools[1].force / of_two[i].tools[0].force, 1, 1e-4);
      EXPECT_NEAR(of_one[i].tools[0].force / of_two[i].tools[0].force, 1, 1e-4);
    }
  for (const FlowProblem *problem : { &two, &one })
    {
      unsigned int n_double = 0;
      for (unsigned int b = 0; b < problem->state.contacts.size(); ++b)
        if (problem->state.contacts[b].tool[1] != no_tool)
          {
            ++n_double;
            const Point x =
                problem->state.node_position(problem->state.tables.boundary_nodes[b].node);
            EXPECT_NEAR(x.distance(Point(25, 0)), 0, 1e-9);
          }
      EXPECT_EQ(n_double, 1u);
    }
}


// A cylinder slides up in a bush whose bore widens above z = 12 mm. A node that comes out of the
// narrow part within the step is let go if little presses it on, not if much does; all others stay.
TEST(Departure, lets_go_what_would_have_to_be_pulled_back)
{
  TemporaryFolder folder;
  FlowProblem     problem(Entries{ "Tools = bush", "Process/End stroke = 3" } +
                          workpiece(geometry("cylinder_full.geo"),
                                    "Radius = 25, Height = 30, RadialCells = 2, AxialCells = 10") +
                          material +
                          tool("bush", folder.file("bush.csv", "r_mm,z_mm\n25,-1\n25,12\n"
                                                                   "26,13\n26,100\n")) +
                          moving("bush", -1));
  State          &state = problem.state;
  const auto      place = [&](const unsigned int b) {
    return state.node_position(state.tables.boundary_nodes[b].node);
  };
  for (unsigned int b = 0; b < state.contacts.size(); ++b)
    if (std::abs(place(b)[0] - 25) < 1e-9 && place(b)[1] < 12.1)
      state.contacts[b].tool[0] = 0;
  // Relative to the bush the workpiece goes up by 1 mm: what is above z = 11 mm now comes out.
  Field scale, force;
  scale.reinit(state.velocity);
  force.reinit(state.velocity);
  scale = 50;
  for (const double pressed : { 0.001, 0.9 })
    {
      for (unsigned int node = 0; node < state.tables.n_owned_nodes; ++node)
        force.local_element(2 * node) = -pressed * 100; // the bush presses inwards
      solvers::ContactSet contact(problem.scene, state);
      contact.locate(state.velocity, 1.);
      contact.update_reactions(force);
      const unsigned int released = contact.release_departing(scale);
      unsigned int       expected = 0;
      for (unsigned int b = 0; b < state.contacts.size(); ++b)
        {
          const bool leaves = pressed < 0.1 && state.contacts[b].active() && place(b)[1] > 11.1;
          expected += leaves;
          EXPECT_EQ(contact.nodes[b].active(), state.contacts[b].active() && !leaves)
              << pressed << " at " << place(b);
        }
      EXPECT_EQ(released, expected);
      EXPECT_EQ(released > 0, pressed < 0.1);
    }
}


// A node that has lost its friction gets it back over the steps in which it is pressed.
TEST(Friction, comes_back_to_a_node_that_is_pressed)
{
  FlowProblem problem(
      Entries{ "Tools = upper", "Process/End stroke = 3" } +
      workpiece(geometry("cylinder_full.geo"),
                "Radius = 25, Height = 30, RadialCells = 2, AxialCells = 2") +
      Entries{ "Material/Model = perfectly plastic", "Material/Yield stress = 120" } +
      tool("upper", geometry("platen.geo"), "Z = 30, Radius = 60") + moving("upper", -1));
  for (const auto &[pressure, expected] :
       { std::pair(13., std::array<double, 5>{ { 0.1, 0.3, 0.7, 1, 1 } }),
         std::pair(11., std::array<double, 5>{}) })
    {
      NodeContact &node = problem.state.contacts[0];
      node.tool[0]      = 0;
      node.share        = 0;
      node.pressure     = pressure;
      for (const double share : expected)
        {
          node.share = solvers::ContactSet(problem.scene, problem.state).nodes[0].share;
          EXPECT_NEAR(node.share, share, 1e-12) << pressure;
        }
    }
}


// A pull on all nodes under a platen, as a share of the shear stress that its friction has without
// pressure. Only where contacts adhere, and only what is less than that, is borne.
TEST(Adhesion, bears_less_than_the_shear_stress_of_its_friction)
{
  const double  yield = 120, k = yield / std::sqrt(3.);
  const Entries plastic = { "Material/Model = perfectly plastic", "Material/Yield stress = 120" };
  const std::vector<std::pair<Entries, double>> laws = {
    { { "Tool upper/Friction/Law = sticking" }, k },
    { { "Tool upper/Friction/Law = shear", "Tool upper/Friction/Factor = 0.3" }, 0.3 * k },
    { { "Tool upper/Friction/Law = coulomb", "Tool upper/Friction/Coefficient = 0.3" }, 0 },
    { { "Tool upper/Friction/Law = none" }, 0 }
  };
  for (const auto &[law, bears] : laws)
    {
      FlowProblem problem(Entries{ "Tools = upper", "Process/End stroke = 3" } +
                          workpiece(geometry("cylinder_full.geo"),
                                    "Radius = 25, Height = 30, RadialCells = 4, AxialCells = 4") +
                          plastic + tool("upper", geometry("platen.geo"), "Z = 30, Radius = 60") +
                          moving("upper", -1) + law);
      State      &state = problem.state;
      Field       scale, force;
      scale.reinit(state.velocity);
      force.reinit(state.velocity);
      for (const bool adheres : { false, true })
        for (const double pull : { 0.9 * bears, 1.1 * bears + 1e-3 * k })
          {
            solvers::ContactSet contact(problem.scene, state, adheres);
            contact.locate(state.velocity, 1.);
            contact.set_pressures(state.position);
            for (unsigned int b = 0; b < contact.nodes.size(); ++b)
              for (unsigned int c = 0; c < 2 && contact.nodes[b].active(); ++c)
                {
                  const unsigned int node = state.tables.boundary_nodes[b].node;
                  force.local_element(2 * node + c) =
                      -pull * contact.node_area(node) * contact.nodes[b].normal[0][c];
                }
            contact.update_reactions(force);
            unsigned int n_touching = 0;
            for (const NodeContact &node : contact.nodes)
              n_touching += node.active();
            ASSERT_EQ(n_touching, 9u) << law.front();
            const unsigned int released = contact.release_pulled(scale, 0);
            const bool         borne    = pull == 0 || (adheres && pull < bears);
            EXPECT_EQ(released, borne ? 0u : 8u) // that on the axis has no area and no pull
                << law.front() << (adheres ? " adheres" : "") << " pull " << pull;
          }
    }
}


// A container that the barrel runs into: contact that grows along a wall from the middle.
TEST(Container, stops_the_barrel)
{
  TemporaryFolder folder;
  FlowProblem     problem(Entries{ "Tools = upper, wall", "Process/End stroke = 3",
                               "Time stepping/Stroke per step = 0.25" } +
                          workpiece(geometry("cylinder.geo"), "RadialCells = 8, AxialCells = 8") +
                          material + platen("upper", 25, -0.25, { "Law = smm", "Factor = 0.5" }) +
                          tool("wall", folder.file("wall.csv", "r_mm,z_mm\n27,-1\n27,100\n")));
  const auto      records = run(problem);
  EXPECT_EQ(records.front().tools[1].contact_radius, 0);
  EXPECT_NEAR(records.back().tools[1].contact_radius, 27, 1e-6);
  EXPECT_LT(records.back().largest_radius, 27 * (1 + 2e-3)); // edges bulge between their nodes
  EXPECT_LT(records.back().tools[1].radial_force, 0);
}


// A punch in the middle of a thin disc lifts its rim off the platen.
TEST(Punch, lifts_the_rim)
{
  FlowProblem problem(
      Entries{ "Tools = punch, lower", "Process/End stroke = 1", "Process/Driving tool = punch",
               "Time stepping/Stroke per step = 0.1" } +
      workpiece(
          geometry("billet_for_punch.geo"),
          "Radius = 30, Height = 12, InnerCells = 8, OuterCells = 8, AxialCells = 8, Grading = 2") +
      material + tool("punch", geometry("punch.geo"), "Radius = 10, EdgeRadius = 3, Z = 12") +
      moving("punch", -1) + tool("lower", geometry("platen.geo"), "Z = 0"));
  const auto records = run(problem);
  for (const StepRecord &record : records)
    EXPECT_NEAR(record.tools[1].force / record.tools[0].force, 1, 1e-4);
  EXPECT_LT(records.back().tools[1].contact_radius, 25);
  double rim = 1e300; // height of the outermost node of the lower face
  for (const BoundaryNode &node : problem.state.tables.boundary_nodes)
    if (const Point x = problem.state.node_position(node.node); x[0] > 29.5)
      rim = std::min(rim, x[1]);
  EXPECT_GT(rim, 0.01);
}


// A conical tool with a rounded corner: the force on the frictionless cone balances the symmetry
// plane by the exact power balance, and contact runs from the tip over the corner up the cone.
TEST(Cone, is_followed_over_its_rounded_corner)
{
  FlowProblem problem(
      Entries{ "Tools = cone", "Process/End stroke = 3", "Time stepping/Stroke per step = 0.15" } +
      workpiece(geometry("cylinder.geo"), "RadialCells = 16, AxialCells = 12") + material +
      tool("cone", geometry("cone_tool.geo"),
           "HalfAngle = 75, TipRadius = 5, CornerRadius = 3, Radius = 60, Z = 25") +
      moving("cone", -0.25));
  const auto records = run(problem);
  double     last    = 0;
  for (const StepRecord &record : records)
    {
      EXPECT_GE(record.tools[0].contact_radius, last - 0.02); // nodes slide, too
      last = record.tools[0].contact_radius;
    }
  EXPECT_GT(last, 12);
}


namespace
{
  /// A platen that moves by a table of "time,position", downwards.
  Entries by_table(const TemporaryFolder &folder, const std::string &rows, const Entries &friction)
  {
    Entries entries = platen("upper", 25, 0, friction) + Entries{
      "Tool upper/Motion/Type = table",
      "Tool upper/Motion/Table file = " + folder.file("way.csv", "time_s,position_mm\n" + rows)
    };
    return entries;
  }

  /// Cylinder of 25 mm on its symmetry plane, 25 mm wide, under a platen that moves by a table.
  Entries under_press(const Entries &press, const Entries &of_material, const double end)
  {
    return Entries{ "Tools = upper", "Process/End time = " + number(end) } +
           workpiece(geometry("cylinder.geo"), "RadialCells = 6, AxialCells = 6") + of_material +
           press;
  }
} // namespace


// A platen presses, holds, goes back, and presses again. While it holds or goes away nothing moves,
// no force is left and no iteration is done; then the force is what it was before.
TEST(Withdrawal, leaves_the_workpiece_as_it_is)
{
  const Entries rate = power_law(100, 0.02), plastic = perfectly_plastic(100), hardening = material;
  for (const Entries &of_material : { rate, plastic, hardening })
    for (const Entries &friction :
         { Entries{ "Law = none" }, Entries{ "Law = shear", "Factor = 0.3" },
           Entries{ "Law = smm", "Factor = 0.5" }, Entries{ "Law = sticking" } })
      {
        TemporaryFolder folder;
        FlowProblem     problem(under_press(
                by_table(folder, "0,0\n1,1\n2,1\n3,0\n4,1\n5,2\n", friction), of_material, 5));
        const auto      records = run(problem);
        double          height = 0, force = 0;
        for (const StepRecord &record : records)
          if (record.time <= 1 + 1e-9)
            {
              height = record.height;
              force  = record.tools[0].force;
            }
          else if (record.time <= 4 + 1e-9)
            {
              EXPECT_EQ(record.tools[0].force, 0) << record.time;
              EXPECT_EQ(record.iterations, 0u) << record.time;
              EXPECT_EQ(record.height, height);
              EXPECT_EQ(record.largest_strain_rate, 0);
            }
        EXPECT_NEAR(height, 24, 1e-6);
        EXPECT_NEAR(records.back().height, 23, 1e-6);
        for (const StepRecord &record : records)
          if (record.time > 4 + 1e-9)
            {
              // the next step of the same stroke as if there had been no pause
              EXPECT_NEAR(record.tools[0].force / force, 1, 0.02);
              break;
            }
      }
}


// The upper platen goes up, the lower one follows with the workpiece on it: it is carried, not
// drawn.
TEST(Withdrawal, carries_a_billet_without_force)
{
  TemporaryFolder folder;
  const auto      way = [&](const std::string &name, const std::string &rows) {
    return Entries{ "Tool " + name + "/Motion/Type = table",
                    "Tool " + name + "/Motion/Table file = " +
                        folder.file(name + ".csv", "time_s,position_mm\n" + rows) };
  };
  FlowProblem problem(
      Entries{ "Tools = upper, lower", "Process/End time = 2", "Time stepping/Time step = 0.25" } +
      workpiece(geometry("cylinder_full.geo"),
                "Radius = 25, Height = 25, RadialCells = 6, AxialCells = 6") +
      material + platen("upper", 25, 0, { "Law = shear", "Factor = 0.3" }) +
      platen("lower", 0, 0, { "Law = shear", "Factor = 0.3" }) + way("upper", "0,0\n1,1\n2,-4\n") +
      way("lower", "0,0\n1,0\n2,-2\n"));
  double largest = 0;
  while (problem.state.time < 2 - 1e-9)
    {
      const StepRecord record =
          process::advance(problem.scene, problem.state, problem.solver(), 0.25, StepRecord());
      expect_conditions(problem);
      EXPECT_NEAR(record.height, record.time < 1 + 1e-9 ? 25 - record.time : 24, 1e-5);
      largest = std::max(largest, record.tools[0].force);
      if (record.time > 1 + 1e-9)
        {
          EXPECT_NEAR(record.tools[0].force, 0, 1e-6 * largest);
          EXPECT_NEAR(record.tools[1].force, 0, 1e-6 * largest);
        }
    }
  EXPECT_NEAR(measure(problem.state).lowest, 2, 1e-5);
}


// A platen that ends where the billet does, or where its rim spreads past: what is beyond is free.
// It is the same with a side wall, which nothing touches.
TEST(End, of_a_profile_lets_go_what_is_past_it)
{
  for (const double radius : { 25., 26. })
    {
      TemporaryFolder   folder;
      const std::string r      = number(radius);
      const auto        forces = [&](const std::string &points) {
        FlowProblem problem(Entries{ "Tools = upper", "Process/End stroke = 4" } +
                                   workpiece(geometry("cylinder.geo"), "RadialCells = 8, AxialCells = 8") +
                                   power_law(100, 0.1) +
                                   tool("upper", folder.file("upper.csv", "r_mm,z_mm\n" + points)) +
                                   moving("upper", -1));
        return run(problem);
      };
      const auto ends = forces("0,25\n" + r + ",25\n"),
                 wall = forces("0,25\n" + r + ",25\n" + r + ",60\n");
      EXPECT_NEAR(ends.back().tools[0].force / wall.back().tools[0].force, 1, 0.005) << radius;
      EXPECT_LE(ends.back().tools[0].contact_radius, radius * (1 + 1e-9));
      EXPECT_GT(ends.back().largest_radius, radius + 0.5);
    }
}


// Nodes of the axis and of the symmetry line stay there to the last bit.
TEST(Lines, keep_their_nodes_exactly)
{
  FlowProblem problem(Entries{ "Tools = upper", "Process/End stroke = 3" } +
                      workpiece(geometry("cylinder.geo"), "RadialCells = 5, AxialCells = 7") +
                      material + platen("upper", 25, -0.25, { "Law = smm", "Factor = 0.5" }));
  run(problem);
  unsigned int n_axis = 0, n_symmetry = 0;
  for (const BoundaryNode &node : problem.state.tables.boundary_nodes)
    {
      n_axis += node.on_axis;
      n_symmetry += node.on_symmetry;
      if (node.on_axis)
        {
          EXPECT_EQ(problem.state.node_position(node.node)[0], 0);
        }
      if (node.on_symmetry)
        {
          EXPECT_EQ(problem.state.node_position(node.node)[1], 0);
        }
    }
  EXPECT_EQ(n_axis, 15u);
  EXPECT_EQ(n_symmetry, 11u);
}

int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
