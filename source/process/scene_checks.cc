// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include <deal.II/base/mpi.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/wording.h>
#include <axiforge/process/placement.h>
#include <axiforge/process/scene_checks.h>
#include <axiforge/state/fill.h>
#include <axiforge/tools/positioning.h>

namespace axiforge::process
{
  namespace
  {
    constexpr double never = std::numeric_limits<double>::infinity();

    /// Normals flatter than this do not hold along z.
    constexpr double axial = 0.02;


    bool has_symmetry_plane(const State &state)
    {
      int found = 0;
      for (const BoundaryNode &node : state.tables.boundary_nodes)
        found |= node.on_symmetry && std::abs(node.symmetry_normal[1]) > axial;
      return dealii::Utilities::MPI::max(found, state.communicator) > 0;
    }


    bool held_axially(const scene::Scene &scene, const State &state)
    {
      bool held = has_symmetry_plane(state);
      for (const scene::BoundaryCondition &boundary : scene.boundaries)
        held |= boundary.is_velocity && boundary.velocity[1];
      return held;
    }


    /// The nearest tool that the workpiece meets when it moves along z.
    struct Stop
    {
      double      way = never; ///< until then [mm]
      std::string tool;
    };

    Stop
    stop_along(const scene::Scene &scene, const scene::WorkpieceOutline &outline, const int way)
    {
      Stop         stop;
      const double tolerance =
          2 * tools::touching_tolerance * (outline.upper - outline.lower).norm();
      for (const scene::Tool &tool : scene.tools)
        {
          // The same as if the tool came against it.
          const double distance =
              tools::travel_to_contact(tool.profile, outline.boundary_points,
                                       Vector2({ 0., static_cast<double>(-way) }), tolerance);
          if (distance < stop.way)
            stop = { distance, tool.name };
        }
      return stop;
    }


    /// A tool with friction that touches along a wall, where friction may hold; empty: none.
    std::string held_by_friction(const scene::Scene &scene, const scene::WorkpieceOutline &outline)
    {
      const double reach = tools::overlap_tolerance * (outline.upper - outline.lower).norm();
      std::array<tools::Contact, 2> found;
      for (const scene::Tool &tool : scene.tools)
        if (tool.friction.kind() != laws::FrictionKind::none)
          for (const Point &x : outline.boundary_points)
            if (tool.profile.find(x, reach, found) > 0 && std::abs(found[0].normal[1]) < axial)
              return tool.name;
      return "";
    }


    std::string unsupported(const bool below, const Stop &stop, const double reach)
    {
      const char *const side = below ? "below" : "above";
      return std::isfinite(stop.way)
                 ? fmt::format("tool \"{}\" {} stands {:.4g} mm off, farther than the tools travel "
                               "({:.4g} mm)",
                               stop.tool, side, stop.way, reach)
                 : fmt::format("there is no tool {} it", side);
    }


    /// Loose along z, the workpiece has to lie between two tools, or to be pushed in between.
    void check_support(const scene::Scene            &scene,
                       const scene::WorkpieceOutline &outline,
                       const State                   &state,
                       std::vector<std::string>      &notes)
    {
      if (held_axially(scene, state))
        return;
      double reach  = 1e-6 * scene.size;
      bool   radial = false, pressure = false;
      for (const scene::Tool &tool : scene.tools)
        {
          const Travel travel = travel_of(tool.motion, scene.end_time());
          reach += travel.forward + travel.backward;
          radial |= std::abs(travel.direction[0]) > 1e-9;
        }
      for (const scene::BoundaryCondition &boundary : scene.boundaries)
        pressure |= !boundary.is_velocity;
      if (radial) // what comes from the side may close around it
        return;
      const Stop down = stop_along(scene, outline, -1), up = stop_along(scene, outline, 1);
      const bool lies = down.way <= reach, covered = up.way <= reach;
      if ((lies && covered) || (pressure && (lies || covered)))
        return;
      if (const std::string wall = held_by_friction(scene, outline); !wall.empty())
        {
          notes.push_back(
              fmt::format("along z nothing holds the workpiece but the friction at tool "
                          "\"{}\": {}.",
                          wall, unsupported(!lies, lies ? up : down, reach)));
          return;
        }
      std::string why;
      if (!lies)
        why = unsupported(true, down, reach);
      if (!covered)
        why += (why.empty() ? "" : ", ") + unsupported(false, up, reach);
      throw InputError(fmt::format(
          "Nothing holds the workpiece along z: {}, and there is neither a symmetry line (a "
          "physical "
          "curve \"symmetry\" of the workpiece) nor a boundary with \"Velocity z\". The moving "
          "tools "
          "would carry it along or miss it. Add the missing tool to \"Tools\", name the symmetry "
          "line in the geometry, or place workpiece and tools closer (\"Placement/Rest on\", "
          "\"Tool "
          "NAME/Start = touching\").",
          why));
    }


