// SPDX-License-Identifier: GPL-2.0-or-later
#include <cctype>
#include <iostream>
#include <limits>
#include <sstream>

#include <deal.II/base/function_parser.h>

#include <axiforge/base/errors.h>
#include <axiforge/scene/scene.h>
#include <axiforge/tools/positioning.h>

namespace axiforge::scene
{
  namespace
  {
    constexpr unsigned int no_tool = static_cast<unsigned int>(-1);

    /// deal.II's parser writes what it dislikes to std::cerr before it throws: this keeps the
    /// words.
    class KeptErrors
    {
    public:
      KeptErrors()
          : usual(std::cerr.rdbuf(said.rdbuf()))
      {
      }
      KeptErrors(const KeptErrors &)            = delete;
      KeptErrors &operator=(const KeptErrors &) = delete;
      ~KeptErrors()
      {
        std::cerr.rdbuf(usual);
      }

      /// The sentence between "Message:  <" and the end of its line, in brackets.
      std::string complaint() const
      {
        const std::string text  = said.str();
        const std::size_t begin = text.find('<');
        const std::size_t end   = text.find('\n', begin);
        if (begin == std::string::npos || end == std::string::npos || end < begin + 3)
          return "";
        std::string sentence = text.substr(begin + 1, end - begin - 1);
        while (!sentence.empty() && (sentence.back() == '>' || sentence.back() == '.'))
          sentence.pop_back();
        return " (" + sentence + ")";
      }

    private:
      std::ostringstream said;
      std::streambuf    *usual;
    };


    /// Whether a comma stands outside of a function's arguments: the parser would go on with what
    /// stands behind it.
    bool has_stray_comma(const std::string &text)
    {
      std::vector<bool> of_function; // of the open brackets
      char              before = 0;  // last character but blanks
      for (const char c : text)
        {
          if (c == '(')
            of_function.push_back(std::isalnum(static_cast<unsigned char>(before)) ||
                                  before == '_');
          else if (c == ')' && !of_function.empty())
            of_function.pop_back();
          else if (c == ',' && (of_function.empty() || !of_function.back()))
            return true;
          if (!std::isspace(static_cast<unsigned char>(c)))
            before = c;
        }
      return false;
    }


    /// An expression in r, z and t as a function; empty for 'free'.
    std::function<double(const Point &, double)> parse_expression(const std::string &entry,
                                                                  const std::string &text)
    {
      if (text == "free")
        return {};
      if (has_stray_comma(text) || text.find(';') != std::string::npos)
        throw InputError::entry(
            entry, text, "it has a comma or semicolon outside of a function's brackets",
            "one expression in r, z and t", "The decimal sign is a point: 1.5, not 1,5");
      auto             function = std::make_shared<dealii::FunctionParser<2>>(1);
      const KeptErrors errors;
      try
        {
          function->initialize("r,z,t", text, { { "pi", M_PI } }, true);
          function->value(Point(1, 1)); // muparser speaks up at the first evaluation
        }
      catch (const std::exception &)
        {
          throw InputError::entry(entry, text,
                                  "this is not an expression in r, z and t" + errors.complaint(),
                                  "'free', numbers, + - * / ^, sqrt, exp, log, sin, cos, pi",
                                  "For example \"0.5 * r / (r^2 + z^2)^1.5\"");
        }
      return [function](const Point &x, const double time) {
        function->set_time(time);
        return function->value(x);
      };
    }


    /// The largest magnitude of an expression at the start, on the part of the boundary it is for.
    double largest_at_start(const std::string                                  &entry,
                            const std::string                                  &text,
                            const std::function<double(const Point &, double)> &function,
                            const std::vector<Point>                           &points)
    {
      double largest = 0;
      for (const Point &x : points)
        {
          const double value = function(x, 0);
          if (!std::isfinite(value))
            throw InputError::entry(
                entry, text,
                fmt::format("it is {} at r = {:.6g} mm, z = {:.6g} mm, t = 0", value, x[0], x[1]),
                "an expression that is finite on the whole of this boundary");
          largest = std::max(largest, std::abs(value));
        }
      return largest;
    }


