// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/errors.h>
#include <axiforge/scene/accuracy_parameters.h>

namespace axiforge::scene
{
  namespace Patterns = dealii::Patterns;

  void AccuracyParameters::declare(dealii::ParameterHandler &prm)
  {
    prm.add_parameter(
        "Target accuracy", target,
        "Relative error of the tool force that the run is driven to: '1 %' or 0.01. The mesh is "
        "refined and coarsened until its estimated part is below half of the target, within the "
        "limits of Refinement, and steps are as long as their part stays below three tenths; steps "
        "that are given count as the longest. The other parts, of the regularisation and of the "
        "solver, are small as a rule and stand in history.csv. 'none': the mesh and the steps are "
        "as given.");
    prm.add_parameter(
        "Estimate errors", estimate_errors,
        "Whether the errors of the force are estimated and written (columns error_* of "
        "history.csv) without a target as well.");
    prm.add_parameter(
        "Check every steps", check_every,
        "After so many steps the estimate of the mesh's part is checked: the flow is solved once "
        "more on halved cells, which costs some steps. In between the check is scaled by the "
        "recovery estimate.",
        Patterns::Integer(1));
  }


  Accuracy::Accuracy(const AccuracyParameters &parameters)
      : check_every(parameters.check_every)
  {
    std::string text = parameters.target;
    if (text != "none")
      {
        double            unit    = 1;
        const std::size_t percent = text.find('%');
        if (percent != std::string::npos)
          {
            unit = 0.01;
            text = text.substr(0, percent) + text.substr(percent + 1);
          }
        std::size_t used = 0;
        try
          {
            target = unit * std::stod(text, &used);
          }
        catch (const std::exception &)
          {
            used = 0;
          }
        const bool whole = used > 0 && text.find_first_not_of(" \t", used) == std::string::npos;
        if (!whole || !(target >= 1e-5 && target <= 0.5))
          throw InputError::entry("Accuracy/Target accuracy", parameters.target,
                                  "this is no relative error of the force",
                                  "'none', a share between 1e-5 and 0.5, or the same in percent",
                                  "For example \"1 %\" or \"0.01\"");
      }
    estimated = parameters.estimate_errors || target > 0;
  }


  void RegionParameters::declare(dealii::ParameterHandler &prm)
  {
    prm.add_parameter("Lower corner", lower,
                      "Corner \"r, z\" [mm] of the box with the smaller coordinates.");
    prm.add_parameter("Upper corner", upper,
                      "Corner \"r, z\" [mm] with the larger ones. The coordinates are those at the "
                      "start of the run.");
    prm.add_parameter("Moves with", moves_with,
                      "The tool that the box moves with. Empty: it stands still in space.");
    prm.add_parameter("Element size", element_size,
                      "Cells that have a part in the box are divided until their longer side is at "
                      "most this long [mm]. 0: by the level alone.",
                      Patterns::Double(0));
    prm.add_parameter(
        "Level", level,
        "How many times a cell of the file's mesh is divided there at least. 0: by the size alone. "
        "Neither is bound by \"Refinement/Largest level\", but by its other limits.",
        Patterns::Integer(0, 20));
  }
} // namespace axiforge::scene
