// SPDX-License-Identifier: GPL-2.0-or-later
#include <limits>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/numbers.h>
#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/laws/friction.h>

namespace axiforge::laws
{
  namespace
  {
    struct Choice
    {
      std::string              name;
      FrictionKind             kind;
      std::vector<std::string> entries;
    };

    const std::vector<Choice> friction_laws = {
      { "none", FrictionKind::none, {} },
      { "sticking", FrictionKind::sticking, {} },
      { "coulomb", FrictionKind::coulomb, { "Coefficient", "Regularisation velocity" } },
      { "shear", FrictionKind::shear, { "Factor", "Regularisation velocity" } },
      { "arctan", FrictionKind::arctan, { "Factor", "Regularisation velocity" } },
      { "tangential forces",
        FrictionKind::tangential_forces,
        { "Factor", "Regularisation velocity" } },
      { "norton", FrictionKind::norton, { "Viscosity", "Exponent", "Regularisation velocity" } },
      { "smm",
        FrictionKind::smm,
        { "Factor", "Layer thickness", "Layer viscosity", "Layer element" } }
    };

    struct ViscosityChoice
    {
      std::string name;
      bool        of_workpiece;
    };

    const std::vector<ViscosityChoice> viscosities = { { "layer", false }, { "workpiece", true } };

    struct ElementChoice
    {
      std::string name;
      SmmElement  element;
    };

    const std::vector<ElementChoice> elements = { { "lagrange", SmmElement::lagrange },
                                                  { "serendipity", SmmElement::serendipity } };

    /// Name, variable, text and pattern of each entry, once.
    template <typename Parameters, typename Visitor>
    void for_each_entry(Parameters &p, const Visitor &visit)
    {
      using namespace dealii::Patterns;
      visit("Law", p.law,
            "Traction tau against the slip velocity v, with k = sigma/sqrt3. none; sticking; "
            "coulomb: min(mu p, k); shear: m k; arctan: m k (2/pi) atan(v/v0); tangential forces: "
            "m k against the slip of the last step, nothing in the first; norton: K |v|^q; smm: a "
            "friction layer between workpiece and tool. An entry that the law doesn't have must "
            "stay at its default.",
            Selection(selection_of(friction_laws)));
      visit("Coefficient", p.coefficient,
            "mu [-] of coulomb, 0 to less than 2 (above 1 with a note), needed there. No default: "
            "a law of friction without its "
            "constant would be none.",
            OptionalDouble());
      visit("Factor", p.factor,
            "m [-] of shear, arctan, tangential forces, 0 to 1; f' [-] of smm, 0 (no friction) to "
            "less than 1 (sticking), beta = f'/(1-f'). Needed there, no default.",
            OptionalDouble());
      visit(
          "Regularisation velocity", p.regularisation_velocity,
          "v0 [mm/s]: the slip at which coulomb, shear and tangential forces have reached 71 % "
          "and arctan 50 % of their value; it also keeps norton's slope finite. 0 means automatic: "
          "1e-3 of the characteristic speed, small against the slip nearly everywhere.",
          Double());
      visit("Viscosity", p.viscosity,
            "K [MPa (s/mm)^q] of norton, 0 or more. Needed there, no default.", OptionalDouble());
      visit("Exponent", p.exponent,
            "q [-] of norton, more than 0, up to 1. 1 is linear slip (Navier).", Double());
      visit("Layer thickness", p.layer_thickness,
            "t [mm] of the smm layer. 0 means automatic. With Layer viscosity = layer a "
            "rate-independent material doesn't feel it; with workpiece beta/t is what counts.",
            Double());
      visit("Layer viscosity", p.layer_viscosity,
            "Viscosity of the smm layer. layer: the material's law at the layer's own strain rate, "
            "the default because it derives from a convex potential; workpiece: that of the "
            "adjacent cell, one iteration old, which may fail to converge for rate-independent "
            "materials.",
            Selection(selection_of(viscosities)));
      visit(
          "Layer element", p.layer_element,
          "Element of the smm layer. lagrange: nine nodes, the centre one moves with the tool; it "
          "spreads friction over the nodes of an edge as 1/6, 4/6, 1/6. serendipity: the eight "
          "nodes of the paper, which spread it as 5/14, 4/14, 5/14 and make slip and traction "
          "zig-zag from node to node. Uniform slip feels the same friction with both.",
          Selection(selection_of(elements)));
    }