    std::string list(const std::vector<std::string> &names)
    {
      std::string text;
      for (const std::string &name : names)
        text += (text.empty() ? "" : ", ") + name;
      return text.empty() ? "(none)" : text;
    }


    /// Which side of its profile is the tool's is a guess where the workpiece lies on both: the
    /// smaller part of it is taken for the overlap.
    std::string describe_overlap(const tools::Penetration &behind,
                                 const tools::Penetration &in_front)
    {
      const bool                swapped = in_front.gap > 0 && in_front.gap < -behind.gap;
      const tools::Penetration &inside  = swapped ? in_front : behind,
                               &outside = swapped ? behind : in_front;
      return fmt::format("the tool starts inside the workpiece: they overlap by {:.4g} mm at r = "
                         "{:.6g} mm, z = {:.6g} mm, and the workpiece lies up to {:.4g} mm on the "
                         "other side of the profile",
                         std::abs(inside.gap), inside.place[0], inside.place[1],
                         std::abs(outside.gap));
    }


    Tool make_tool(const ToolParameters   &parameters,
                   const std::string      &directory,
                   const WorkpieceOutline &outline,
                   const double            characteristic_speed,
                   const double            layer_length)
    {
      const std::string section = "Tool " + parameters.name;
      Tool tool{ parameters.name, tools::read_profile(parameters.geometry, section, directory),
                 tools::Motion(parameters.motion, section + "/Motion", directory),
                 laws::Friction(parameters.friction, section + "/Friction", characteristic_speed,
                                layer_length) };
      if (parameters.start == "touching")
        {
          const double  late = std::isfinite(tool.motion.end_time()) ? tool.motion.end_time() : 1;
          const Vector2 way  = tool.motion.velocity(0).norm() > 0 ? tool.motion.velocity(0)
                                                                  : tool.motion.displacement(late);
          if (!(way.norm() > 0))
            throw InputError::entry(
                section + "/Start", parameters.start,
                "the tool has no direction of motion to come from",
                "'touching' for a tool that moves",
                "Set \"Start = as drawn\"; \"Placement/Rest on\" puts the workpiece "
                "on a tool that rests");
          if (!outline.boundary_points.empty())
            tools::bring_to_contact(
                tool.profile, outline.boundary_points, way / way.norm(),
                tools::touching_tolerance * (outline.upper - outline.lower).norm(), section);
        }
      else if (!outline.boundary_points.empty())
        tool.profile.orient(outline.boundary_points);

      if (const auto crossing = tools::self_crossing(tool.profile))
        throw InputError::entry(
            section + "/Geometry file", parameters.geometry.file,
            fmt::format("the tool's profile crosses itself at r = {:.6g} mm, z = "
                        "{:.6g} mm: it has no inside there",
                        (*crossing)[0], (*crossing)[1]),
            "a line or a closed curve that does not meet itself",
            "Shorten the curves at that place, or leave one out");

      const double       size = (outline.upper - outline.lower).norm();
      tools::Penetration behind, in_front;
      for (const Point &x : outline.boundary_points)
        {
          std::array<tools::Contact, 2> contacts;
          if (tool.profile.find(x, std::numeric_limits<double>::max(), contacts) == 0)
            continue;
          if (contacts[0].gap < behind.gap)
            behind = { contacts[0].gap, x };
          if (contacts[0].gap > in_front.gap)
            in_front = { contacts[0].gap, x };
        }
      if (behind.gap < -tools::overlap_tolerance * size)
        throw InputError::entry(
            section + "/Geometry file", parameters.geometry.file,
            describe_overlap(behind, in_front), "a tool that touches the workpiece or stands off",
            in_front.gap < -behind.gap
                ? "Move the tool's geometry or the workpiece by that much, or draw the profile the "
                  "other way round if the tool is meant to be on its other side"
                : "Move the tool's geometry back, or the workpiece");
      return tool;
    }


