// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/wording.h>
#include <axiforge/scene/gauge.h>

namespace axiforge::scene
{
  void GaugeParameters::declare(dealii::ParameterHandler &prm)
  {
    namespace Patterns = dealii::Patterns;
    prm.add_parameter(
        "Measure", measure,
        "What is measured [mm]. 'inner radius', 'outer radius': the smallest and the largest r of "
        "the outline's points that 'At' chooses; the inner one is that of a bore, and 0 for a "
        "workpiece without one. 'lower height', 'upper height': the same of z. Edges are measured "
        "as the parabolas they are, not only at their nodes.",
        Patterns::Selection("inner radius|outer radius|lower height|upper height"));
    prm.add_parameter(
        "At", at,
        "Where. A number: on the line z = number of a radius, r = number of a height [mm], which "
        "does not move. 'middle': on the line half way between the lowest and the highest point "
        "(of a height: the innermost and the outermost). 'tool NAME': where the workpiece touches "
        "that tool. Empty: on the whole surface. history.csv has 'nan' while there is no such "
        "point.");
  }


  Gauge make_gauge(const GaugeParameters &parameters, const std::vector<std::string> &tools)
  {
    const std::string &measure = parameters.measure;
    Gauge              gauge;
    gauge.name      = parameters.name;
    gauge.component = measure == "inner radius" || measure == "outer radius" ? 0 : 1;
    gauge.largest   = measure == "outer radius" || measure == "upper height";

    const std::string prefix = "tool ";
    if (parameters.at.empty())
      gauge.place = Gauge::Place::surface;
    else if (parameters.at == "middle")
      gauge.place = Gauge::Place::middle;
    else if (parse_number(parameters.at, gauge.line))
      gauge.place = Gauge::Place::line;
    else
      {
        const auto found = parameters.at.compare(0, prefix.size(), prefix) == 0
                               ? std::find(tools.begin(), tools.end(),
                                           std::string(trim(parameters.at.substr(prefix.size()))))
                               : tools.end();
        if (found == tools.end())
          throw InputError::entry(
              "Gauge " + parameters.name + "/At", parameters.at, "this is no place to measure at",
              "a number [mm], 'middle', 'tool NAME' with a tool of the scene (" +
                  (tools.empty() ? std::string("it has none") : list_in_words(tools)) +
                  "), or nothing for the whole surface");
        gauge.place = Gauge::Place::contact;
        gauge.tool  = found - tools.begin();
      }
    return gauge;
  }
} // namespace axiforge::scene
