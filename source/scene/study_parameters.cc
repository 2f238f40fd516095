// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/parameter_handler.h>

#include <axiforge/scene/study_parameters.h>

namespace axiforge::scene
{
  void StudyParameters::declare(dealii::ParameterHandler &prm)
  {
    namespace Patterns = dealii::Patterns;
    prm.add_parameter(
        "Entry", entry,
        "What 'axiforge study' varies: 'Section/Sub section/Entry', one number of a list of "
        "geometry parameters as 'Workpiece/Geometry parameters/RadialCells', or 'refinement' for "
        "'Workpiece/Refinement levels'. Several that change together are separated by ';'. Empty: "
        "the scene is no study.");
    prm.add_parameter(
        "Values", values,
        "The values of the entry, separated by ';', since a value may contain commas; coarsest "
        "first where they converge. With several entries a value is for all of them, or has a part "
        "for each, separated by '|'.");
    prm.add_parameter(
        "Refinement ratio", refinement_ratio,
        "How many times finer (mesh size or step) a value is than the one before: 2 for halves. "
        "From it follow observed orders p, limits by Richardson's extrapolation and the error of "
        "the last value. 0: the values are no such sequence.",
        Patterns::Double(0));
    prm.add_parameter(
        "Quantities", quantities,
        "Columns of history.csv to compare, separated by commas. Empty: the forces of the tools, "
        "the pressures of velocity boundaries, the largest radius.");
    prm.add_parameter(
        "At", at,
        "Where quantities are compared. 'end': at the end of the run. Numbers, separated by "
        "commas: at these strokes [mm]. 'all': root mean square of the difference from the last "
        "run over the whole curve. Curves are interpolated with cubics; forces, powers and rates "
        "hold at the middle of their step and are continued by half a step to the end.");
    prm.add_parameter(
        "Single velocity solve", single_velocity_solve,
        "Solve for the velocity once, in the geometry of the start (explicit scheme, one step of "
        "a millionth of the height), instead of running to the end.",
        Patterns::Bool());
    prm.add_parameter(
        "Reference", reference,
        "What the quantities should be, one number per quantity in their units, separated by "
        "commas; 'none' for a quantity without one. Empty: none. With it the table has errors "
        "relative to the reference and their orders. Not with 'At = all'.");
  }
} // namespace axiforge::scene
