// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/base/errors.h>
#include <axiforge/base/wording.h>
#include <axiforge/laws/entries.h>

namespace axiforge::laws
{
  EntryCheck::EntryCheck(std::string section)
      : section(std::move(section))
  {
  }

  std::string EntryCheck::path(const std::string &name) const
  {
    return section + "/" + name;
  }

  double
  EntryCheck::positive(const std::string &name, double value, const std::string &way_out) const
  {
    if (value > 0. && std::isfinite(value))
      return value;
    const std::string wrong =
        value == 0. ? "it is needed here and must be positive" : "it must be positive";
    throw InputError::entry(path(name), fmt::format("{}", value), wrong, "> 0", way_out);
  }

  double EntryCheck::between(const std::string &name,
                             double             value,
                             double             lower,
                             double             upper,
                             const std::string &way_out) const
  {
    if (value >= lower && value <= upper && std::isfinite(value))
      return value;
    const std::string allowed = std::isfinite(upper) ? fmt::format("{} to {}", lower, upper)
                                                     : fmt::format("{} or more", lower);
    throw InputError::entry(path(name), fmt::format("{}", value), "it is out of range", allowed,
                            way_out);
  }

  OptionalNumber EntryCheck::needed(const std::string    &name,
                                    const OptionalNumber &value,
                                    const std::string    &way_out) const
  {
    if (value.given())
      return value;
    throw InputError::entry(path(name), "", "it is needed here and not given", "a number", way_out);
  }

  double EntryCheck::below(const std::string &name,
                           double             value,
                           double             lower,
                           double             upper,
                           const std::string &way_out) const
  {
    if (value >= lower && value < upper)
      return value;
    throw InputError::entry(path(name), fmt::format("{}", value), "it is out of range",
                            fmt::format("at least {} and less than {}", lower, upper), way_out);
  }

  void EntryCheck::reject_unused(const std::string              &choice,
                                 const std::vector<std::string> &used,
                                 const EntryTexts               &given,
                                 const EntryTexts               &defaults) const
  {
    for (std::size_t i = 0; i < given.size(); ++i)
      {
        const auto &[name, value] = given[i];
        if (value == defaults[i].second || std::find(used.begin(), used.end(), name) != used.end())
          continue;
        const std::string has =
            used.empty() ? "no further entries" : fmt::format("{}", fmt::join(used, ", "));
        throw InputError::entry(
            path(name), value, "it has no meaning with " + choice + ", which has " + has,
            defaults[i].second.empty() ? "leaving it empty" : "its default " + defaults[i].second,
            "Remove the entry, or choose a law that has it");
      }
  }

  void throw_unknown_choice(const std::string              &path,
                            const std::string              &value,
                            const std::vector<std::string> &known)
  {
    const std::string nearest = closest_name(value, known);
    throw InputError::entry(path, value, "there is no such choice", list_in_words(known),
                            nearest.empty() ? "" : "Did you mean \"" + nearest + "\"?");
  }
} // namespace axiforge::laws