    /// v/sqrt(v^2 + v0^2) and its derivative.
    FrictionResponse regularised_sign(const double limit, const double v, const double v0)
    {
      const double w      = std::sqrt(v * v + v0 * v0);
      const double secant = limit / w;
      return { secant * v, secant * (v0 / w) * (v0 / w), secant };
    }

    /// The way out for a number that looks like one of per cent.
    std::string per_cent(const double value)
    {
      return fmt::format("Is it meant in per cent? {} % is {}", value, value / 100.);
    }

    double shear_yield_stress(const double flow_stress)
    {
      return flow_stress / std::sqrt(3.);
    }
  } // namespace

  void FrictionParameters::declare(dealii::ParameterHandler &prm)
  {
    for_each_entry(*this,
                   [&prm](const char *name, auto &variable, const char *text, const auto &pattern) {
                     prm.add_parameter(name, variable, text, pattern);
                   });
  }

  EntryTexts FrictionParameters::entries() const
  {
    EntryTexts texts;
    for_each_entry(*this, [&texts](const char *name, const auto &variable, const char *, auto &&) {
      texts.emplace_back(name, text_of(variable));
    });
    return texts;
  }

  Friction::Friction(const FrictionParameters &parameters,
                     const std::string        &section,
                     const double              characteristic_speed,
                     const double              characteristic_length)
      : coefficient_(parameters.coefficient)
      , factor_(parameters.factor)
      , viscosity_(parameters.viscosity)
      , exponent_(parameters.exponent)
      , layer_thickness_(0.)
      , workpiece_viscosity_(false)
      , layer_element_(SmmElement::lagrange)
      , regularisation_velocity_(0.)
  {
    const double     infinity = std::numeric_limits<double>::infinity();
    const EntryCheck check(section);
    const Choice    &choice = find_choice(check, "Law", parameters.law, friction_laws);
    law                     = choice.kind;

    FrictionParameters defaults;
    defaults.law = parameters.law;
    check.reject_unused("Law = " + choice.name, choice.entries, parameters.entries(),
                        defaults.entries());

    const auto has = [&](const std::string &entry) {
      return std::find(choice.entries.begin(), choice.entries.end(), entry) != choice.entries.end();
    };
    const std::string none = "0 is no friction, which Law = none says as well";
    if (has("Coefficient"))
      check.needed("Coefficient", parameters.coefficient, none);
    if (has("Factor"))
      check.needed("Factor", parameters.factor, none);
    if (has("Viscosity"))
      check.needed("Viscosity", parameters.viscosity, none);

    // What stands at its default passes: the checks need not know which law reads which entry.
    check.between("Coefficient", parameters.coefficient, 0., infinity);
    if (parameters.coefficient >= 2.)
      check.below("Coefficient", parameters.coefficient, 0., 2., per_cent(parameters.coefficient));
    if (parameters.coefficient > 1.)
      note(fmt::format("\"{}\" = {} is more than any pair of materials has: the surface will stick "
                       "wherever it is pressed. In per cent, {} % is {}.",
                       check.path("Coefficient"), parameters.coefficient, parameters.coefficient,
                       parameters.coefficient / 100));
    check.between("Viscosity", parameters.viscosity, 0., infinity);
    check.between("Regularisation velocity", parameters.regularisation_velocity, 0., infinity);
    check.between("Layer thickness", parameters.layer_thickness, 0., infinity);
    if (!(parameters.exponent > 0.) || parameters.exponent > 1.)
      throw InputError::entry(check.path("Exponent"), fmt::format("{}", parameters.exponent),
                              "it is out of range", "more than 0, up to 1",
                              "For a traction that does not depend on the slip use Law = shear");
    if (parameters.factor >= 2.)
      check.between("Factor", parameters.factor, 0., 1., per_cent(parameters.factor));
    if (law == FrictionKind::smm)
      check.below("Factor", parameters.factor, 0., 1.,
                  "The layer's beta = f'/(1-f') is infinite at f' = 1, which is sticking: use "
                  "Law = sticking");
    else
      check.between("Factor", parameters.factor, 0., 1.);
    workpiece_viscosity_ =
        find_choice(check, "Layer viscosity", parameters.layer_viscosity, viscosities).of_workpiece;
    layer_element_ =
        find_choice(check, "Layer element", parameters.layer_element, elements).element;

    if (has("Regularisation velocity"))
      {
        regularisation_velocity_ = parameters.regularisation_velocity > 0.
                                       ? parameters.regularisation_velocity
                                       : 1e-3 * characteristic_speed;
        if (!(regularisation_velocity_ > 0.))
          throw InputError::entry(check.path("Regularisation velocity"), "0",
                                  "there is no speed to choose it from, because no tool moves",
                                  "> 0",
                                  "Give about a thousandth of the usual slip velocity in mm/s");
      }
    if (law == FrictionKind::sticking)
      regularisation_velocity_ = characteristic_speed > 0 ? 1e-3 * characteristic_speed : 1.;
    if (law == FrictionKind::smm)
      {
        layer_thickness_ =
            parameters.layer_thickness > 0. ? parameters.layer_thickness : characteristic_length;
        if (!(layer_thickness_ > 0.))
          throw InputError::entry(check.path("Layer thickness"), "0",
                                  "there is no length to choose it from", "> 0",
                                  "Give a thickness in mm, small against the workpiece");
      }
  }

