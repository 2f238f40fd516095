// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <regex>
#include <vector>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/text_file.h>

namespace axiforge
{
  namespace
  {
    /// A character that is easily taken for one of ASCII, which is given in words.
    struct LookAlike
    {
      unsigned int first, last;
      const char  *name;
      const char  *instead;
    };

    constexpr const char *blank = "an ordinary blank", *minus = "the minus sign - of the keyboard",
                         *quote = "the quotes \" of the keyboard", *nothing = "nothing there";

    const std::vector<LookAlike> look_alikes = {
      { 0x00A0, 0x00A0, "no-break space", blank },
      { 0x00AD, 0x00AD, "soft hyphen", nothing },
      { 0x02D7, 0x02D7, "modifier minus", minus },
      { 0x2000, 0x200A, "a wide or thin space", blank },
      { 0x200B, 0x200F, "an invisible character", nothing },
      { 0x2010, 0x2015, "hyphen or dash", minus },
      { 0x2018, 0x201F, "curly quote", quote },
      { 0x2028, 0x2029, "line separator", "an ordinary end of the line" },
      { 0x202A, 0x202E, "an invisible character", nothing },
      { 0x202F, 0x202F, "narrow no-break space", blank },
      { 0x205F, 0x205F, "a wide or thin space", blank },
      { 0x2060, 0x2064, "an invisible character", nothing },
      { 0x2212, 0x2212, "minus sign", minus },
      { 0x3000, 0x3000, "ideographic space", blank },
      { 0xFE58, 0xFE58, "small dash", minus },
      { 0xFE63, 0xFE63, "small minus", minus },
      { 0xFEFF, 0xFEFF, "byte order mark", nothing },
      { 0xFF01, 0xFF5E, "a full-width character", "the one of the keyboard" }
    };

    /// The character that begins at @p at, and its length in bytes; length 0 if it is no UTF-8.
    unsigned int character_at(const std::string &text, const std::size_t at, std::size_t &length)
    {
      const auto byte = [&](const std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
      };
      const unsigned int first = byte(at);
      length                   = first < 0x80   ? 1
                                 : first < 0xC2 ? 0
                                 : first < 0xE0 ? 2
                                 : first < 0xF0 ? 3
                                 : first < 0xF5 ? 4
                                                : 0;
      if (length <= 1)
        return first;
      unsigned int code = first & (0xFFu >> (length + 1));
      for (std::size_t i = 1; i < length; ++i)
        {
          if ((byte(at + i) & 0xC0u) != 0x80u)
            {
              length = 0;
              return first;
            }
          code = (code << 6) | (byte(at + i) & 0x3Fu);
        }
      return code;
    }

    [[noreturn]] void throw_encoding(const std::string &what, const std::string &encoding)
    {
      throw InputError(what + " is in " + encoding +
                       ", which is not read. Save it as UTF-8 (an editor's \"save as\", or iconv "
                       "-f " +
                       encoding + " -t UTF-8).");
    }
  } // namespace

  std::string plain_text(std::string contents, const std::string &what)
  {
    const auto begins = [&](const std::string &mark) {
      return contents.compare(0, mark.size(), mark) == 0;
    };
    if (begins("\xEF\xBB\xBF"))
      contents.erase(0, 3);
    else if (begins(std::string("\xFF\xFE\0\0", 4)) || begins(std::string("\0\0\xFE\xFF", 4)))
      throw_encoding(what, "UTF-32");
    else if (begins("\xFF\xFE") || begins("\xFE\xFF"))
      throw_encoding(what, "UTF-16");

    const std::size_t nul = contents.find('\0');
    if (nul != std::string::npos)
      {
        const std::size_t head  = std::min<std::size_t>(contents.size(), 400);
        const auto        n_nul = std::count(contents.begin(), contents.begin() + head, '\0');
        if (nul < 4 && 5 * n_nul > 2 * static_cast<long>(head))
          throw_encoding(what, 5 * n_nul > 3 * static_cast<long>(head) ? "UTF-32" : "UTF-16");
        throw InputError(fmt::format(
            "{} has a NUL byte in line {}: it is no text, or was damaged when it was written. "
            "Write it anew.",
            what, 1 + std::count(contents.begin(), contents.begin() + nul, '\n')));
      }

    std::string text;
    text.reserve(contents.size());
    for (std::size_t i = 0; i < contents.size(); ++i)
      if (contents[i] != '\r')
        text += contents[i];
      else
        {
          while (i + 1 < contents.size() && contents[i + 1] == '\r' &&
                 contents.find_first_not_of('\r', i + 1) != std::string::npos &&
                 contents[contents.find_first_not_of('\r', i + 1)] == '\n')
            ++i; // "\r\r\n" of files that were converted twice
          if (i + 1 >= contents.size() || contents[i + 1] != '\n')
            text += '\n';
        }
    return text;
  }

  std::string
  foreign_character(const std::string &text, const bool look_alikes_only, std::string &way_out)
  {
    std::size_t length = 1;
    for (std::size_t at = 0; at < text.size(); at += std::max<std::size_t>(length, 1))
      {
        const unsigned int code = character_at(text, at, length);
        if (length == 1)
          continue;
        if (length == 0) // Latin-1, most likely
          {
            if (look_alikes_only && code != 0xA0 && code != 0x96)
              continue;
            way_out = code == 0xA0   ? "Write an ordinary blank"
                      : code == 0x96 ? "Write the minus sign - of the keyboard"
                                     : "Save the file as UTF-8, or write ASCII there";
            return fmt::format("the byte 0x{:02X}, which is no UTF-8", code);
          }
        const auto known =
            std::find_if(look_alikes.begin(), look_alikes.end(),
                         [&](const LookAlike &a) { return code >= a.first && code <= a.last; });
        if (known == look_alikes.end() && look_alikes_only)
          continue;
        way_out = "Write " + std::string(known == look_alikes.end() ? "the one of the keyboard"
                                                                    : known->instead);
        return fmt::format("the character U+{:04X} ({})", code,
                           known == look_alikes.end()
                               ? "\"" + text.substr(at, length) + "\", which is not ASCII"
                               : std::string(known->name));
      }
    return "";
  }

  bool has_decimal_comma(const std::string &text)
  {
    static const std::regex number(R"(\s*[-+]?[0-9]*,[0-9]+([eE][-+]?[0-9]+)?\s*)");
    return std::regex_match(text, number);
  }
} // namespace axiforge
