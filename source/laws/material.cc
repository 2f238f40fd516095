// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <limits>

#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/errors.h>
#include <axiforge/laws/material.h>

namespace axiforge::laws
{
  namespace
  {
    using Constants = MaterialParameters;

    const double infinity = std::numeric_limits<double>::infinity();

    // The constants of each law, checked. One function per law.

    Hardening make_yield(const Constants &c, const EntryCheck &check)
    {
      return ConstantStress{ check.positive("Yield stress", c.yield_stress) };
    }

    Hardening make_strength(const Constants &c, const EntryCheck &check)
    {
      return ConstantStress{ check.positive("Strength coefficient", c.strength) };
    }

    Hardening make_hollomon(const Constants &c, const EntryCheck &check)
    {
      return Hollomon{
        check.positive("Strength coefficient", c.strength),
        check.below(
            "Hardening exponent", check.needed("Hardening exponent", c.hardening_exponent), 0., 1.,
            "A stress in proportion to the strain vanishes at strain 0: use ludwik or swift"),
        check.between("Smallest strain", c.smallest_strain, 1e-12, 0.1)
      };
    }

    Hardening make_ludwik(const Constants &c, const EntryCheck &check)
    {
      return Ludwik{ check.positive("Yield stress", c.yield_stress),
                     check.between("Strength coefficient",
                                   check.needed("Strength coefficient", c.strength), 0., infinity),
                     check.between("Hardening exponent",
                                   check.needed("Hardening exponent", c.hardening_exponent), 0.,
                                   1.),
                     check.between("Smallest strain", c.smallest_strain, 1e-12, 0.1) };
    }

    Hardening make_swift(const Constants &c, const EntryCheck &check)
    {
      return Swift{ check.positive("Strength coefficient", c.strength),
                    check.between("Hardening exponent",
                                  check.needed("Hardening exponent", c.hardening_exponent), 0., 1.),
                    check.positive(
                        "Prestrain", c.prestrain,
                        "It keeps the stress positive at strain 0; without it use hollomon") };
    }

    Hardening make_voce(const Constants &c, const EntryCheck &check)
    {
      const double yield = check.positive("Yield stress", c.yield_stress);
      return Voce{ yield,
                   check.between("Saturation stress", c.saturation_stress, yield, infinity,
                                 "It must not lie below the yield stress: the law hardens"),
                   check.positive("Characteristic strain", c.characteristic_strain) };
    }

    RateSensitivity make_rate_independent(const Constants &, const EntryCheck &)
    {
      return RateIndependent{};
    }

    RateSensitivity make_power_rate(const Constants &c, const EntryCheck &check)
    {
      return PowerRate{ check.between("Rate exponent",
                                      check.needed("Rate exponent", c.rate_exponent), 0., 1.),
                        check.positive("Reference strain rate", c.reference_rate) };
    }

    RateSensitivity make_cowper_symonds(const Constants &c, const EntryCheck &check)
    {
      return CowperSymonds{ check.between("Rate exponent",
                                          check.needed("Rate exponent", c.rate_exponent), 0., 1.),
                            check.positive("Reference strain rate", c.reference_rate) };
    }

    RateSensitivity make_johnson_cook(const Constants &c, const EntryCheck &check)
    {
      return JohnsonCook{ check.between("Rate coefficient",
                                        check.needed("Rate coefficient", c.rate_coefficient), 0.,
                                        0.5),
                          check.positive("Reference strain rate", c.reference_rate) };
    }

    /// A name of the .prm, the entries that it reads, and the law that it stands for.
    template <typename Law> struct Choice
    {
      std::string              name;
      std::vector<std::string> entries;
      Law (*make)(const Constants &, const EntryCheck &);
    };

    // A new hardening law is a struct in hardening.h, its make function above and a line here.
    const std::vector<Choice<Hardening>> hardening_laws = {
      { "none", { "Yield stress" }, make_yield },
      { "hollomon",
        { "Strength coefficient", "Hardening exponent", "Smallest strain" },
        make_hollomon },
      { "ludwik",
        { "Yield stress", "Strength coefficient", "Hardening exponent", "Smallest strain" },
        make_ludwik },
      { "swift", { "Strength coefficient", "Hardening exponent", "Prestrain" }, make_swift },
      { "voce", { "Yield stress", "Saturation stress", "Characteristic strain" }, make_voce }
    };

