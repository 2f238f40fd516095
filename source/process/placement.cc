// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
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
      const Vector2 way = tools::bring_to_contact(
          profile, outline.boundary_points, Vector2({ 0., 1. }),
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


  void check_placement(const scene::SceneParameters &parameters)
  {
    if (!parameters.placement.rest_on.empty())
      find_tool(parameters);
  }


  namespace
  {
    /// Times [s] at which the way of a tool is looked at: often, and at all jumps of its velocity.
    std::vector<double> times_on_the_way(const tools::Motion &motion, const double end_time)
    {
      constexpr unsigned int n = 1000;
      std::vector<double>    times;
      for (unsigned int i = 0; i <= n; ++i)
        times.push_back(end_time * i / n);
      for (const double kink : motion.kinks())
        if (kink < end_time)
          times.push_back(kink);
      std::sort(times.begin(), times.end());
      return times;
    }
  } // namespace


  Travel travel_of(const tools::Motion &motion, const double end_time)
  {
    const std::vector<double> times = times_on_the_way(motion, end_time);
    Vector2                   farthest;
    for (const double time : times)
      if (const Vector2 way = motion.displacement(time); way.norm() > farthest.norm())
        farthest = way;
    Travel travel;
    if (!(farthest.norm() > 0))
      return travel;
    travel.direction = farthest / farthest.norm();
    for (const double time : times)
      {
        const double way = motion.displacement(time) * travel.direction;
        travel.forward   = std::max(travel.forward, way);
        travel.backward  = std::max(travel.backward, -way);
      }
    return travel;
  }


  double time_of_contact(const scene::Scene            &scene,
                         const unsigned int             tool,
                         const scene::WorkpieceOutline &outline)
  {
    const tools::Motion &motion = scene.tools[tool].motion;
    const Travel         travel = travel_of(motion, scene.end_time());
    const double tolerance = tools::touching_tolerance * (outline.upper - outline.lower).norm();
    double       first     = std::numeric_limits<double>::infinity();
    for (const bool ahead : { true, false })
      {
        const double  most      = ahead ? travel.forward : travel.backward;
        const Vector2 direction = ahead ? travel.direction : -travel.direction;
        if (!(most > 0))
          continue;
        const double distance = tools::travel_to_contact(
            scene.tools[tool].profile, outline.boundary_points, direction, 2 * tolerance);
        if (!(distance < most))
          continue;
        const auto passed = [&](const double time) {
          return motion.displacement(time) * direction > distance;
        };
        double low = 0, high = scene.end_time();
        for (const double time : times_on_the_way(motion, scene.end_time()))
          if (passed(time))
            {
              high = time;
              break;
            }
          else
            low = time;
        for (unsigned int i = 0; i < 200 && high - low > 1e-15 * high; ++i)
          {
            const double middle           = 0.5 * (low + high);
            (passed(middle) ? high : low) = middle;
          }
        first = std::min(first, low);
      }
    return first;
  }


  InputError no_tool_reaches(const scene::Scene &scene)
  {
    return InputError(fmt::format(
        "No moving tool reaches the workpiece before the end at {:.6g} s, stroke {:.6g} "
        "mm: they move past it, away from it, or not far enough. Place tool or workpiece "
        "closer (\"Tool NAME/Start = touching\", \"Placement/Rest on\"), turn the "
        "motion's direction round, or end later.",
        scene.end_time(), scene.stroke(scene.end_time())));
  }


  double time_of_first_contact(const scene::Scene            &scene,
                               const scene::WorkpieceOutline &outline,
                               const State                   &state)
  {
    if (state.boundary_ids.count("symmetry") > 0 || !scene.boundaries.empty())
      return 0;
    double first = std::numeric_limits<double>::infinity();
    bool   any   = false;
    for (unsigned int t = 0; t < scene.tools.size(); ++t)
      if (scene.tools[t].motion.moves())
        {
          any   = true;
          first = std::min(first, time_of_contact(scene, t, outline));
        }
    if (any && !std::isfinite(first))
      throw no_tool_reaches(scene);
    return any ? first : 0;
  }
} // namespace axiforge::process
