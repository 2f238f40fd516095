// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace axiforge
{
  /**
   * The contents of a text file as lines that end in "\n": no byte order mark, and "\r\n" or a
   * lone "\r" (old spreadsheets) count as a line's end.
   *
   * @p what begins a message and names the file: `The file "x.csv"`.
   * Throws InputError for text in UTF-16 or UTF-32, and for a NUL byte, with its line.
   */
  std::string plain_text(std::string contents, const std::string &what);

  /**
   * The first character of @p text that is not ASCII, in words: `the character U+2212 (minus
   * sign)`. Empty if there is none.
   *
   * @param look_alikes_only pass over letters and signs that can't be taken for ASCII: only blanks,
   *   invisible characters, dashes and quotes count, that people do not see or mean.
   * @param way_out set to what to write instead, as a sentence
   */
  std::string
  foreign_character(const std::string &text, bool look_alikes_only, std::string &way_out);

  /// Whether @p text is a number with a decimal comma: "1,5", "-0,25e3".
  bool has_decimal_comma(const std::string &text);
} // namespace axiforge
