// SPDX-License-Identifier: GPL-2.0-or-later
#include <set>
#include <sstream>

#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/scene/scene.h>

// All sections of a scene together, and the operations of a chain; the sections' own entries are in
// parameters.cc.

namespace axiforge::scene
{
  using dealii::ParameterHandler;
  namespace Patterns = dealii::Patterns;


  namespace
  {
    /// Declares what stands in a section.
    void
    in_section(ParameterHandler &prm, const std::string &name, const std::function<void()> &declare)
    {
      prm.enter_subsection(name);
      declare();
      prm.leave_subsection();
    }


    std::vector<std::string> split_names(const std::string &entry, const std::string &text)
    {
      std::vector<std::string> names;
      for (const std::string &name : dealii::Utilities::split_string_list(text))
        {
          if (name.empty() ||
              name.find_first_not_of(
                  "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
                  std::string::npos)
            throw InputError::entry(entry, text, "\"" + name + "\" is not a name",
                                    "letters, digits, - and _, separated by commas",
                                    "The names stand in file names and column headers");
          if (std::count(names.begin(), names.end(), name))
            throw InputError::entry(entry, text, "\"" + name + "\" stands twice", "each name once");
          names.push_back(name);
        }
      return names;
    }
  } // namespace


  void ToolParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter(
        "Start", start,
        "'as drawn': where the geometry file has it. 'touching': it comes along its direction of "
        "motion until it touches the workpiece, and starts there; the stroke counts from there.",
        Patterns::Selection("as drawn|touching"));
    geometry.declare_profile(prm);
    in_section(prm, "Motion", [&] { motion.declare(prm); });
    in_section(prm, "Friction", [&] { friction.declare(prm); });
  }


  void SceneParameters::declare(ParameterHandler &prm)
  {
    prm.add_parameter("Title", title,
                      "One line that says what is simulated; it stands in the outputs.");
    prm.add_parameter(
        "Tools", tool_names,
        "Names of the tools, separated by commas; each has its own section 'Tool NAME'.");
    prm.add_parameter(
        "Boundaries", boundary_names,
        "Names of physical curves of the workpiece with a condition of their own; each "
        "has its section 'Boundary NAME'. Axis and symmetry need none.");
    prm.add_parameter(
        "Operations", operation_names,
        "Names of operations that follow each other, separated by commas; each has its section "
        "'Operation NAME' with any sections and entries of a scene but the workpiece's: what "
        "stands in it goes over what stands outside. Empty: the scene is one operation.");
    prm.add_parameter(
        "Regions", region_names,
        "Names of boxes with finer cells, separated by commas; each has its section 'Region NAME'. "
        "They need \"Refinement/Enabled = true\" or a target accuracy.");
    in_section(prm, "Placement", [&] { placement.declare(prm); });
    prm.add_parameter("Gauges", gauge_names,
                      "Names of measurements of the shape, separated by commas; each has its "
                      "section 'Gauge NAME' and its column gauge_NAME_mm in history.csv.");
    in_section(prm, "Workpiece", [&] { workpiece.declare_workpiece(prm); });
    in_section(prm, "Material", [&] { material.declare(prm); });
    for (ToolParameters &tool : tools)
      {
        in_section(prm, "Tool " + tool.name, [&] { tool.declare(prm); });
      }
    for (BoundaryParameters &boundary : boundaries)
      {
        in_section(prm, "Boundary " + boundary.name, [&] { boundary.declare(prm); });
      }
    for (RegionParameters &region : regions)
      {
        in_section(prm, "Region " + region.name, [&] { region.declare(prm); });
      }
    for (GaugeParameters &gauge : gauges)
      {
        in_section(prm, "Gauge " + gauge.name, [&] { gauge.declare(prm); });
      }
    in_section(prm, "Process", [&] { process.declare(prm); });
    in_section(prm, "Time stepping", [&] { time.declare(prm); });
    in_section(prm, "Flow solver", [&] { flow.declare(prm); });
    in_section(prm, "Refinement", [&] { refinement.declare(prm); });
    in_section(prm, "Remeshing", [&] { remeshing.declare(prm); });
    in_section(prm, "Folding", [&] { folding.declare(prm); });
    in_section(prm, "Output", [&] { output.declare(prm); });
    in_section(prm, "Study", [&] { study.declare(prm); });
    in_section(prm, "Checkpoint", [&] { checkpoint.declare(prm); });
    in_section(prm, "Accuracy", [&] { accuracy.declare(prm); });
  }


  SceneParameters::SceneParameters(const ParameterFile &file)
      : directory(file.directory())
      , handler(std::make_shared<ParameterHandler>())
  {
    // The lists of names come first: they say which sections there are.
    {
      ParameterHandler names;
      names.add_parameter("Tools", tool_names);
      names.add_parameter("Boundaries", boundary_names);
      names.add_parameter("Regions", region_names);
      names.add_parameter("Gauges", gauge_names);
      file.parse(names, true);
    }
    for (const std::string &name : split_names("Tools", tool_names))
      {
        tools.emplace_back();
        tools.back().name = name;
      }
    for (const std::string &name : split_names("Boundaries", boundary_names))
      {
        boundaries.emplace_back();
        boundaries.back().name = name;
      }
    for (const std::string &name : split_names("Regions", region_names))
      {
        regions.emplace_back();
        regions.back().name = name;
      }
    for (const std::string &name : split_names("Gauges", gauge_names))
      {
        gauges.emplace_back();
        gauges.back().name = name;
      }
    // add_parameter keeps addresses: the vectors must not grow from here on.
    declare(*handler);
    file.parse(*handler);
  }


