// SPDX-License-Identifier: GPL-2.0-or-later
// What is written is what it is called: every column of history.csv shows its own member of the
// record, and every field of a VTU file its own stress, with sign and mean.
#include <map>

#include <deal.II/base/data_out_base.h>
#include <deal.II/base/mpi.h>
#include <deal.II/numerics/data_out.h>

#include "flow_fixture.h"

#include <axiforge/output/results.h>
#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  /// The fields by their names at all points of the patches, from the file's own data.
  class Fields : public dealii::DataOutReader<2, 2>
  {
  public:
    explicit Fields(const State &state)
    {
      std::stringstream text;
      output::collect_fields(state)->write_deal_II_intermediate(text);
      read(text);
      const auto names = get_dataset_names();
      for (const auto &patch : get_patches())
        for (unsigned int i = 0; i < patch.data.n_cols(); ++i)
          {
            for (unsigned int k = 0; k < names.size(); ++k)
              values[names[k]].push_back(patch.data(k, i));
            // points of curved cells are the last rows
            const unsigned int first = patch.data.n_rows() - 2;
            x.push_back(Point(patch.data(first, i), patch.data(first + 1, i)));
          }
    }

    std::map<std::string, std::vector<double>> values;
    std::vector<Point>                         x;
  };
} // namespace


TEST(History, EveryColumnShowsItsOwnMember)
{
  FlowProblem problem(
      Entries{ "Tools = upper", "Boundaries = outer", "Process/End time = 1",
               "Process/Fill radius = 10", "Flow solver/Estimate condition = true",
               "Remeshing/Enabled = true", "Gauges = width", "Gauge width/Measure = outer radius",
               "Accuracy/Estimate errors = true", "Boundary outer/Velocity r = 1" } +
      perfectly_plastic(100) + workpiece(geometry("tube.geo")) + platen("upper", 5, -1));

  StepRecord                    r;
  std::map<std::string, double> expected;
  double                        next = 100;
  const auto                    set  = [&](const std::string &column, auto &member) {
    member           = next;
    expected[column] = next++;
  };
  set("step", r.step);
  set("time_s", r.time);
  set("stroke_mm", r.stroke);
  set("time_step_s", r.time_step);
  set("time_middle_s", r.time_middle);
  set("stroke_middle_mm", r.stroke_middle);
  r.tools.resize(1);
  set("force_upper_N", r.tools[0].force);
  set("end_force_upper_N", r.tools[0].end_force);
  set("radial_force_upper_N", r.tools[0].radial_force);
  set("contact_radius_upper_mm", r.tools[0].contact_radius);
  set("neutral_radius_upper_mm", r.tools[0].neutral_radius);
  r.boundaries.resize(1);
  set("force_outer_N", r.boundaries[0].force);
  set("power_outer_mW", r.boundaries[0].power);
  set("pressure_outer_MPa", r.boundaries[0].pressure);
  set("volume_mm3", r.volume);
  set("relative_volume_change", r.relative_volume_change);
  set("power_tools_mW", r.power_tools);
  set("power_boundaries_mW", r.power_boundaries);
  set("power_plastic_mW", r.power_plastic);
  set("power_friction_mW", r.power_friction);
  set("power_contact_mW", r.power_contact);
  set("power_volume_mW", r.power_volume);
  set("power_residual_mW", r.power_residual);
  set("tension_N", r.tension);
  set("largest_strain", r.largest_strain);
  set("largest_strain_rate_per_s", r.largest_strain_rate);
  set("largest_radius_mm", r.largest_radius);
  set("height_mm", r.height);
  set("smallest_jacobian", r.smallest_jacobian);
  set("smallest_vertex_jacobian", r.smallest_vertex_jacobian);
  set("cells", r.cells);
  set("unknowns", r.unknowns);
  set("iterations", r.iterations);
  set("set_changes", r.set_changes);
  set("repeats", r.repeats);
  set("residual", r.residual);
  set("divergence", r.divergence);
  set("wall_assembly_s", r.times.assembly);
  r.times.residual = 0.5;
  expected["wall_assembly_s"] += 0.5;
  set("wall_contact_s", r.times.contact);
  set("wall_factor_s", r.times.factor);
  set("wall_solve_s", r.times.solve);
  expected["wall_s"] = 7;
  set("condition", r.condition);
  set("fill", r.fill);
  set("error_space", r.errors.space);
  set("error_time", r.errors.time);
  set("error_regularisation", r.errors.regularisation);
  set("error_nonlinear", r.errors.nonlinear);
  expected["error_total"] = r.errors.total();
  r.gauges.resize(1);
  set("gauge_width_mm", r.gauges[0]);
  set("remeshings", r.remeshings);
  set("remeshing_volume_jump_mm3", r.remeshing_volume_jump);
  set("remeshing_strain_jump_mm3", r.remeshing_strain_jump);

  const auto names  = output::history_columns(problem.scene);
  const auto values = output::history_row(problem.scene, r, 7);
  ASSERT_EQ(names.size(), values.size());
  EXPECT_EQ(names.size(), expected.size());
  for (unsigned int i = 0; i < names.size(); ++i)
    {
      ASSERT_EQ(expected.count(names[i]), 1u) << names[i];
      EXPECT_EQ(values[i], expected[names[i]]) << names[i];
    }
}


