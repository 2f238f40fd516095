// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <limits>
#include <map>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/geometry_parameters.h>
#include <axiforge/base/wording.h>
#include <axiforge/study/plan.h>

namespace axiforge::study
{
  namespace
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();


    std::vector<std::string> split(const std::string &text, const char separator)
    {
      std::vector<std::string> parts;
      std::size_t              begin = 0;
      while (begin <= text.size())
        {
          const std::size_t end = std::min(text.find(separator, begin), text.size());
          parts.emplace_back(trim(std::string_view(text).substr(begin, end - begin)));
          begin = end + 1;
        }
      return parts;
    }


    /// The parts of an entry; none may be empty. An empty text has none.
    std::vector<std::string> split_list(const std::string &entry,
                                        const std::string &text,
                                        const char         separator,
                                        const std::string &what)
    {
      if (trim(text).empty())
        return {};
      std::vector<std::string> parts = split(text, separator);
      if (parts.size() > 1 && parts.back().empty())
        parts.pop_back(); // a separator at the end does no harm
      for (const std::string &part : parts)
        if (part.empty())
          throw InputError::entry(entry, text, "a part of the list is empty",
                                  what + ", separated by \"" + separator + "\"",
                                  "Take out the separator that is too many");
      return parts;
    }


    /// The list of geometry parameters in a section, or null if the section has none.
    const std::string *geometry_list(const scene::SceneParameters &scene,
                                     const std::string            &section)
    {
      if (section == "Workpiece")
        return &scene.workpiece.parameters;
      for (const scene::ToolParameters &tool : scene.tools)
        if (section == "Tool " + tool.name)
          return &tool.geometry.parameters;
      return nullptr;
    }


    /**
     * The overrides of one value. Several parameters of one list of geometry parameters are
     * gathered, so that they do not undo each other.
     */
    std::vector<std::string> overrides_of(const scene::SceneParameters   &scene,
                                          const std::vector<std::string> &entries,
                                          const std::vector<std::string> &parts)
    {
      const std::string                  middle = "/Geometry parameters/";
      std::vector<std::string>           overrides;
      std::map<std::string, std::string> lists; // by section
      for (unsigned int i = 0; i < entries.size(); ++i)
        {
          const std::string &value = parts.size() == 1 ? parts[0] : parts[i];
          const std::size_t  at    = entries[i].find(middle);
          if (at == std::string::npos)
            {
              overrides.push_back(
                  (entries[i] == "refinement" ? "Workpiece/Refinement levels" : entries[i]) +
                  " = " + value);
              continue;
            }
          const std::string  section = entries[i].substr(0, at);
          const std::string *list    = geometry_list(scene, section);
          if (!list)
            throw InputError::entry("Study/Entry", scene.study.entry,
                                    "there is no section \"" + section +
                                        "\" with geometry parameters",
                                    "\"Workpiece/Geometry parameters/NAME\", \"Tool "
                                    "NAME/Geometry parameters/NAME\"");
          lists[section] = with_geometry_parameter(lists.count(section) ? lists[section] : *list,
                                                   entries[i].substr(at + middle.size()), value);
        }
      for (const auto &[section, list] : lists)
        overrides.push_back(section + "/Geometry parameters = " + list);
      return overrides;
    }


    std::vector<Variation> make_variations(const scene::SceneParameters &scene)
    {
      const scene::StudyParameters  &study = scene.study;
      const std::vector<std::string> entries =
          split_list("Study/Entry", study.entry, ';', "entries as \"Section/Entry\"");
      if (entries.empty())
        throw InputError::entry(
            "Study/Entry", "", "the scene has no study: nothing is said to vary",
            "'refinement', or an entry as \"Time stepping/Stroke per step\"",
            "Give the scene a \"subsection Study\" with Entry and Values, or leave out the word "
            "study to run it once");
      const std::vector<std::string> values =
          split_list("Study/Values", study.values, ';', "values of the entry");
      if (values.empty())
        throw InputError::entry("Study/Values", "", "there are no values to run",
                                "values of \"" + study.entry + "\", separated by \";\"",
                                "For example \"Values = 0; 1; 2\"");

      std::vector<Variation> variations;
      for (const std::string &value : values)
        {
          const std::vector<std::string> parts =
              entries.size() == 1 ? std::vector<std::string>(1, value)
                                  : split_list("Study/Values", value, '|', "a part for each entry");
          if (parts.size() != 1 && parts.size() != entries.size())
            throw InputError::entry(
                "Study/Values", value,
                fmt::format("it has {} parts for {} entries", parts.size(), entries.size()),
                fmt::format("one value for all, or {} separated by \"|\"", entries.size()));
          Variation variation{ value, nan, overrides_of(scene, entries, parts) };
          double    number;
          if (parse_number(value, number))
            variation.number = number;
          variations.push_back(variation);
        }
      return variations;
    }


