// SPDX-License-Identifier: GPL-2.0-or-later
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
    /// How short of the tool the workpiece stops, over its size.
    constexpr double touching = 1e-9;


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
      const scene::ToolParameters  &tool    = find_tool(parameters);
      const std::string             section = "Tool " + tool.name;
      tools::Profile                profile =
          tools::read_profile(tool.geometry, section, parameters.directory);
      const scene::WorkpieceOutline outline = meshing::outline_of(state);
      // It is the same whether the workpiece comes down or the tool comes up.
      const Vector2 way =
          tools::bring_to_contact(profile, outline.boundary_points, Vector2({ 0., 1. }),
                                  touching * (outline.upper - outline.lower).norm(), section);
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
} // namespace axiforge::process
