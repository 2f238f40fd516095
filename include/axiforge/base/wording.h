// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace axiforge
{
  /**
   * The name of @p known that is most like @p wanted, for "did you mean": smallest number of
   * inserted, deleted, replaced or swapped neighbouring characters (optimal string alignment),
   * upper and lower case taken as equal. Empty if nothing is near: more than a third of the longer
   * name differs (two characters are always allowed in names of four and more).
   */
  std::string closest_name(const std::string &wanted, const std::vector<std::string> &known);

  /// `1 tool`, `2 tools`.
  std::string counted(std::size_t number, const std::string &noun);

  /// `"a", "b" or "c"`; empty for no names.
  std::string list_in_words(const std::vector<std::string> &names);

  /**
   * The description of a dealii::Patterns object, such as `[Double 0...1 (inclusive)]`, in plain
   * words: `a number from 0 to 1`. A pattern it does not know is given back as it is.
   */
  std::string pattern_in_words(const std::string &description);

  /// The names of a `[Selection a|b|c ]` or `[MultipleSelection a|b|c ]`; empty for any other
  /// pattern.
  std::vector<std::string> selection_of_pattern(const std::string &description);
} // namespace axiforge
