// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>

namespace axiforge
{
  namespace
  {
    std::vector<std::string_view> split(const std::string_view line)
    {
      const bool semicolons = line.find(';') != std::string_view::npos;
      const bool commas     = line.find(',') != std::string_view::npos;

      std::vector<std::string_view> entries;
      if (semicolons || commas)
        {
          const char  separator = semicolons ? ';' : ',';
          std::size_t begin     = 0;
          while (true)
            {
              const std::size_t end = line.find(separator, begin);
              entries.push_back(trim(line.substr(begin, end - begin)));
              if (end == std::string_view::npos)
                return entries;
              begin = end + 1;
            }
        }

      std::size_t begin = line.find_first_not_of(" \t");
      while (begin != std::string_view::npos)
        {
          const std::size_t end = line.find_first_of(" \t", begin);
          entries.push_back(line.substr(begin, end - begin));
          begin = end == std::string_view::npos ? end : line.find_first_not_of(" \t", end);
        }
      return entries;
    }
  } // namespace

  std::string_view trim(const std::string_view text)
  {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos)
      return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
  }

  bool parse_number(std::string_view text, double &value)
  {
    text = trim(text);
    if (text.size() > 1 && text[0] == '+' && text[1] != '-')
      text.remove_prefix(1);
    const char *const end          = text.data() + text.size();
    const auto [stopped_at, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && stopped_at == end && std::isfinite(value);
  }

  unsigned int CsvTable::columns() const
  {
    return rows.empty() ? header.size() : rows.front().size();
  }

  std::string CsvTable::where(const unsigned int row) const
  {
    return fmt::format("\"{}\", line {}", file, lines[row]);
  }

  int CsvTable::find_column(const std::string &name) const
  {
    const auto column = std::find(header.begin(), header.end(), name);
    return column == header.end() ? -1 : static_cast<int>(column - header.begin());
  }

  CsvTable read_csv(const std::string &file, const std::string &entry, const unsigned int min_rows)
  {
    std::ifstream in(file);
    if (!in)
      throw InputError::entry(entry, file, "this file can't be opened", "a CSV table of numbers",
                              "A relative path counts from the folder of the parameter file");

    CsvTable table;
    table.file = file;

    std::string  line;
    unsigned int line_number = 0;
    while (std::getline(in, line))
      {
        ++line_number;
        std::string_view text = line;
        if (line_number == 1 &&
            text.substr(0, 3) == "\xEF\xBB\xBF") // the mark spreadsheets put there
          text.remove_prefix(3);
        text = trim(text.substr(0, text.find('#')));
        if (text.empty())
          continue;

        const std::vector<std::string_view> entries = split(text);

        double number = 0;
        if (table.rows.empty() && table.header.empty() && !parse_number(entries[0], number))
          {
            table.header.assign(entries.begin(), entries.end());
            continue;
          }

        if (table.columns() > 0 && entries.size() != table.columns())
          throw InputError::entry(entry, file,
                                  fmt::format("line {} has {} entries where {} were expected",
                                              line_number, entries.size(), table.columns()),
                                  "the same number of entries in every line");

        std::vector<double> row;
        for (const std::string_view &number_text : entries)
          {
            if (!parse_number(number_text, number))
              throw InputError::entry(
                  entry, file,
                  fmt::format("\"{}\" in line {} is not a number", number_text, line_number),
                  "finite numbers with a decimal point, separated by commas; # starts a comment");
            row.push_back(number);
          }
        table.rows.push_back(std::move(row));
        table.lines.push_back(line_number);
      }

    if (table.rows.size() < min_rows)
      throw InputError::entry(entry, file,
                              fmt::format("the table has {} row(s)", table.rows.size()),
                              fmt::format("at least {} row(s) of numbers", min_rows));
    return table;
  }
} // namespace axiforge