    void read_place(const scene::StudyParameters &study, Plan &plan)
    {
      const std::string text(trim(study.at));
      plan.at = Place::end;
      if (text == "end")
        return;
      if (text == "all")
        {
          plan.at = Place::whole_curve;
          if (plan.single_velocity_solve)
            throw InputError::entry("Study/At", "all",
                                    "a single velocity solve has no curve over the stroke", "end",
                                    "Take the entry out, or set \"Single velocity solve = false\"");
          return;
        }
      plan.at = Place::strokes;
      for (const std::string &part : split_list("Study/At", text, ',', "strokes [mm]"))
        {
          double stroke;
          if (!parse_number(part, stroke) || stroke < 0)
            throw InputError::entry("Study/At", study.at, "\"" + part + "\" is not a stroke",
                                    "'end', 'all', or strokes [mm] separated by commas");
          plan.strokes.push_back(stroke);
        }
      if (plan.strokes.empty())
        throw InputError::entry("Study/At", study.at, "it says no place",
                                "'end', 'all', or strokes [mm] separated by commas");
      std::sort(plan.strokes.begin(), plan.strokes.end());
      if (plan.single_velocity_solve)
        throw InputError::entry("Study/At", study.at,
                                "a single velocity solve is made at the start only", "end",
                                "Take the entry out, or set \"Single velocity solve = false\"");
    }


    void read_references(const scene::StudyParameters &study, Plan &plan)
    {
      for (const std::string &part :
           split_list("Study/Reference", study.reference, ',', "a number per quantity, or 'none'"))
        {
          double number = nan;
          if (part != "none" && !parse_number(part, number))
            throw InputError::entry("Study/Reference", study.reference,
                                    "\"" + part + "\" is not a number",
                                    "a number per quantity, or 'none'");
          plan.references.push_back(number);
        }
      if (!plan.references.empty() && plan.at == Place::whole_curve)
        throw InputError::entry("Study/Reference", study.reference,
                                "the whole curve is compared, which has no single value", "nothing",
                                "Take the entry out, or compare at one place with \"Study/At\"");
      if (!plan.references.empty() && plan.strokes.size() > 1)
        throw InputError::entry("Study/Reference", study.reference,
                                "quantities are compared at several strokes", "nothing",
                                "Compare at one stroke only, or take the entry out");
    }
  } // namespace


  Plan make_plan(const scene::SceneParameters &scene)
  {
    const scene::StudyParameters &study = scene.study;
    Plan                          plan;
    plan.entry      = study.entry;
    plan.variations = make_variations(scene);
    plan.ratio      = study.refinement_ratio;
    if (plan.ratio != 0 && plan.ratio <= 1)
      throw InputError::entry("Study/Refinement ratio", fmt::format("{}", plan.ratio),
                              "a value has to be finer than the one before",
                              "a number above 1, or 0 for no convergence study",
                              "Give the values from coarse to fine");
    plan.single_velocity_solve = study.single_velocity_solve;
    plan.quantities =
        split_list("Study/Quantities", study.quantities, ',', "columns of history.csv");
    read_place(study, plan);
    read_references(study, plan);
    return plan;
  }


  void choose_quantities(const scene::SceneParameters   &scene,
                         const std::vector<std::string> &columns,
                         Plan                           &plan)
  {
    if (plan.quantities.empty())
      {
        for (const scene::ToolParameters &tool : scene.tools)
          plan.quantities.push_back("force_" + tool.name + "_N");
        for (const scene::BoundaryParameters &boundary : scene.boundaries)
          if (boundary.type == "velocity")
            plan.quantities.push_back("pressure_" + boundary.name + "_MPa");
        plan.quantities.push_back("largest_radius_mm");
      }
    for (const std::string &quantity : plan.quantities)
      if (std::find(columns.begin(), columns.end(), quantity) == columns.end())
        {
          const std::string nearest = closest_name(quantity, columns);
          throw InputError::entry(
              "Study/Quantities", quantity, "history.csv of this scene has no such column",
              list_in_words(columns), nearest.empty() ? "" : "Did you mean \"" + nearest + "\"?");
        }
    if (plan.references.size() > plan.quantities.size())
      throw InputError::entry("Study/Reference", scene.study.reference,
                              fmt::format("there are {} references for {} quantities",
                                          plan.references.size(), plan.quantities.size()),
                              "one for each quantity, or 'none'");
    plan.references.resize(plan.quantities.size(), nan);
  }
} // namespace axiforge::study
