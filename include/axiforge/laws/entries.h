// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <axiforge/base/optional_number.h>

namespace axiforge::laws
{
  /// The entries of one section, each with its value as text, in the order of declaration.
  using EntryTexts = std::vector<std::pair<std::string, std::string>>;

  /**
   * Checks of a law's entries. Every check throws InputError naming the entry as
   * "<section>/<name>".
   */
  class EntryCheck
  {
  public:
    explicit EntryCheck(std::string section);

    /// Returns a value > 0 (and finite). @p way_out is the sentence that ends the message.
    double positive(const std::string &name, double value, const std::string &way_out = "") const;

    /// Returns a value in [lower, upper].
    double between(const std::string &name,
                   double             value,
                   double             lower,
                   double             upper,
                   const std::string &way_out = "") const;

    /// Returns the number, which must have been given. @p way_out is the sentence that ends the
    /// message.
    OptionalNumber needed(const std::string    &name,
                          const OptionalNumber &value,
                          const std::string    &way_out = "") const;

    /// Returns a value in [lower, upper).
    double below(const std::string &name,
                 double             value,
                 double             lower,
                 double             upper,
                 const std::string &way_out = "") const;

    /**
     * Entries that a law doesn't have must stand at their default: a value given there shows that
     * the user expects something else from the law than it does.
     *
     * @param choice what the message calls the law: "Model = hollomon"
     * @param used the entries that the law has
     * @param given, defaults all entries of the section, in the same order
     */
    void reject_unused(const std::string              &choice,
                       const std::vector<std::string> &used,
                       const EntryTexts               &given,
                       const EntryTexts               &defaults) const;

    /// The full name of an entry.
    std::string path(const std::string &name) const;

  private:
    std::string section;
  };

  /// The value of an entry as it is compared with its default; a number left out counts as 0.
  template <typename Value> std::string text_of(const Value &value)
  {
    if constexpr (std::is_same_v<Value, OptionalNumber>)
      return fmt::format("{}", double(value));
    else
      return fmt::format("{}", value);
  }

  /// The members `name` of a list of choices.
  template <typename List> std::vector<std::string> names_of(const List &choices)
  {
    std::vector<std::string> names;
    for (const auto &choice : choices)
      names.push_back(choice.name);
    return names;
  }

  /// The names as dealii::Patterns::Selection wants them: "a|b|c".
  template <typename List> std::string selection_of(const List &choices)
  {
    return fmt::format("{}", fmt::join(names_of(choices), "|"));
  }

  /// Throws the error of find_choice().
  [[noreturn]] void throw_unknown_choice(const std::string              &path,
                                         const std::string              &value,
                                         const std::vector<std::string> &known);

  /**
   * The element of the list @p choices whose member `name` is @p value; InputError with all names
   * if there is none.
   */
  template <typename List>
  const typename List::value_type &find_choice(const EntryCheck  &check,
                                               const std::string &entry,
                                               const std::string &value,
                                               const List        &choices)
  {
    for (const auto &choice : choices)
      if (choice.name == value)
        return choice;
    throw_unknown_choice(check.path(entry), value, names_of(choices));
  }
} // namespace axiforge::laws