  FrictionKind Friction::kind() const
  {
    return law;
  }

  FrictionResponse Friction::evaluate(const FrictionPoint &point) const
  {
    const double v  = point.slip;
    const double v0 = regularisation_velocity_;
    switch (law)
      {
      case FrictionKind::none:
        return { 0., 0., 0. };
      case FrictionKind::coulomb:
      case FrictionKind::shear:
      case FrictionKind::sticking:
        return regularised_sign(cap(point.pressure, point.flow_stress), v, v0);
      case FrictionKind::arctan:
        {
          const double scale    = 2. / dealii::numbers::PI * cap(point.pressure, point.flow_stress);
          const double x        = v / v0;
          const double traction = scale * std::atan(x);
          return { traction, scale / (v0 * (1. + x * x)),
                   std::abs(x) < 1e-8 ? scale / v0 : traction / v };
        }
      case FrictionKind::tangential_forces:
        if (!point.has_previous)
          return { 0., 0., 0. };
        return { regularised_sign(cap(point.pressure, point.flow_stress), point.previous_slip, v0)
                     .traction,
                 0., 0. };
      case FrictionKind::norton:
        {
          const double square = v * v + v0 * v0;
          const double secant = viscosity_ * std::pow(square, 0.5 * (exponent_ - 1.));
          return { secant * v, secant * (v0 * v0 + exponent_ * v * v) / square, secant };
        }
      case FrictionKind::smm:
        break;
      }
    AssertThrow(false, dealii::ExcMessage("This friction law is not a traction of one point."));
    return { 0., 0., 0. };
  }

  double Friction::cap(const double pressure, const double flow_stress) const
  {
    switch (law)
      {
      case FrictionKind::none:
        return 0.;
      case FrictionKind::coulomb:
        return std::min(coefficient_ * std::max(pressure, 0.), shear_yield_stress(flow_stress));
      case FrictionKind::shear:
      case FrictionKind::arctan:
      case FrictionKind::tangential_forces:
        return factor_ * shear_yield_stress(flow_stress);
      case FrictionKind::sticking:
        return shear_yield_stress(flow_stress);
      case FrictionKind::norton:
      case FrictionKind::smm:
        break;
      }
    return std::numeric_limits<double>::infinity();
  }

  double Friction::factor() const
  {
    return factor_;
  }

  double Friction::beta() const
  {
    return factor_ / (1. - factor_);
  }

  double Friction::layer_thickness() const
  {
    return layer_thickness_;
  }

  SmmElement Friction::layer_element() const
  {
    return layer_element_;
  }

  bool Friction::workpiece_viscosity() const
  {
    return workpiece_viscosity_;
  }

  double Friction::regularisation_velocity() const
  {
    return regularisation_velocity_;
  }

  double
  primal_dual_tangent(const FrictionResponse &response, const double stored, const double cap)
  {
    if (response.traction == 0.)
      return response.secant;
    const double projected = std::clamp(stored, -cap, cap);
    return std::max(0., response.secant + (response.derivative - response.secant) *
                                              (projected / response.traction));
  }
} // namespace axiforge::laws