    /// Cells so small that their number, or the rounding errors in them, are beyond sense.
    void check_element_size(const std::string &entry, const double given, const double size)
    {
      constexpr double smallest = 1e-5; // over the size
      if (given > 0 && given < smallest * size)
        throw InputError::entry(entry, fmt::format("{:.6g}", given),
                                "cells of this size are no mesh of the workpiece",
                                fmt::format("0, or at least {:.3g} mm ({} of the workpiece's size)",
                                            smallest * size, smallest));
    }


    Region make_region(const RegionParameters  &parameters,
                       const std::vector<Tool> &tools,
                       const double             size,
                       const bool               refines,
                       const bool               remeshes)
    {
      const std::string section = "Region " + parameters.name;
      if (!refines)
        throw InputError::entry(
            "Regions", parameters.name,
            "a region divides cells, and \"Refinement/Enabled\" is false" +
                std::string(remeshes ? ": a new mesh takes no notice of regions" : ""),
            "regions with \"Refinement/Enabled = true\" or a target accuracy",
            "Set it, or leave \"Regions\" empty");
      Region region{ parameters.name, Point(parameters.lower), Point(parameters.upper),
                     no_tool,         parameters.element_size, parameters.level };
      for (unsigned int c = 0; c < 2; ++c)
        if (!(region.lower[c] < region.upper[c]))
          throw InputError::entry(
              section + "/Upper corner", fmt::format("{}, {}", region.upper[0], region.upper[1]),
              fmt::format("it is not above the lower corner {}, {} in {}", region.lower[0],
                          region.lower[1], c == 0 ? "r" : "z"),
              "larger coordinates \"r, z\" [mm] than those of the lower corner");
      if (region.element_size == 0 && region.level == 0)
        throw InputError::entry(
            section + "/Element size", "0",
            "the region says neither how large its cells may be nor their level",
            "a size [mm], or a level", "Give one of the two");
      check_element_size(section + "/Element size", region.element_size, size);
      std::vector<std::string> names;
      for (unsigned int i = 0; i < tools.size(); ++i)
        {
          names.push_back(tools[i].name);
          if (tools[i].name == parameters.moves_with)
            region.tool = i;
        }
      if (!parameters.moves_with.empty() && region.tool == no_tool)
        throw InputError::entry(section + "/Moves with", parameters.moves_with,
                                "this is not a tool", list(names),
                                "Name one of them, or leave the entry empty");
      return region;
    }
  } // namespace


  namespace
  {
    /// Steps that are lost in the rounding errors.
    void check_steps(const TimeParameters &time, const Scene &scene)
    {
      constexpr double smallest_travel = 1e-8; // over the size
      const bool       by_stroke       = time.stroke_per_step > 0;
      if (!by_stroke && time.time_step == 0)
        return;
      const std::string entry =
          by_stroke ? "Time stepping/Stroke per step" : "Time stepping/Time step";
      const double given = by_stroke ? time.stroke_per_step : time.time_step;
      const double least =
          smallest_travel * scene.size / (by_stroke ? 1 : scene.characteristic_speed);
      if (given < least)
        throw InputError::entry(entry, fmt::format("{:.6g}", given),
                                "the tools would travel less than rounding errors let tell",
                                fmt::format("0, or at least {:.3g} {} ({} of the workpiece's size)",
                                            least, by_stroke ? "mm" : "s", smallest_travel));
    }