    // A new rate law is a struct in rate_sensitivity.h, its make function above and a line here.
    const std::vector<Choice<RateSensitivity>> rate_laws = {
      { "none", {}, make_rate_independent },
      { "power", { "Rate exponent", "Reference strain rate" }, make_power_rate },
      { "cowper-symonds", { "Rate exponent", "Reference strain rate" }, make_cowper_symonds },
      { "johnson-cook", { "Rate coefficient", "Reference strain rate" }, make_johnson_cook }
    };

    const Choice<Hardening> strength_alone = { "strength",
                                               { "Strength coefficient" },
                                               make_strength };

    /// A model is a pair of the laws above; an empty name means something of its own.
    struct Model
    {
      std::string name;
      std::string hardening;
      std::string rate;
    };

    const std::vector<Model> models = { { "perfectly plastic", "none", "none" },
                                        { "power law", "strength", "power" },
                                        { "perzyna", "none", "cowper-symonds" },
                                        { "hollomon", "hollomon", "none" },
                                        { "ludwik", "ludwik", "none" },
                                        { "swift", "swift", "none" },
                                        { "voce", "voce", "none" },
                                        { "product", "", "" },
                                        { "table", "", "" } };

    /// Name, variable, text and pattern of each entry, once.
    template <typename Parameters, typename Visitor>
    void for_each_entry(Parameters &p, const Visitor &visit)
    {
      using namespace dealii::Patterns;
      visit("Model", p.model,
            "The flow stress sigma. perfectly plastic: the yield stress; power law (Norton-Hoff): "
            "C (epsdot/epsdot0)^m; perzyna: sigma0 (1 + (epsdot/gamma)^m); hollomon: K eps^n; "
            "ludwik: sigma0 + K eps^n; swift: K (eps0 + eps)^n; voce: sigma_sat - (sigma_sat - "
            "sigma0) exp(-eps/eps_c); product: the law of `Hardening` times the factor of `Rate "
            "sensitivity`; table: `Table file`. An entry that the model doesn't have must stay at "
            "its default.",
            Selection(selection_of(models)));
      visit("Hardening", p.hardening,
            "Model product only: the stress at the reference strain rate. none: the yield stress.",
            Selection(selection_of(hardening_laws)));
      visit("Rate sensitivity", p.rate_sensitivity,
            "Model product only: the factor of the stress. power: (epsdot/epsdot0)^m; "
            "cowper-symonds: 1 + (epsdot/gamma)^m; johnson-cook: 1 + C ln(epsdot/epsdot0), "
            "continued smoothly where it falls below 1/2. At epsdot0 the stress is the hardening "
            "law's (cowper-symonds: at rest).",
            Selection(selection_of(rate_laws)));
      visit("Yield stress", p.yield_stress,
            "sigma0 [MPa], uniaxial. perfectly plastic, perzyna, ludwik, voce. 0 means not given, "
            "because no material's stress is a good guess for another.",
            Double());
      visit("Strength coefficient", p.strength,
            "C [MPa], the stress at the reference strain rate, of the power law; K [MPa] of "
            "hollomon, ludwik, swift. Needed there, no default.",
            OptionalDouble());
      visit("Hardening exponent", p.hardening_exponent,
            "n [-] of hollomon, ludwik, swift, 0 to 1; 0 means no hardening. Needed there, no "
            "default.",
            OptionalDouble());
      visit(
          "Smallest strain", p.smallest_strain,
          "eps_s [-] of hollomon and ludwik, whose slope is infinite at strain 0: below it the "
          "law goes on as its tangent (hollomon) or as a parabola that begins at the yield stress "
          "(ludwik). 1e-4 is a hundredth of the strain of a usual step.",
          Double());
      visit("Prestrain", p.prestrain, "eps0 [-] of swift. 0 means not given.", Double());
      visit("Saturation stress", p.saturation_stress,
            "sigma_sat [MPa] of voce, at least the yield stress. 0 means not given.", Double());
      visit("Characteristic strain", p.characteristic_strain,
            "eps_c [-] of voce. 0 means not given.", Double());
      visit("Rate exponent", p.rate_exponent,
            "m [-] of the power law, perzyna and the power and cowper-symonds factors, 0 to 1; 0 "
            "means that the rate has no influence. Needed there, no default.",
            OptionalDouble());
      visit("Rate coefficient", p.rate_coefficient,
            "C [-] of the johnson-cook factor, 0 to 0.5; 0 means that the rate has no influence. "
            "Needed there, no default.",
            OptionalDouble());
      visit("Reference strain rate", p.reference_rate,
            "epsdot0 [1/s] of the power law and of the power and johnson-cook factors; gamma [1/s] "
            "of perzyna and cowper-symonds. At 1 the power law is C epsdot^m.",
            Double());
      visit("Table file", p.table_file,
            "Model table only: a CSV file. First row: anything, then the strain rates [1/s]; each "
            "further row: a strain, then the stresses [MPa]. Relative to the .prm file. Monotone "
            "cubics in the strain and in the logarithm of the rate; outside the table the value at "
            "its edge.",
            Anything());
    }
  } // namespace

