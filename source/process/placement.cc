// SPDX-License-Identifier: GPL-2.0-or-later
#include <cmath>
#include <limits>

#include <axiforge/base/errors.h>
#include <axiforge/base/wording.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/process/placement.h>
#include <axiforge/state/turn_over.h>
#include <axiforge/tools/positioning.h>
#include <axiforge/tools/profile_reader.h>

namespace axiforge::process
{
  namespace
  {
    const scene::ToolParameters &find_tool(const scene::SceneParameters &parameters)
    {
      std::vector<std::string> names;
      for (const scene::ToolParameters &tool : parameters.tools)
        {
          if (tool.name == parameters.placement.rest_on)
            return tool;
          names.push_back(tool.name);
        }
      throw InputError::entry("Placement/Rest on", parameters.placement.rest_on,
                              "there is no tool of this name", list_in_words(names),
                              "Name one of them, or leave the entry empty");
    }


    void rest_on(const scene::SceneParameters &parameters, State &state)
    {
      const scene::ToolParameters &tool    = find_tool(parameters);
      const std::string            section = "Tool " + tool.name;
      tools::Profile profile = tools::read_profile(tool.geometry, section, parameters.directory);
      const scene::WorkpieceOutline outline = meshing::outline_of(state);
      // It is the same whether the workpiece comes down or the tool comes up.
      const Vector2 way =
          tools::bring_to_contact(profile, outline.boundary_points, Vector2({ 0., 1. }),
                                  tools::touching_tolerance * (outline.upper - outline.lower).norm(), section);
      move_axially(state, -way[1]);
    }
  } // namespace


  void place_workpiece(const scene::SceneParameters &parameters, State &state)
  {
    if (parameters.placement.flip)
      turn_over(state);
    let_go(state);
    if (!parameters.placement.rest_on.empty())
      rest_on(parameters, state);
    if (parameters.placement.move != 0)
      move_axially(state, parameters.placement.move);
  }


  double time_of_first_contact(const scene::Scene            &scene,
                               const scene::WorkpieceOutline &outline,
                               const State                   &state)
  {
    bool held = state.boundary_ids.count("symmetry") > 0;
    for (const scene::BoundaryCondition &boundary : scene.boundaries)
      held |= boundary.is_velocity;
    if (held)
      return 0;
    const double tolerance = tools::touching_tolerance * (outline.upper - outline.lower).norm();
    double       first     = std::numeric_limits<double>::infinity();
    bool         any       = false;
    for (const scene::Tool &tool : scene.tools)
      {
        const Vector2 way = tool.motion.displacement(scene.end_time());
        if (!(way.norm() > 0))
          continue;
        any                 = true;
        const double travel = tools::travel_to_contact(tool.profile, outline.boundary_points,
                                                       way / way.norm(), 2 * tolerance);
        if (travel == 0)
          return 0;
        if (!(travel < way.norm()))
          continue;
        double low = 0, high = scene.end_time();
        for (unsigned int i = 0; i < 200 && high - low > 1e-15 * high; ++i)
          {
            const double middle                                             = 0.5 * (low + high);
            (tool.motion.displacement(middle).norm() < travel ? low : high) = middle;
          }
        first = std::min(first, low);
      }
    if (any && !std::isfinite(first))
      throw InputError(fmt::format("No moving tool reaches the workpiece before the end at {:.6g} "
                                   "s, stroke {:.6g} mm. Place "
                                   "tool or workpiece closer (\"Tool NAME/Start = touching\", "
                                   "\"Placement/Rest on\"), or end "
                                   "later.",
                                   scene.end_time(), scene.stroke(scene.end_time())));
    return any ? first : 0;
  }
} // namespace axiforge::process
