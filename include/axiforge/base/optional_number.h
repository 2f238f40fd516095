// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <string>

#include <deal.II/base/patterns.h>

namespace axiforge
{
  /**
   * The number of an entry that has no default: it knows whether it was given. Left out it is 0,
   * and an empty text in the `.prm`. For the constants of a law that no value is a good guess for,
   * where 0 has a meaning of its own (no friction) and so can't stand for "not given".
   */
  class OptionalNumber
  {
  public:
    OptionalNumber() = default;

    OptionalNumber(const double value) // NOLINT: a number is one
        : value(value)
        , given_(true)
    {
    }

    operator double() const // NOLINT
    {
      return value;
    }

    bool given() const
    {
      return given_;
    }

  private:
    double value  = 0;
    bool   given_ = false;
  };

  /// A number or nothing.
  class OptionalDouble : public dealii::Patterns::Double
  {
  public:
    using Double::Double;

    bool match(const std::string &text) const override
    {
      return text.empty() || Double::match(text);
    }

    std::unique_ptr<PatternBase> clone() const override
    {
      return std::make_unique<OptionalDouble>();
    }
  };
} // namespace axiforge

namespace dealii::Patterns::Tools
{
  template <> struct Convert<axiforge::OptionalNumber, void>
  {
    static std::unique_ptr<PatternBase> to_pattern()
    {
      return std::make_unique<axiforge::OptionalDouble>();
    }

    static std::string to_string(const axiforge::OptionalNumber &number,
                                 const PatternBase & = *to_pattern())
    {
      return number.given() ? Convert<double>::to_string(number) : "";
    }

    static axiforge::OptionalNumber to_value(const std::string &text,
                                             const PatternBase & = *to_pattern())
    {
      return text.empty() ? axiforge::OptionalNumber()
                          : axiforge::OptionalNumber(Convert<double>::to_value(text));
    }
  };
} // namespace dealii::Patterns::Tools