  void MaterialParameters::declare(dealii::ParameterHandler &prm)
  {
    for_each_entry(*this,
                   [&prm](const char *name, auto &variable, const char *text, const auto &pattern) {
                     prm.add_parameter(name, variable, text, pattern);
                   });
  }

  EntryTexts MaterialParameters::entries() const
  {
    EntryTexts texts;
    for_each_entry(*this, [&texts](const char *name, const auto &variable, const char *, auto &&) {
      texts.emplace_back(name, text_of(variable));
    });
    return texts;
  }

  std::variant<Material::Product, FlowStressTable>
  Material::build(const MaterialParameters &parameters,
                  const std::string        &section,
                  const std::string        &directory)
  {
    const EntryCheck check(section);
    const Model     &model = find_choice(check, "Model", parameters.model, models);

    MaterialParameters defaults;
    defaults.model = parameters.model;

    if (model.name == "table")
      {
        check.reject_unused("Model = table", { "Table file" }, parameters.entries(),
                            defaults.entries());
        const std::string entry = check.path("Table file");
        if (parameters.table_file.empty())
          throw InputError::entry(entry, "", "Model = table needs a file",
                                  "the name of a CSV file");
        return FlowStressTable::read(
            (std::filesystem::path(directory) / parameters.table_file).lexically_normal().string(),
            entry);
      }

    const bool               is_product = model.name == "product";
    std::string              choice     = "Model = " + model.name;
    std::vector<std::string> used;
    if (is_product)
      {
        choice += ", Hardening = " + parameters.hardening +
                  ", Rate sensitivity = " + parameters.rate_sensitivity;
        used = { "Hardening", "Rate sensitivity" };
      }
    const std::string &hardening_name = is_product ? parameters.hardening : model.hardening;
    const std::string &rate_name      = is_product ? parameters.rate_sensitivity : model.rate;

    const Choice<Hardening> &hardening =
        !is_product && hardening_name == strength_alone.name
            ? strength_alone
            : find_choice(check, "Hardening", hardening_name, hardening_laws);
    const Choice<RateSensitivity> &rate =
        find_choice(check, "Rate sensitivity", rate_name, rate_laws);

    used.insert(used.end(), hardening.entries.begin(), hardening.entries.end());
    used.insert(used.end(), rate.entries.begin(), rate.entries.end());
    check.reject_unused(choice, used, parameters.entries(), defaults.entries());

    return Product{ hardening.make(parameters, check), rate.make(parameters, check) };
  }

  Material::Material(const MaterialParameters &parameters,
                     const std::string        &section,
                     const std::string        &directory)
      : law(build(parameters, section, directory))
  {
  }

  FlowStress Material::flow_stress(const double strain, const double strain_rate) const
  {
    const double eps  = std::max(strain, 0.);
    const double rate = std::max(strain_rate, 1e-30);
    if (const auto *table = std::get_if<FlowStressTable>(&law))
      return (*table)(eps, rate);

    const auto          call = [](const double x) { return [x](const auto &f) { return f(x); }; };
    const Product      &product  = *std::get_if<Product>(&law);
    const ValueAndSlope hardened = std::visit(call(eps), product.hardening);
    const ValueAndSlope factor   = std::visit(call(rate), product.rate);
    return { hardened.value * factor.value, hardened.slope * factor.value,
             hardened.value * factor.slope };
  }

  const FlowStressTable *Material::table() const
  {
    return std::get_if<FlowStressTable>(&law);
  }

  bool Material::depends_on_strain() const
  {
    if (const auto *table = std::get_if<FlowStressTable>(&law))
      return table->depends_on_strain();
    return !std::holds_alternative<ConstantStress>(std::get<Product>(law).hardening);
  }

  bool Material::depends_on_rate() const
  {
    if (const auto *table = std::get_if<FlowStressTable>(&law))
      return table->depends_on_rate();
    return !std::holds_alternative<RateIndependent>(std::get<Product>(law).rate);
  }
} // namespace axiforge::laws
