// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace axiforge
{
  /**
   * A table of numbers as read from a CSV file. Every row has `columns()` numbers.
   */
  struct CsvTable
  {
    std::string                      file;
    std::vector<std::string>         header; ///< column names, empty if the file has no header line
    std::vector<std::vector<double>> rows;
    std::vector<unsigned int>        lines; ///< line number in the file of each row, from 1

    /// Number of columns; 0 for an empty table.
    unsigned int columns() const;

    /// `"file", line n` of a row, for messages.
    std::string where(unsigned int row) const;

    /// Index of a column by its header, or -1.
    int find_column(const std::string &name) const;
  };

  /**
   * Read a table: numbers separated by commas (or semicolons, or blanks), a decimal point whatever
   * the locale, `#` starts a comment, empty lines are skipped. The first line may be a header: it
   * counts as one if its first entry is not a number.
   *
   * Throws InputError with the file and the line for a missing file, an entry that is not a finite
   * number, rows of different length, fewer than @p min_rows rows.
   * @p entry is the path of the parameter that names the file.
   */
  CsvTable read_csv(const std::string &file, const std::string &entry, unsigned int min_rows = 1);

  /// Read all of @p text as one finite number. Returns whether that was possible.
  bool parse_number(std::string_view text, double &value);

  /// @p text without white space at both ends.
  std::string_view trim(std::string_view text);
} // namespace axiforge
