// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <axiforge/process/end_condition.h>
#include <axiforge/state/state.h>

namespace axiforge::process
{
  namespace
  {
    struct Limits
    {
      double force, height, fill; ///< passed by so much of the limit; -1: no limit
    };


    Limits passed(const scene::Scene &scene, const StepRecord &record)
    {
      const scene::ProcessParameters &end = scene.process;
      Limits                          result{ -1, -1, -1 };
      if (record.step == 0)
        return result;
      if (end.end_force > 0)
        result.force = record.end_force / end.end_force - 1;
      if (end.end_height > 0)
        result.height = 1 - record.height / end.end_height;
      if (end.end_fill > 0)
        result.fill = record.fill / end.end_fill - 1;
      return result;
    }
  } // namespace


  double passed_end(const scene::Scene &scene, const StepRecord &record)
  {
    const Limits limits = passed(scene, record);
    return std::max({ limits.force, limits.height, limits.fill });
  }


  bool is_full(const scene::Scene &scene, const StepRecord &record, const double share)
  {
    return scene.driving_tool != no_tool && std::isfinite(record.time_to_fill) &&
           record.time_to_fill *
                   scene.tools[scene.driving_tool].motion.velocity(record.time).norm() <=
               share * record.stroke;
  }


  std::string ended_by(const scene::Scene &scene, const StepRecord &record)
  {
    const Limits limits = passed(scene, record);
    if (limits.force >= -end_tolerance)
      return "force";
    if (limits.height >= -end_tolerance)
      return "height";
    if (limits.fill >= -end_tolerance)
      return "fill";
    if (is_full(scene, record, filled))
      return "full";
    if (record.time >= scene.end_time() * (1 - 1e-12))
      return scene.process.end_stroke > 0 && record.stroke >= scene.process.end_stroke * (1 - 1e-9)
                 ? "stroke"
                 : "time";
    if (record.step >= scene.time.most_steps)
      return "steps";
    return "";
  }
} // namespace axiforge::process
