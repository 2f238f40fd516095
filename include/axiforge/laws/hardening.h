// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>
#include <variant>

namespace axiforge::laws
{
  /// A function of one variable at one point.
  struct ValueAndSlope
  {
    double value;
    double slope;
  };

  // Hardening laws: the flow stress [MPa] at the reference strain rate as a function of the
  // effective strain >= 0. Each is its constants plus one function; nothing is checked here
  // (Material does).

  /// sigma0, whatever the strain.
  struct ConstantStress
  {
    double stress; // MPa

    ValueAndSlope operator()(double) const
    {
      return { stress, 0. };
    }
  };

  /**
   * Hollomon: K eps^n, 0 <= n < 1. Below the smallest strain eps_s the tangent at eps_s takes over,
   * so that the stress at strain 0 is K eps_s^n (1 - n) > 0 and the slope stays finite.
   */
  struct Hollomon
  {
    double strength; // K [MPa]
    double exponent; // n
    double smallest; // eps_s

    ValueAndSlope operator()(const double strain) const
    {
      const double base  = std::fmax(strain, smallest);
      const double value = strength * std::pow(base, exponent);
      const double slope = exponent * value / base;
      return { value + slope * (strain - base), slope };
    }
  };

  /**
   * Ludwik: sigma0 + K eps^n, 0 <= n <= 1. Below the smallest strain eps_s the parabola through
   * (0, sigma0) takes over that has the law's value and slope at eps_s: the stress at strain 0 is
   * sigma0 exactly, and the slope there is (2 - n) K eps_s^(n-1).
   */
  struct Ludwik
  {
    double yield;    // sigma0 [MPa]
    double strength; // K [MPa]
    double exponent; // n
    double smallest; // eps_s

    ValueAndSlope operator()(const double strain) const
    {
      const double base  = std::fmax(strain, smallest);
      const double power = strength * std::pow(base, exponent);
      if (strain >= smallest)
        return { yield + power, exponent * power / base };
      const double x = strain / base;
      return { yield + power * x * ((2. - exponent) - (1. - exponent) * x),
               power / base * ((2. - exponent) - 2. * (1. - exponent) * x) };
    }
  };

  /// Swift: K (eps0 + eps)^n.
  struct Swift
  {
    double strength;  // K [MPa]
    double exponent;  // n
    double prestrain; // eps0

    ValueAndSlope operator()(const double strain) const
    {
      const double value = strength * std::pow(prestrain + strain, exponent);
      return { value, exponent * value / (prestrain + strain) };
    }
  };

  /// Voce: sigma_sat - (sigma_sat - sigma0) exp(-eps/eps_c).
  struct Voce
  {
    double yield;                 // sigma0 [MPa]
    double saturation;            // sigma_sat [MPa]
    double characteristic_strain; // eps_c

    ValueAndSlope operator()(const double strain) const
    {
      const double rest = (saturation - yield) * std::exp(-strain / characteristic_strain);
      return { saturation - rest, rest / characteristic_strain };
    }
  };

  using Hardening = std::variant<ConstantStress, Hollomon, Ludwik, Swift, Voce>;
} // namespace axiforge::laws
