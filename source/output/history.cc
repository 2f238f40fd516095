// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/output/results.h>

namespace axiforge::output
{
  namespace
  {
    using Columns = std::vector<std::pair<std::string, double>>;

    /// Names and values together, so that they can't part ways.
    Columns columns(const scene::Scene &scene, const StepRecord &r, const double wall_seconds)
    {
      Columns list = { { "step", r.step },
                       { "time_s", r.time },
                       { "stroke_mm", r.stroke },
                       { "time_step_s", r.time_step },
                       { "time_middle_s", r.time_middle },
                       { "stroke_middle_mm", r.stroke_middle } };
      for (unsigned int i = 0; i < scene.tools.size(); ++i)
        {
          const std::string &name = scene.tools[i].name;
          const ToolRecord   tool = i < r.tools.size() ? r.tools[i] : ToolRecord();
          list.insert(list.end(), { { "force_" + name + "_N", tool.force },
                                    { "end_force_" + name + "_N", tool.end_force },
                                    { "radial_force_" + name + "_N", tool.radial_force },
                                    { "contact_radius_" + name + "_mm", tool.contact_radius },
                                    { "neutral_radius_" + name + "_mm", tool.neutral_radius } });
        }
      for (unsigned int i = 0; i < scene.boundaries.size(); ++i)
        {
          const std::string   &name = scene.boundaries[i].name;
          const BoundaryRecord boundary =
              i < r.boundaries.size() ? r.boundaries[i] : BoundaryRecord();
          list.insert(list.end(), { { "force_" + name + "_N", boundary.force },
                                    { "power_" + name + "_mW", boundary.power },
                                    { "pressure_" + name + "_MPa", boundary.pressure } });
        }
      list.insert(list.end(), { { "volume_mm3", r.volume },
                                { "relative_volume_change", r.relative_volume_change },
                                { "power_tools_mW", r.power_tools },
                                { "power_boundaries_mW", r.power_boundaries },
                                { "power_plastic_mW", r.power_plastic },
                                { "power_friction_mW", r.power_friction },
                                { "power_contact_mW", r.power_contact },
                                { "power_volume_mW", r.power_volume },
                                { "power_residual_mW", r.power_residual },
                                { "tension_N", r.tension },
                                { "largest_strain", r.largest_strain },
                                { "largest_strain_rate_per_s", r.largest_strain_rate },
                                { "largest_radius_mm", r.largest_radius },
                                { "height_mm", r.height },
                                { "smallest_jacobian", r.smallest_jacobian },
                                { "smallest_vertex_jacobian", r.smallest_vertex_jacobian },
                                { "cells", r.cells },
                                { "unknowns", r.unknowns },
                                { "iterations", r.iterations },
                                { "set_changes", r.set_changes },
                                { "repeats", r.repeats },
                                { "residual", r.residual },
                                { "divergence", r.divergence },
                                { "wall_s", wall_seconds },
                                { "wall_assembly_s", r.times.assembly + r.times.residual },
                                { "wall_contact_s", r.times.contact },
                                { "wall_factor_s", r.times.factor },
                                { "wall_solve_s", r.times.solve } });
      if (scene.flow.estimate_condition)
        list.emplace_back("condition", r.condition);
      if (scene.process.fill_radius > 0)
        list.emplace_back("fill", r.fill);
      if (scene.accuracy.estimated)
        list.insert(list.end(), { { "error_space", r.errors.space },
                                  { "error_time", r.errors.time },
                                  { "error_regularisation", r.errors.regularisation },
                                  { "error_nonlinear", r.errors.nonlinear },
                                  { "error_total", r.errors.total() } });
      for (unsigned int i = 0; i < scene.gauges.size(); ++i)
        list.emplace_back("gauge_" + scene.gauges[i].name + "_mm",
                          i < r.gauges.size() ? r.gauges[i] : 0.);
      if (scene.remeshing.enabled)
        list.insert(list.end(), { { "remeshings", r.remeshings },
                                  { "remeshing_volume_jump_mm3", r.remeshing_volume_jump },
                                  { "remeshing_strain_jump_mm3", r.remeshing_strain_jump } });
      return list;
    }
  } // namespace


  std::vector<std::string> history_columns(const scene::Scene &scene)
  {
    std::vector<std::string> names;
    for (const auto &column : columns(scene, StepRecord(), 0))
      names.push_back(column.first);
    return names;
  }


  std::vector<double>
  history_row(const scene::Scene &scene, const StepRecord &record, const double wall_seconds)
  {
    std::vector<double> values;
    for (const auto &column : columns(scene, record, wall_seconds))
      values.push_back(column.second);
    return values;
  }
} // namespace axiforge::output
