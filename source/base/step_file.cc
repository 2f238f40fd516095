// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/step_file.h>

namespace axiforge
{
  namespace
  {
    /// The file without comments, texts and white space.
    std::string code_of(const std::string &file)
    {
      std::ifstream     in(file, std::ios::binary);
      const std::string text{ std::istreambuf_iterator<char>(in),
                              std::istreambuf_iterator<char>() };
      std::string       code;
      for (std::size_t i = 0; i < text.size();)
        if (text.compare(i, 2, "/*") == 0)
          i = std::min(text.find("*/", i + 2), text.size() - 2) + 2;
        else if (text[i] == '\'')
          i = std::min(text.find('\'', i + 1), text.size() - 1) + 1;
        else if (std::isspace(static_cast<unsigned char>(text[i])))
          ++i;
        else
          code += text[i++];
      return code;
    }

    InputError damaged(const std::string &file, const std::string &entry, const std::string &what)
    {
      return InputError::entry(entry, file, what + ": it is damaged", "",
                               "Export it anew from the CAD program");
    }
  } // namespace

  void check_step_text(const std::string &file, const std::string &entry)
  {
    const std::string code = code_of(file);
    if (code.compare(0, 13, "ISO-10303-21;") != 0)
      return; // no STEP file at all: its reader says so
    if (code.find("END-ISO-10303-21;") == std::string::npos)
      throw damaged(file, entry, "its end (\"END-ISO-10303-21;\") is missing");

    std::set<unsigned long> defined, used;
    for (std::size_t at = code.find('#'); at != std::string::npos; at = code.find('#', at + 1))
      {
        const char         *begin  = code.c_str() + at + 1;
        char               *end    = nullptr;
        const unsigned long number = std::strtoul(begin, &end, 10);
        if (end == begin)
          continue;
        (*end == '=' && (at == 0 || code[at - 1] == ';') ? defined : used).insert(number);
      }
    for (const unsigned long number : used)
      if (defined.count(number) == 0)
        throw damaged(file, entry,
                      fmt::format("it refers to the entity #{}, which it does not have", number));
  }

  void
  check_step_curves(const std::string &file, const std::string &entry, const std::size_t n_curves)
  {
    const std::string code    = code_of(file);
    std::size_t       n_edges = 0;
    for (std::size_t at = code.find("=EDGE_CURVE("); at != std::string::npos;
         at             = code.find("=EDGE_CURVE(", at + 1))
      ++n_edges;
    if (n_curves < n_edges)
      throw damaged(
          file, entry,
          fmt::format("{} of its {} edges could not be read", n_edges - n_curves, n_edges));
  }
} // namespace axiforge