    void check_reach(const scene::Scene            &scene,
                     const scene::WorkpieceOutline &outline,
                     std::vector<std::string>      &notes)
    {
      bool any = false;
      for (unsigned int t = 0; t < scene.tools.size() && !any; ++t)
        any = scene.tools[t].motion.moves() && std::isfinite(time_of_contact(scene, t, outline));
      if (any || scene.driving_tool == no_tool)
        return;
      if (scene.boundaries.empty())
        throw no_tool_reaches(scene);
      notes.push_back("no moving tool reaches the workpiece before the end: the boundaries alone "
                      "form it.");
    }


    /// Edges of the outline on all ranks: start, end, middle [mm], and whether a tool may touch.
    std::vector<std::array<double, 7>> gather_edges(const State &state)
    {
      std::vector<std::array<double, 7>> mine;
      for (const BoundaryEdge &edge : state.tables.edges)
        if (edge.owned)
          {
            std::array<double, 7> row;
            for (unsigned int a = 0; a < 3; ++a)
              for (unsigned int c = 0; c < 2; ++c)
                row[2 * a + c] = state.node_position(edge.nodes[a])[c];
            row[6] = state.tables.boundary_nodes[edge.boundary_nodes[2]].on_axis ||
                             state.tables.boundary_nodes[edge.boundary_nodes[2]].on_symmetry
                         ? 0
                         : 1;
            mine.push_back(row);
          }
      return gather_rows(state.communicator, mine);
    }


    double distance_to_line(const Point &x, const Point &a, const Point &b)
    {
      const Vector2 d     = b - a;
      const double  along = std::clamp((x - a) * d / d.norm_square(), 0., 1.);
      return x.distance(Point(a + along * d));
    }


    /// How deep below the surface that tools can touch a point is [mm]; 0 outside.
    double depth_inside(const std::vector<std::array<double, 7>> &edges, const Point &x)
    {
      bool   inside  = false; // by the crossings of a ray along +r
      double nearest = never;
      for (const auto &edge : edges)
        {
          const Point node[3] = { Point(edge[0], edge[1]), Point(edge[4], edge[5]),
                                  Point(edge[2], edge[3]) };
          for (unsigned int half = 0; half < 2; ++half)
            {
              const Point &a = node[half], &b = node[half + 1];
              if ((a[1] > x[1]) != (b[1] > x[1]) &&
                  a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x[0])
                inside = !inside;
              if (edge[6] > 0)
                nearest = std::min(nearest, distance_to_line(x, a, b));
            }
        }
      return inside ? nearest : 0;
    }


    /// A tool whose profile runs through the workpiece without having a node of the surface behind
    /// it: one that lies wholly inside, as a die drawn in inches in a billet in mm.
    void check_no_tool_inside(const scene::Scene            &scene,
                              const scene::WorkpieceOutline &outline,
                              const State                   &state)
    {
      const std::vector<std::array<double, 7>> edges   = gather_edges(state);
      double                                   longest = 0;
      for (const auto &edge : edges)
        longest = std::max(longest, Point(edge[0], edge[1]).distance(Point(edge[2], edge[3])));
      // A nose narrower than an edge comes between its nodes.
      const double allowed = std::max(0.5 * longest, 1e-3 * scene.size);
      const double spacing = 0.5 * allowed;
      for (const scene::Tool &tool : scene.tools)
        for (const std::vector<Point> &line : tool.profile.sample(1e-4 * scene.size))
          {
            double deepest = 0, shallowest = never;
            Point  place;
            for (unsigned int i = 0; i + 1 < line.size(); ++i)
              {
                const Vector2 way = line[i + 1] - line[i];
                const int     n   = std::clamp(static_cast<int>(way.norm() / spacing), 1, 2000);
                for (int k = 0; k <= n; ++k)
                  {
                    const Point x(line[i] + way * (static_cast<double>(k) / n));
                    const bool  in_box = x[0] > outline.lower[0] && x[0] < outline.upper[0] &&
                                        x[1] > outline.lower[1] && x[1] < outline.upper[1];
                    const double depth = in_box ? depth_inside(edges, x) : 0;
                    shallowest         = std::min(shallowest, depth);
                    if (depth > deepest)
                      {
                        deepest = depth;
                        place   = x;
                      }
                  }
              }
            if (deepest > allowed || shallowest > tools::overlap_tolerance * scene.size)
              throw InputError(fmt::format(
                  "Tool \"{}\" starts inside the workpiece: its profile passes r = {:.6g} mm, z = "
                  "{:.6g} mm, which is {:.4g} mm below the surface. Move the tool or the "
                  "workpiece, "
                  "and see that both are drawn in mm (1 inch = 25.4 mm).",
                  tool.name, place[0], place[1], deepest));
          }
    }


