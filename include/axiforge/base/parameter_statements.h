// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace axiforge
{
  enum class Keyword
  {
    subsection,
    end,
    set
  };

  /// One statement of a `.prm` file.
  struct Statement
  {
    Keyword     keyword;
    std::string name;   ///< of the section or the entry; empty for `end`
    std::string value;  ///< of the entry
    std::string origin; ///< "file:line", or the override it comes from
    /// Name of the one element of the entry's list "a = 1, b = 2" that is set; empty: the whole.
    std::string key = {};
  };

  /**
   * The statements of the `.prm` file @p path and of the files it includes, in their order; see
   * ParameterFile for the language. @p text becomes the file byte by byte.
   *
   * Names of files (entries "... file") may be quoted. A relative one counts from the folder of the
   * file that says it, and is given back relative to the folder of @p path; where there is nothing
   * of that name, but beside @p path there is, that is meant.
   *
   * Throws InputError if a file can't be read, is no text, includes itself or without end, if a
   * line is no statement, if subsections are not balanced, or if a file gives an entry twice with
   * two values. Including and included file may give an entry both.
   */
  std::vector<Statement> read_statements(const std::string &path, std::string &text);

  /**
   * The statements of an override "Section/Sub section/Entry = value", also of one element of a
   * list: "Workpiece/Geometry parameters/Height = 20". Throws InputError if it is malformed.
   */
  std::vector<Statement> statements_of_override(const std::string &text);

  /// @p text without white space at both ends.
  std::string without_blanks(const std::string &text);

  /// The rest of @p line behind @p keyword (given in lower case, also accepted in upper case).
  bool take_keyword(const std::string &line, const std::string &keyword, std::string &rest);

  /// Whether an entry of this name names a file.
  bool names_file(const std::string &entry);
} // namespace axiforge
