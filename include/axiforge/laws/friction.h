// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/base/optional_number.h>
#include <axiforge/laws/entries.h>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::laws
{
  /// `none` and `sticking` are conditions on the velocity, `smm` is a layer (smm_layer.h); the
  /// others are tractions that Friction::evaluate() gives. So is what a sticking node bears that
  /// can't be held (doc/theory.md, section 5).
  enum class FrictionKind
  {
    none,
    sticking,
    coulomb,
    shear,
    arctan,
    tangential_forces,
    norton,
    smm
  };

  /**
   * The fictitious element's shape functions. Both have the same geometry and, through the
   * thickness, the same profile -eta (1 - eta)/2 of a uniform slip, so the exact results for it are
   * the same.
   *
   * They share out a uniform traction differently between an edge's ends and its middle: `lagrange`
   * as the edge's own Simpson weights do (1/6, 1/6, 4/6), `serendipity` as 5/14, 5/14, 4/14 if
   * linear and thin. Where the layer is stiffer than a cell (beta/t > 1/edge length), equilibrium
   * with the cell then makes the serendipity layer's slip wavy: under a uniform traction 2 in the
   * middle and 0.4 at the ends in units in which uniform slip would be 6/7.
   */
  enum class SmmElement
  {
    serendipity, // 8 nodes, the paper's
    lagrange     // 9 nodes, the middle one with the tool
  };

  /// The entries of a tool's subsection Friction as they are read. The constants of a law have no
  /// default: a law that needs one says so.
  struct FrictionParameters
  {
    std::string    law = "none";
    OptionalNumber coefficient;                  // mu
    OptionalNumber factor;                       // m or f'
    double         regularisation_velocity = 0.; // mm/s
    OptionalNumber viscosity;                    // MPa (s/mm)^q
    double         exponent        = 1.;         // q
    double         layer_thickness = 0.;         // mm
    std::string    layer_viscosity = "layer";
    std::string    layer_element   = "lagrange";

    /// Declares the entries in the handler's current section; parsing fills the members.
    void declare(dealii::ParameterHandler &prm);

    /// All entries with their present values.
    EntryTexts entries() const;
  };

  /// What friction depends on at one point of the interface.
  struct FrictionPoint
  {
    double slip;     // velocity of the workpiece minus that of the tool, along the tangent [mm/s]
    double pressure; // contact pressure, >= 0 [MPa]
    double flow_stress;   // sigma of the workpiece [MPa]
    double previous_slip; // slip of the last accepted step [mm/s]
    bool   has_previous;  // false in the first step and at a point that touched nothing before
  };

  /// The traction has the sign of the slip: the force on the workpiece is -traction along the
  /// tangent.
  struct FrictionResponse
  {
    double traction;   // MPa
    double derivative; // d traction / d slip >= 0 [MPa s/mm]
    double secant; // traction / slip, its limit at slip 0 [MPa s/mm]; 0 for a prescribed traction
  };

  /**
   * The friction between the workpiece and one tool. With k = sigma/sqrt3 the shear yield stress, v
   * the slip and v0 the regularisation velocity:
   *
   *     coulomb             min(mu p, k) v/sqrt(v^2 + v0^2)
   *     shear               m k v/sqrt(v^2 + v0^2), potential m k (sqrt(v^2 + v0^2) - v0)
   *     arctan              m k (2/pi) atan(v/v0)        (Chen and Kobayashi 1978)
   *     tangential forces   m k w/sqrt(w^2 + v0^2), w the slip of the last accepted step; 0 before
   *                         there is one: a prescribed force, which doesn't answer to v
   *     norton              K v (v^2 + v0^2)^((q-1)/2), which is K |v|^q sign(v) for v0 -> 0
   *
   * Pressure and flow stress are data here: the derivative is by the slip alone. All tractions rise
   * with the slip, so each derives from a convex potential.
   */
  class Friction
  {
  public:
    /**
     * Checks the entries. Throws InputError for an unknown law, a constant out of range, an entry
     * that the law doesn't have, or an automatic value with nothing to take it from.
     *
     * @param section the section's name in messages: "Tool upper/Friction"
     * @param characteristic_speed speed of the process [mm/s]; the automatic regularisation
     * velocity is 1e-3 of it
     * @param characteristic_length the automatic layer thickness [mm]
     */
    Friction(const FrictionParameters &parameters,
             const std::string        &section,
             double                    characteristic_speed,
             double                    characteristic_length);

    FrictionKind kind() const;

    /// The traction of `coulomb`, `shear`, `arctan`, `tangential_forces`, `norton`; zero for
    /// `none`; that of `shear` with m = 1 for `sticking`. A programming error for `smm`.
    FrictionResponse evaluate(const FrictionPoint &point) const;

    /// The largest |traction| that the law allows [MPa]: 0 for `none`; infinite for `norton` and
    /// `smm`, which have no bound of their own.
    double cap(double pressure, double flow_stress) const;

    /// m of shear, arctan, tangential forces; f' of smm.
    double factor() const;

    /// f'/(1 - f') of smm.
    double beta() const;

    /// Thickness of the SMM layer [mm].
    double layer_thickness() const;

    /// Whether the SMM layer takes the viscosity of the adjacent cell.
    bool workpiece_viscosity() const;

    /// Which element the SMM layer is made of.
    SmmElement layer_element() const;

    /// v0 [mm/s]; 0 for laws that don't use it.
    double regularisation_velocity() const;

  private:
    FrictionKind law;
    double       coefficient_;
    double       factor_;
    double       viscosity_;
    double       exponent_;
    double       layer_thickness_;
    bool         workpiece_viscosity_;
    SmmElement   layer_element_;
    double       regularisation_velocity_;
  };

  /**
   * The primal-dual tangent [MPa s/mm] of a traction with a potential: d traction / d slip with one
   * of the two factors of the traction in its second term replaced by the traction stored at the
   * point. With stored = response.traction it is Newton's derivative, with stored = 0 Picard's
   * secant; the update is stored' = traction + tangent * (increment of the slip). Never negative.
   *
   *     secant + (derivative - secant) stored~/traction,   |stored~| <= cap
   */
  double primal_dual_tangent(const FrictionResponse &response, double stored, double cap);
} // namespace axiforge::laws