    /// A ring of a tool cannot be drawn in to nothing, nor material be moved through the axis.
    void check_axis(const Scene &scene)
    {
      const double tolerance = tools::overlap_tolerance * scene.size;
      for (const Tool &tool : scene.tools)
        {
          double lowest = 0, highest = 0; // radial displacements
          for (unsigned int i = 0; i <= 1000; ++i)
            {
              const double way = tool.motion.displacement(scene.end_time() * i / 1000)[0];
              lowest           = std::min(lowest, way);
              highest          = std::max(highest, way);
            }
          const double inner = tool.profile.bounding_box().lower[0];
          if (highest - lowest <= tolerance || inner + lowest > tolerance)
            continue;
          const bool on_axis = inner <= tolerance;
          throw InputError::entry(
              "Tool " + tool.name + "/Motion",
              fmt::format("radial way {:.6g} mm", on_axis && highest > -lowest ? highest : lowest),
              on_axis
                  ? "the tool reaches the axis r = 0, where it can't move in r: it would open or "
                    "pass through itself"
                  : fmt::format("the tool, {:.6g} mm from the axis at its innermost, would pass "
                                "through the axis r = 0",
                                inner),
              "an axial motion, or for a tool clear of the axis a radial one that keeps it clear",
              "Set \"Velocity = 0, V\" or \"Direction = 0, -1\": (r, z) is the order of the "
              "components");
        }
    }


    void check_end_conditions(const ProcessParameters &process, const bool tool_moves)
    {
      if (process.end_force > 0 && !tool_moves)
        throw InputError::entry("Process/End force", fmt::format("{}", process.end_force),
                                "no tool moves, so there is no driving tool's force", "0");
      if (process.end_fill > 0 && process.fill_radius == 0)
        throw InputError::entry("Process/End fill", fmt::format("{}", process.end_fill),
                                "it needs the radius up to which the cavity counts",
                                "a positive \"Process/Fill radius\" [mm]",
                                "Set it to the inner radius of the flash land");
    }
  } // namespace


