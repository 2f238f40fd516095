// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>
#include <variant>

#include <axiforge/laws/hardening.h>

namespace axiforge::laws
{
  // Rate laws: the factor by which the flow stress changes with the effective strain rate > 0
  // [1/s], and its slope [s]. All rise monotonically and have d log(factor)/d log(rate) in [0, 1],
  // so that the dissipation potential is convex and the viscosity falls with the rate.

  /// Factor 1.
  struct RateIndependent
  {
    ValueAndSlope operator()(double) const
    {
      return { 1., 0. };
    }
  };

  /// (epsdot/epsdot0)^m: 1 at the reference rate, 0 at rest.
  struct PowerRate
  {
    double exponent;  // m
    double reference; // epsdot0 [1/s]

    ValueAndSlope operator()(const double rate) const
    {
      const double value = std::pow(rate / reference, exponent);
      return { value, exponent * value / rate };
    }
  };

  /// 1 + (epsdot/gamma)^m, Perzyna's overstress in Cowper and Symonds' form: 1 at rest, 2 at gamma.
  struct CowperSymonds
  {
    double exponent;  // m
    double reference; // gamma [1/s]

    ValueAndSlope operator()(const double rate) const
    {
      const double over = std::pow(rate / reference, exponent);
      return { 1. + over, exponent * over / rate };
    }
  };

  /**
   * Johnson and Cook's 1 + C ln(epsdot/epsdot0): 1 at the reference rate. The logarithm has no
   * lower bound; where the factor has fallen to f_c = 1/2 at the rate epsdot_c = epsdot0
   * exp(-1/(2C)), it goes on as f_c^2/(f_c - C ln(epsdot/epsdot_c)), which has the same value and
   * slope there and stays positive. For C <= 0.05 that is below exp(-10) epsdot0.
   */
  struct JohnsonCook
  {
    JohnsonCook(const double coefficient, const double reference)
        : coefficient(coefficient)
        , reference(reference)
        , lowest(reference * std::exp(-0.5 / coefficient))
    {
    }

    ValueAndSlope operator()(const double rate) const
    {
      if (rate >= lowest)
        return { 1. + coefficient * std::log(rate / reference), coefficient / rate };
      const double rest = 0.5 - coefficient * std::log(rate / lowest);
      return { 0.25 / rest, 0.25 * coefficient / (rate * rest * rest) };
    }

  private:
    double coefficient; // C
    double reference;   // epsdot0 [1/s]
    double lowest;      // epsdot_c [1/s]
  };

  using RateSensitivity = std::variant<RateIndependent, PowerRate, CowperSymonds, JohnsonCook>;
} // namespace axiforge::laws