    void note_size(const scene::Scene &scene, std::vector<std::string> &notes)
    {
      constexpr double smallest = 0.1, largest = 1e4;
      if (scene.size < smallest || scene.size > largest)
        notes.push_back(
            fmt::format("the workpiece is {:.4g} mm {}. Lengths are in mm: a part drawn "
                        "in m or in another unit has to be scaled.",
                        scene.size, scene.size < smallest ? "small" : "large"));
    }


    void
    note_figures(const scene::Scene &scene, const State &state, std::vector<std::string> &notes)
    {
      const bool half = has_symmetry_plane(state);
      for (const scene::Gauge &gauge : scene.gauges)
        if (half && gauge.component == 0 && gauge.place == scene::Gauge::Place::middle)
          notes.push_back(
              fmt::format("gauge \"{}\" measures half way up the part that is modelled, "
                          "not at the symmetry plane. For the middle of the whole "
                          "workpiece give \"At\" the plane's z.",
                          gauge.name));
      if (const double radius = scene.process.fill_radius; radius > 0)
        if (const Opening open = opening_within(scene, state, radius, state.time); open.any())
          {
            const std::string where = fmt::format(
                "from r = {:.4g} to {:.4g} mm the tools do not close the cavity (a bore, "
                "or a profile that ends)",
                open.from, open.to);
            if (scene.process.end_fill > 0)
              throw InputError::entry("Process/Fill radius", fmt::format("{}", radius),
                                      where + ", so there is no share of it that is filled",
                                      "a radius up to which tools or the symmetry plane bound the "
                                      "cavity from both sides",
                                      "Close the bore with a line of the profile or a tool, or end "
                                      "by stroke or force");
            notes.push_back("\"fill\" is no measure here: " + where +
                            " within \"Process/Fill radius\".");
          }
    }


    std::string lower_case(std::string text)
    {
      for (char &c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return text;
    }
  } // namespace


  double least_force(const scene::Scene &scene)
  {
    return 1e-6 * scene.material.flow_stress(0.1, scene.characteristic_rate).value * scene.size *
           scene.size;
  }


  std::vector<std::string> check_before_run(const scene::Scene            &scene,
                                            const scene::WorkpieceOutline &outline,
                                            const State                   &state)
  {
    std::vector<std::string> notes;
    note_size(scene, notes);
    check_no_tool_inside(scene, outline, state);
    check_reach(scene, outline, notes);
    check_support(scene, outline, state, notes);
    note_figures(scene, state, notes);
    return notes;
  }


  std::vector<std::string>
  check_curves(const std::vector<scene::SceneParameters>               &operations,
               const std::map<std::string, dealii::types::boundary_id> &curves)
  {
    std::set<std::string> used = { "axis", "symmetry", "surface" };
    for (const scene::SceneParameters &operation : operations)
      {
        for (const scene::BoundaryParameters &boundary : operation.boundaries)
          used.insert(boundary.name);
        for (const scene::ToolParameters &tool : operation.tools)
          used.insert({ tool.name, tool.geometry.physical_group });
      }
    std::vector<std::string> notes;
    for (const auto &curve : curves)
      {
        const std::string &name = curve.first, lower = lower_case(name);
        if (used.count(name))
          continue;
        const std::string what = fmt::format(
            "nothing in the scene uses the physical curve \"{}\" of the workpiece", name);
        if (lower == "axis" || !closest_name(name, { "symmetry" }).empty())
          throw InputError(fmt::format(
              "{}, so that it is free surface. Did you mean \"{}\"? Rename the curve in the "
              "geometry; if it is to be free, give it another name or none.",
              static_cast<char>(std::toupper(what[0])) + what.substr(1),
              lower == "axis" ? "axis" : "symmetry"));
        const std::string meant =
            lower.compare(0, 3, "sym") == 0 || lower.find("mirror") != std::string::npos
                ? "symmetry"
                : closest_name(name, { "axis" });
        notes.push_back(what + ": it is free surface." +
                        (meant.empty() ? "" : " Did you mean \"" + meant + "\"?"));
      }
    return notes;
  }
} // namespace axiforge::process
