// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/parameter_handler.h>

#include <axiforge/scene/folding_parameters.h>

namespace axiforge::scene
{
  void FoldingParameters::declare(dealii::ParameterHandler &prm)
  {
    namespace Patterns = dealii::Patterns;
    prm.add_parameter(
        "When found", when_found,
        "After every step the free surface is searched for parts that meet before the end of the "
        "next one: a fold (lap), a groove or a bore that closes. There is no contact of the "
        "workpiece with itself, so what is computed from there on is not what happens. 'stop': "
        "the run ends (status 2), results and checkpoint of the step are kept. 'warn': it says so "
        "and goes on. 'off': nobody looks.",
        Patterns::Selection("stop|warn|off"));
    prm.add_parameter(
        "Smallest gap", smallest_gap,
        "Surface that closes counts as closed when it is nearer than this share of the length of "
        "its edges, as a bore that never quite gets there. 0: only where it meets in the next "
        "step.",
        Patterns::Double(0, 1));
  }
} // namespace axiforge::scene