// Compressed without friction at 2 % per second: every stress is known, and what touches has the
// flow stress as its pressure.
TEST(VtuFields, OfUniformCompression)
{
  FlowProblem problem(
      Entries{ "Tools = upper", "Process/End time = 1", "Time stepping/Time step = 0.1" } +
      power_law(100, 0.2) + workpiece(geometry("cylinder.geo"), "RadialCells = 2, AxialCells = 2") +
      platen("upper", 25, -0.5, { "Law = none" }));
  process::advance(problem.scene, problem.state, problem.solver(), 0.1, StepRecord());
  const double                        rate = 0.5 / (25 - 0.025), sigma = 100 * std::pow(rate, 0.2);
  const Fields                        fields(problem.state);
  const std::map<std::string, double> expected = {
    { "strain", 0.1 * rate }, { "strain_rate", rate },       { "effective_stress", sigma },
    { "flow_stress", sigma }, { "mean_stress", -sigma / 3 }, { "pressure", sigma / 3 },
    { "stress_rr", 0 },       { "stress_zz", -sigma },       { "stress_tt", 0 },
    { "stress_rz", 0 }
  };
  for (const auto &[name, value] : expected)
    {
      ASSERT_EQ(fields.values.count(name), 1u) << name;
      for (const double found : fields.values.at(name))
        EXPECT_NEAR(found, value, 1e-5 * (name.rfind("strain", 0) == 0 ? rate : sigma)) << name;
    }
  unsigned int touching = 0;
  for (unsigned int i = 0; i < fields.x.size(); ++i)
    {
      const bool touches = fields.x[i][1] > 25 - 0.05 - 1e-9;
      touching += touches;
      EXPECT_NEAR(fields.values.at("contact_pressure")[i], touches ? sigma : 0, 1e-4 * sigma);
      EXPECT_EQ(fields.values.at("friction_traction")[i], 0);
    }
  EXPECT_GT(touching, 4u);
}


// A tube under pressure in plane strain: sigma_rr = -p(r), sigma_tt = sigma_rr + 2 k, sigma_zz
// between them, with k = sigma/sqrt3 (n = 1: Lame's solution of a viscous tube).
TEST(VtuFields, OfATubeUnderPressure)
{
  constexpr double a = 10, b = 20, p = 30, C = 300;
  FlowProblem      problem(
           Entries{ "Boundaries = inner", "Boundary inner/Type = pressure",
               "Boundary inner/Pressure = " + number(p), "Process/End time = 1",
               "Time stepping/Time step = 1", "Flow solver/Reference strain rate = 0.1" } +
           power_law(C, 1) + workpiece(geometry("tube.geo"), "RadialCells = 16, AxialCells = 2"));
  // so short a step that the middle is the start
  process::advance(problem.scene, problem.state, problem.solver(), 1e-6, StepRecord());
  const Fields fields(problem.state);
  const double scale = p / (1 / (a * a) - 1 / (b * b));
  for (unsigned int i = 0; i < fields.x.size(); ++i)
    {
      const double r  = fields.x[i][0];
      const auto   at = [&](const std::string &name) { return fields.values.at(name)[i]; };
      const double rr = -scale * (1 / (r * r) - 1 / (b * b)),
                   tt = scale * (1 / (r * r) + 1 / (b * b)), zz = 0.5 * (rr + tt);
      const double tolerance = 0.03 * p; // of the recovery at the surface
      EXPECT_NEAR(at("stress_rr"), rr, tolerance);
      EXPECT_NEAR(at("stress_tt"), tt, tolerance);
      EXPECT_NEAR(at("stress_zz"), zz, tolerance);
      EXPECT_NEAR(at("stress_rz"), 0, tolerance);
      EXPECT_NEAR(at("mean_stress"), zz, tolerance);
      EXPECT_NEAR(at("pressure"), -zz, tolerance);
      EXPECT_NEAR(at("effective_stress"), std::sqrt(3.) / 2 * (tt - rr), 2 * tolerance);
      EXPECT_NEAR(at("flow_stress"), at("effective_stress"), tolerance);
    }
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