  std::string SceneParameters::print() const
  {
    std::ostringstream out;
    handler->print_parameters(out, ParameterHandler::PRM | ParameterHandler::KeepDeclarationOrder);
    return out.str();
  }


  template <typename Parameters>
  std::string SceneParameters::changed_entries(const ParameterFile &file,
                                               const std::string   &section,
                                               Parameters           defaults) const
  {
    ParameterHandler fresh;
    defaults.declare(fresh);
    std::string names;
    handler->enter_subsection(section);
    for (const std::string &name : file.entries_of(section))
      if (name.find('/') == std::string::npos && handler->get(name) != fresh.get(name))
        names += (names.empty() ? "\"" : ", \"") + name + "\"";
    handler->leave_subsection();
    return names;
  }


  std::map<std::string, std::string> SceneParameters::idle_entries(const ParameterFile &file) const
  {
    std::map<std::string, std::string> idle;
    const bool                         by_error = accuracy.target != "none";
    if (!refinement.enabled && !by_error)
      idle["Refinement\" with \"Enabled = false"] =
          changed_entries(file, "Refinement", RefinementParameters());
    if (!remeshing.enabled)
      idle["Remeshing\" with \"Enabled = false"] =
          changed_entries(file, "Remeshing", RemeshingParameters());
    if (folding.when_found == "off")
      idle["Folding\" with \"When found = off"] =
          changed_entries(file, "Folding", FoldingParameters());
    if (!accuracy.estimate_errors && !by_error)
      idle["Accuracy\" with \"Target accuracy = none"] =
          changed_entries(file, "Accuracy", AccuracyParameters());
    return idle;
  }


  namespace
  {
    /// Notes sections that no operation enables and that have entries all the same.
    void note_idle_entries(const ParameterFile                &file,
                           const std::vector<std::string>     &operations,
                           const std::vector<SceneParameters> &all)
    {
      std::map<std::string, std::string>  first;
      std::map<std::string, unsigned int> n_idle;
      for (unsigned int k = 0; k < all.size(); ++k)
        for (const auto &[section, names] : all[k].idle_entries(
                 operations.empty() ? file : file.seen_by("Operation", operations[k])))
          {
            ++n_idle[section];
            if (first[section].empty())
              first[section] = names;
          }
      for (const auto &[section, names] : first)
        if (!names.empty() && n_idle[section] == all.size())
          note("Section \"" + section + "\" does nothing, and it is given " + names +
               ". Enable it, or take the entries out.");
    }
  } // namespace


  std::string print_all_entries()
  {
    return SceneParameters(
               ParameterFile(std::vector<std::string>{ "Tools = NAME", "Boundaries = NAME",
                                                       "Regions = NAME", "Gauges = NAME" }))
        .print();
  }


  std::vector<SceneParameters> read_operations(const ParameterFile &file)
  {
    std::string      list;
    ParameterHandler names;
    names.add_parameter("Operations", list);
    file.parse(names, true);
    const std::vector<std::string> operations = split_names("Operations", list);
    const std::vector<std::string> sections   = file.sections_of_family("Operation");
    for (const std::string &section : sections)
      if (std::find(operations.begin(), operations.end(), section) == operations.end())
        throw InputError::entry("Operations", list,
                                "there is a section \"Operation " + section +
                                    "\", and the list does not have it",
                                "the names of all operations in their order",
                                "Add it to the list, or take the section out");
    std::vector<SceneParameters> result;
    if (operations.empty())
      result.emplace_back(file);
    for (const std::string &operation : operations)
      {
        if (std::find(sections.begin(), sections.end(), operation) == sections.end())
          throw InputError::entry("Operations", list,
                                  "there is no section \"Operation " + operation + "\"",
                                  "names of sections", "Write it, or take the name out");
        in_operation(operation, [&] {
          result.emplace_back(file.seen_by("Operation", operation));
          result.back().operation = operation;
          result.back().check_files();
        });
        // The workpiece is made once.
        const GeometryParameters &own = result.back().workpiece, &first = result[0].workpiece;
        if (own.file != first.file || own.parameters != first.parameters ||
            own.physical_group != first.physical_group || own.face != first.face ||
            own.element_size != first.element_size ||
            own.refinement_levels != first.refinement_levels)
          throw InputError::entry("Operation " + operation + "/Workpiece/Geometry file", own.file,
                                  "the workpiece of an operation is what the one before has made",
                                  "a section Workpiece outside of the operations only",
                                  "Take it out of the operation");
      }
    note_idle_entries(file, operations, result);
    return result;
  }


  void in_operation(const std::string &name, const std::function<void()> &action)
  {
    if (name.empty())
      return action();
    try
      {
        action();
      }
    catch (const InputError &error)
      {
        throw InputError("Operation \"" + name + "\": " + error.what());
      }
    catch (const ComputationError &error)
      {
        throw ComputationError("Operation \"" + name + "\": " + error.what());
      }
  }


  void SceneParameters::check_files() const
  {
    for (const ToolParameters &tool : tools)
      {
        const std::string section = "Tool " + tool.name;
        tools::read_profile(tool.geometry, section, directory);
        tools::Motion(tool.motion, section + "/Motion", directory);
      }
    laws::Material(material, "Material", directory);
  }
} // namespace axiforge::scene
