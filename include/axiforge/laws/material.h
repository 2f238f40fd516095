// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <variant>

#include <axiforge/base/optional_number.h>
#include <axiforge/laws/entries.h>
#include <axiforge/laws/flow_stress_table.h>
#include <axiforge/laws/hardening.h>
#include <axiforge/laws/rate_sensitivity.h>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::laws
{
  /**
   * The entries of a material's section as they are read. What must be positive is 0 as long as it
   * is not given; where 0 has a meaning there is no default. A law that needs it says so.
   */
  struct MaterialParameters
  {
    std::string    model            = "perfectly plastic";
    std::string    hardening        = "none";
    std::string    rate_sensitivity = "none";
    double         yield_stress     = 0.; // MPa
    OptionalNumber strength;              // MPa
    OptionalNumber hardening_exponent;
    double         smallest_strain       = 1e-4;
    double         prestrain             = 0.;
    double         saturation_stress     = 0.; // MPa
    double         characteristic_strain = 0.;
    OptionalNumber rate_exponent;
    OptionalNumber rate_coefficient;
    double         reference_rate = 1.; // 1/s
    std::string    table_file;

    /// Declares the entries in the handler's current section; parsing fills the members.
    void declare(dealii::ParameterHandler &prm);

    /// All entries with their present values.
    EntryTexts entries() const;
  };

  /**
   * The flow stress sigma(strain, strain rate) of a rigid-viscoplastic material: a hardening law
   * times a rate law, or a table. The lists in material.cc say which names stand for which laws.
   */
  class Material
  {
  public:
    /**
     * Checks the entries and builds the laws.
     *
     * @param section the section's name in messages: "Material" gives "Material/Yield stress"
     * @param directory where a relative `Table file` is looked for
     *
     * Throws InputError for an unknown name, a constant out of range, an entry that the chosen
     * model doesn't have, or a faulty table.
     */
    Material(const MaterialParameters &parameters,
             const std::string        &section,
             const std::string        &directory);

    /**
     * @param strain effective strain; below 0 it counts as 0
     * @param strain_rate effective strain rate [1/s]; below 1e-30 it counts as 1e-30
     *
     * The stress is positive and 0 <= d log(stress)/d log(rate) <= 1 (for a table: if its data have
     * that property). Doesn't allocate.
     */
    FlowStress flow_stress(double strain, double strain_rate) const;

    bool depends_on_strain() const;
    bool depends_on_rate() const;

    /// The table of `Model = table`; null for a formula.
    const FlowStressTable *table() const;

  private:
    struct Product
    {
      Hardening       hardening;
      RateSensitivity rate;
    };

    std::variant<Product, FlowStressTable> law;

    static std::variant<Product, FlowStressTable> build(const MaterialParameters &parameters,
                                                        const std::string        &section,
                                                        const std::string        &directory);
  };
} // namespace axiforge::laws
