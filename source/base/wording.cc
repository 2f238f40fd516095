// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>

#include <deal.II/base/utilities.h>

#include <axiforge/base/wording.h>

namespace axiforge
{
  namespace
  {
    std::string lower_case(std::string text)
    {
      for (char &c : text)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      return text;
    }

    /// Optimal string alignment distance; a and b have any length.
    std::size_t edit_distance(const std::string &a, const std::string &b)
    {
      std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
      for (std::size_t j = 0; j <= b.size(); ++j)
        last[j] = j;
      for (std::size_t i = 1; i <= a.size(); ++i)
        {
          row[0] = i;
          for (std::size_t j = 1; j <= b.size(); ++j)
            {
              row[j] =
                  std::min({ last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1]) });
              if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
          before = last;
          last   = row;
        }
      return last[b.size()];
    }

    bool starts_with(const std::string &text, const std::string &start)
    {
      return text.compare(0, start.size(), start) == 0;
    }

    /// The text between the bracket that opens at @p open and the one that closes it.
    std::string bracketed(const std::string &text, const std::size_t open)
    {
      int depth = 0;
      for (std::size_t i = open; i < text.size(); ++i)
        {
          depth += text[i] == '<' ? 1 : (text[i] == '>' ? -1 : 0);
          if (depth == 0)
            return text.substr(open + 1, i - open - 1);
        }
      return "";
    }

    /// The two ends of `a...b`, which stands after the last blank before the dots.
    std::pair<std::string, std::string> ends_of_range(const std::string &text)
    {
      const std::size_t dots = text.rfind("...");
      if (dots == std::string::npos)
        return {};
      const std::size_t first = text.rfind(' ', dots) + 1;
      const std::size_t last  = text.find_first_of(" ]", dots + 3);
      return { text.substr(first, dots - first), text.substr(dots + 3, last - dots - 3) };
    }

    std::string number_in_words(const std::string &noun, const std::string &description)
    {
      auto [low, high] = ends_of_range(description);
      if (low == "-MAX_DOUBLE" || low == "-2147483648")
        low.clear();
      if (high == "MAX_DOUBLE" || high == "2147483647")
        high.clear();
      if (low.empty() && high.empty())
        return noun;
      if (high.empty())
        return noun + " not below " + low;
      if (low.empty())
        return noun + " not above " + high;
      return noun + " from " + low + " to " + high;
    }

    std::string list_pattern_in_words(const std::string &description)
    {
      const std::size_t open         = description.find('<');
      const std::string element      = bracketed(description, open);
      const std::string tail         = description.substr(open + element.size() + 2);
      const auto [low, high]         = ends_of_range(tail.substr(0, tail.find(" (inclusive)")));
      const std::size_t separator_at = tail.find("separated by <");
      const std::string separator =
          separator_at == std::string::npos ? "," : bracketed(tail, separator_at + 13);

      std::string count = "any number of";
      if (low == high && !low.empty())
        count = low;
      else if (high != "4294967295")
        count = low + " to " + high;
      else if (low != "0")
        count = "at least " + low;
      return "a list, separated by \"" + separator + "\", of " + count + " elements, each " +
             pattern_in_words(element);
    }
  } // namespace

  std::string closest_name(const std::string &wanted, const std::vector<std::string> &known)
  {
    const std::string lower_wanted = lower_case(wanted);
    std::string       best;
    std::size_t       best_distance = static_cast<std::size_t>(-1);
    for (const std::string &name : known)
      {
        const std::size_t longer   = std::max(wanted.size(), name.size());
        const std::size_t allowed  = std::max<std::size_t>(longer >= 4 ? 2 : 1, longer / 3);
        const std::size_t distance = edit_distance(lower_wanted, lower_case(name));
        if (distance <= allowed && distance < best_distance)
          {
            best          = name;
            best_distance = distance;
          }
      }
    return best;
  }

  std::string counted(const std::size_t number, const std::string &noun)
  {
    return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
  }

  std::string list_in_words(const std::vector<std::string> &names)
  {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
      {
        if (i > 0)
          text += i + 1 == names.size() ? " or " : ", ";
        text += "\"" + names[i] + "\"";
      }
    return text;
  }

  std::vector<std::string> selection_of_pattern(const std::string &description)
  {
    for (const std::string start : { "[Selection ", "[MultipleSelection " })
      if (starts_with(description, start))
        {
          const std::size_t end = description.rfind(']');
          return dealii::Utilities::split_string_list(
              description.substr(start.size(), end - start.size()), '|');
        }
    return {};
  }

  std::string pattern_in_words(const std::string &description)
  {
    const std::vector<std::string> choices = selection_of_pattern(description);
    if (!choices.empty())
      return starts_with(description, "[Selection")
                 ? list_in_words(choices)
                 : "any of " + list_in_words(choices) + ", separated by \",\"";
    if (starts_with(description, "[Integer"))
      return number_in_words("a whole number", description);
    if (starts_with(description, "[Double"))
      return number_in_words("a number", description);
    if (starts_with(description, "[Bool"))
      return "\"true\" or \"false\"";
    if (starts_with(description, "[List of <"))
      return list_pattern_in_words(description);
    if (starts_with(description, "[FileName"))
      return "the name of a file";
    if (starts_with(description, "[DirectoryName"))
      return "the name of a folder";
    if (starts_with(description, "[Anything"))
      return "any text";
    return description;
  }
} // namespace axiforge