  Scene::Scene(const SceneParameters &parameters, const WorkpieceOutline &outline)
      : title(parameters.title)
      , material(parameters.material, "Material", parameters.directory)
      , process(parameters.process)
      , time(parameters.time)
      , flow(parameters.flow)
      , refinement(parameters.refinement)
      , remeshing(parameters.remeshing)
      , folding(parameters.folding)
      , output(parameters.output)
      , checkpoint(parameters.checkpoint)
      , accuracy(parameters.accuracy)
      , driving_tool(no_tool)
      , characteristic_speed(0)
      , size(std::max(outline.upper[0] - outline.lower[0], outline.upper[1] - outline.lower[1]))
      , end_time_(std::numeric_limits<double>::infinity())
  {
    const double height = outline.upper[1] - outline.lower[1];

    for (const BoundaryParameters &boundary : parameters.boundaries)
      {
        const std::string section = "Boundary " + boundary.name;
        if (std::find(outline.boundary_names.begin(), outline.boundary_names.end(),
                      boundary.name) == outline.boundary_names.end())
          throw InputError::entry(
              "Boundaries", boundary.name, "the workpiece has no physical curve of this name",
              list(outline.boundary_names),
              "Name the curve in the geometry: Physical Curve(\"" + boundary.name + "\") = {...}");
        BoundaryCondition condition;
        condition.name        = boundary.name;
        condition.is_velocity = boundary.type == "velocity";
        if (condition.is_velocity)
          {
            condition.velocity[0] = parse_expression(section + "/Velocity r", boundary.velocity_r);
            condition.velocity[1] = parse_expression(section + "/Velocity z", boundary.velocity_z);
            if (!condition.velocity[0] && !condition.velocity[1])
              throw InputError::entry(
                  section + "/Velocity r", "free",
                  "both components of a velocity condition are free",
                  "an expression for at least one of them",
                  "Take the boundary out of \"Boundaries\" if it is a free surface");
            if (boundary.pressure != BoundaryParameters().pressure)
              throw InputError::entry(section + "/Pressure", boundary.pressure,
                                      "it has no meaning with Type = velocity",
                                      "its default, empty",
                                      "Remove the entry, or set Type = pressure");
            for (unsigned int c = 0; c < 2; ++c)
              if (condition.velocity[c])
                characteristic_speed =
                    std::max(characteristic_speed,
                             largest_at_start(section + (c == 0 ? "/Velocity r" : "/Velocity z"),
                                              c == 0 ? boundary.velocity_r : boundary.velocity_z,
                                              condition.velocity[c],
                                              outline.named_points.at(boundary.name)));
          }
        else
          {
            for (const bool axial : { false, true })
              if ((axial ? boundary.velocity_z : boundary.velocity_r) != "free")
                throw InputError::entry(section + (axial ? "/Velocity z" : "/Velocity r"),
                                        axial ? boundary.velocity_z : boundary.velocity_r,
                                        "it has no meaning with Type = pressure",
                                        "its default free",
                                        "Remove the entry, or set Type = velocity");
            if (boundary.pressure == BoundaryParameters().pressure)
              throw InputError::entry(section + "/Pressure", boundary.pressure,
                                      "Type = pressure needs it",
                                      "an expression in r, z and t for a pressure [MPa]",
                                      "A surface without any pressure is free: take it out of "
                                      "\"Boundaries\"");
            condition.pressure = parse_expression(section + "/Pressure", boundary.pressure);
            if (!condition.pressure)
              throw InputError::entry(section + "/Pressure", boundary.pressure,
                                      "a pressure can't be free", "an expression in r, z and t");
            largest_at_start(section + "/Pressure", boundary.pressure, condition.pressure,
                             outline.named_points.at(boundary.name));
          }
        boundaries.push_back(condition);
      }

    for (const ToolParameters &tool : parameters.tools)
      {
        const tools::Motion motion(tool.motion, "Tool " + tool.name + "/Motion",
                                   parameters.directory);
        const double        late  = std::isfinite(motion.end_time()) ? motion.end_time() : 1;
        const double        early = motion.velocity(0).norm();
        characteristic_speed      = std::max(
                 characteristic_speed, early > 0 ? early : motion.displacement(late).norm() / late);
      }
    if (characteristic_speed == 0 && flow.reference_rate == 0)
      throw InputError(
          "Nothing moves: no tool has a velocity and no boundary has one. Allowed: at least "
          "one tool with \"Motion/Type = constant velocity\" or \"table\", or a velocity "
          "boundary. Give one, or \"Flow solver/Reference strain rate\" for a scene driven by "
          "pressure alone.");
    characteristic_rate =
        flow.reference_rate > 0 ? flow.reference_rate : characteristic_speed / height;
    if (characteristic_speed == 0)
      characteristic_speed = characteristic_rate * height;

    for (const ToolParameters &tool : parameters.tools)
      {
        tools.push_back(
            make_tool(tool, parameters.directory, outline, characteristic_speed, 0.01 * height));
        if (driving_tool == no_tool && tools.back().motion.moves() &&
            (process.driving_tool.empty() || process.driving_tool == tool.name))
          driving_tool = tools.size() - 1;
      }
    std::vector<std::string> tool_names;
    for (const Tool &tool : tools)
      tool_names.push_back(tool.name);
    for (const GaugeParameters &gauge : parameters.gauges)
      gauges.push_back(make_gauge(gauge, tool_names));
    if (!process.driving_tool.empty() &&
        (driving_tool == no_tool || tools[driving_tool].name != process.driving_tool))
      {
        std::vector<std::string> moving;
        for (const Tool &tool : tools)
          if (tool.motion.moves())
            moving.push_back(tool.name);
        throw InputError::entry("Process/Driving tool", process.driving_tool,
                                "this is not a tool that moves", list(moving),
                                "Name one of them, or leave the entry empty");
      }

    refinement.enabled |= accuracy.driven();
    if (accuracy.driven())
      {
        // Small errors need levels that few would think of; the other limits hold as given, and
        // where the geometry divides cells so does the level: surface that folds over is curved
        // without bound.
        refinement.largest_by_error = 10;
        flow.tolerance              = std::min(flow.tolerance, 0.01 * accuracy.target);
      }
    for (const RegionParameters &region : parameters.regions)
      regions.push_back(make_region(region, tools, size, refinement.enabled, remeshing.enabled));

    check_element_size("Remeshing/Element size", remeshing.element_size, size);
    if (flow.iterated() && flow.penalty < 10 / flow.regularisation)
      throw InputError::entry("Flow solver/Penalty", fmt::format("{}", flow.penalty),
                              "too small for the iterated penalty to converge with \"Flow solver/"
                              "Regularisation\" = " +
                                  fmt::format("{}", flow.regularisation),
                              fmt::format("at least {}", 10 / flow.regularisation),
                              "Raise the penalty, or take \"Incompressibility = penalty\"");
    if (time.stroke_per_step > 0 && time.time_step > 0)
      throw InputError::entry("Time stepping/Stroke per step",
                              fmt::format("{}", time.stroke_per_step),
                              "the step is given twice, \"Time stepping/Time step\" = " +
                                  fmt::format("{}", time.time_step) + " too",
                              "one of the two", "Set the other to 0");
    if (driving_tool == no_tool && (process.end_stroke > 0 || time.stroke_per_step > 0))
      throw InputError::entry(
          process.end_stroke > 0 ? "Process/End stroke" : "Time stepping/Stroke per step",
          fmt::format("{}", process.end_stroke > 0 ? process.end_stroke : time.stroke_per_step),
          "no tool moves, so there is no stroke", "0",
          "Use \"Process/End time\" or \"Time stepping/Time step\"");
    if (process.end_stroke == 0 && process.end_time == 0)
      throw InputError::entry("Process/End stroke", "0", "the run has no end",
                              "a positive end stroke [mm] or end time [s]",
                              "Set \"Process/End stroke\" or \"Process/End time\"; with an end by "
                              "force, height or fill as the most that it may take");

    check_end_conditions(process, driving_tool != no_tool);

    if (process.end_time > 0)
      end_time_ = process.end_time;
    if (process.end_stroke > 0)
      {
        const double last = std::min(end_time_, tools[driving_tool].motion.end_time());
        double       high = std::isfinite(last) ? last : 1e-6;
        while (stroke(high) < process.end_stroke && high < last)
          {
            high *= 2;
            if (high > 1e12)
              break;
          }
        if (stroke(high) < process.end_stroke * (1 - 1e-12))
          {
            if (process.end_time == 0)
              throw InputError::entry("Process/End stroke", fmt::format("{}", process.end_stroke),
                                      "tool \"" + tools[driving_tool].name +
                                          "\" never travels that far",
                                      fmt::format("at most {:.6g} mm", stroke(high)),
                                      "Lengthen its table or lower the stroke");
          }
        else
          {
            double low = 0;
            for (unsigned int i = 0; i < 200 && high - low > 1e-15 * high; ++i)
              {
                const double middle                                = 0.5 * (low + high);
                (stroke(middle) < process.end_stroke ? low : high) = middle;
              }
            end_time_ = high;
          }
      }
    check_steps(parameters.time, *this);
    check_axis(*this);
    for (unsigned int i = 0; i < tools.size(); ++i)
      if (tools[i].motion.end_time() < end_time_ * (1 - 1e-12))
        throw InputError::entry(
            "Tool " + tools[i].name + "/Motion/Table file", parameters.tools[i].motion.table_file,
            fmt::format("the table ends at {} s, before the run does at {} s",
                        tools[i].motion.end_time(), end_time_),
            "a table up to the end of the run", "Lengthen it or end the run earlier");
  }


  double Scene::stroke(const double t) const
  {
    return driving_tool == no_tool ? 0 : tools[driving_tool].motion.displacement(t).norm();
  }
} // namespace axiforge::scene
