// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/text_file.h>

namespace axiforge
{
  namespace
  {
    /// @p entry without the quotes around it.
    std::string_view unquoted(std::string_view entry)
    {
      entry = trim(entry);
      if (entry.size() > 1 && entry.front() == '"' && entry.back() == '"')
        entry = trim(entry.substr(1, entry.size() - 2));
      return entry;
    }

    /**
     * The entries of a line. @p separator as the file says it in a line "sep=;"; 0: found out.
     * Separators at the end of the line, which spreadsheets leave there, are passed over.
     */
    std::vector<std::string_view> split(const std::string_view line, char separator)
    {
      bool quoted = false, commas = false, semicolons = false, tabs = false;
      for (const char c : line)
        {
          quoted ^= c == '"';
          commas |= !quoted && c == ',';
          semicolons |= !quoted && c == ';';
          tabs |= !quoted && c == '\t';
        }
      if (separator == 0)
        separator = semicolons ? ';' : commas ? ',' : tabs ? '\t' : ' ';

      std::vector<std::string_view> entries;
      std::size_t                   begin = 0;
      quoted                              = false;
      for (std::size_t i = 0; i <= line.size(); ++i)
        {
          if (i < line.size() && line[i] == '"')
            quoted = !quoted;
          if (i < line.size() &&
              (quoted || (line[i] != separator && !(separator == ' ' && line[i] == '\t'))))
            continue;
          const std::string_view entry = unquoted(line.substr(begin, i - begin));
          if (!entry.empty() || (separator != ' ' && separator != '\t'))
            entries.push_back(entry);
          begin = i + 1;
        }
      while (!entries.empty() && entries.back().empty())
        entries.pop_back();
      return entries;
    }

    std::string contents_of(const std::string &file, const std::string &entry)
    {
      std::error_code    ignored;
      std::ifstream      in(file, std::ios::binary);
      std::ostringstream text;
      if (!std::filesystem::is_directory(file, ignored) && in && in.peek() != EOF)
        text << in.rdbuf();
      if (!in.is_open() || in.bad() || std::filesystem::is_directory(file, ignored))
        throw InputError::entry(entry, file, "this file can't be opened", "a CSV table of numbers",
                                "A relative path counts from the folder of the parameter file");
      return plain_text(text.str(), fmt::format("Entry \"{}\": the file \"{}\"", entry, file));
    }

    /// The separator of a spreadsheet's first line "sep=;"; 0 if it is another line.
    char separator_of(const std::string_view line)
    {
      const std::string_view text = unquoted(line);
      const bool             says = text.substr(0, 4) == "sep=" || text.substr(0, 4) == "SEP=";
      if (!says)
        return 0;
      const std::string_view full = line.substr(line.find('=') + 1);
      return full.empty() ? '\t' : full.front();
    }

    std::string decimal_comma_way_out(const std::string_view text)
    {
      return has_decimal_comma(std::string(text)) ? "The decimal sign is a point" : "";
    }

    std::vector<double> numbers_of(const CsvTable                      &table,
                                   const std::vector<std::string_view> &entries,
                                   const unsigned int                   line,
                                   const std::string                   &entry)
    {
      if (table.columns() > 0 && entries.size() != table.columns())
        throw InputError::entry(entry, table.file,
                                fmt::format("line {} has {} entries where {} were expected", line,
                                            entries.size(), table.columns()),
                                "the same number of entries in every line",
                                entries.size() > table.columns()
                                    ? "Are there commas in the numbers? The decimal sign is a point"
                                    : "");
      std::vector<double> row;
      for (const std::string_view &text : entries)
        {
          double      number = 0;
          std::string way_out;
          if (!parse_number(text, number))
            {
              const std::string foreign = foreign_character(std::string(text), false, way_out);
              throw InputError::entry(
                  entry, table.file,
                  fmt::format("\"{}\" in line {} is not a number{}", text, line,
                              foreign.empty() ? "" : ": it has " + foreign),
                  "finite numbers with a decimal point, separated by commas; # starts a comment",
                  foreign.empty() ? decimal_comma_way_out(text) : way_out);
            }
          row.push_back(number);
        }
      return row;
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
    CsvTable table;
    table.file = file;

    std::istringstream in(contents_of(file, entry));
    std::string        line;
    unsigned int       line_number = 0;
    char               separator   = 0;
    while (std::getline(in, line))
      {
        ++line_number;
        const std::string_view text = trim(std::string_view(line).substr(0, line.find('#')));
        if (line_number == 1 && separator_of(line) != 0)
          {
            separator = separator_of(line);
            continue;
          }
        const std::vector<std::string_view> entries = split(text, separator);
        if (entries.empty())
          continue;

        double number = 0;
        if (table.rows.empty() && table.header.empty() && !parse_number(entries[0], number) &&
            !has_decimal_comma(std::string(entries[0])))
          {
            table.header.assign(entries.begin(), entries.end());
            continue;
          }
        table.rows.push_back(numbers_of(table, entries, line_number, entry));
        table.lines.push_back(line_number);
      }

    if (table.rows.size() < min_rows)
      throw InputError::entry(entry, file,
                              fmt::format("the table has {} row(s)", table.rows.size()),
                              fmt::format("at least {} row(s) of numbers", min_rows));
    return table;
  }
} // namespace axiforge
