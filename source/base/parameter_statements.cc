// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/base/parameter_statements.h>
#include <axiforge/base/text_file.h>

namespace axiforge
{
  namespace
  {
    namespace fs = std::filesystem;

    // Beyond these a scene is none, and an include without end is noticed before the memory is.
    constexpr std::size_t most_bytes = 32 << 20; ///< of all files together
    constexpr std::size_t most_depth = 50;       ///< of files that include files
    constexpr std::size_t most_files = 2000;

    constexpr const char *lines_there_are =
        " A line is \"subsection NAME\", \"set NAME = VALUE\", \"end\", \"include FILE\" or a "
        "comment that begins with #.";

    std::string without_quotes(const std::string &text)
    {
      if (text.size() > 1 && text.front() == '"' && text.back() == '"')
        return without_blanks(text.substr(1, text.size() - 2));
      return text;
    }

    std::string contents_of(const std::string &path, const std::string &whence)
    {
      std::error_code       ignored;
      const fs::file_status status = fs::status(path, ignored);
      if (fs::is_directory(status))
        throw InputError(whence + "\"" + path + "\" is a folder, not a parameter file.");
      if (fs::is_character_file(status) || fs::is_block_file(status))
        throw InputError(whence + "\"" + path + "\" is a device, not a parameter file.");
      errno = 0;
      std::ifstream in(path, std::ios::binary);
      std::string   text;
      char          block[1 << 14];
      while (in && text.size() <= most_bytes)
        {
          in.read(block, sizeof(block));
          text.append(block, in.gcount());
        }
      if (!in.is_open() || in.bad())
        throw InputError(whence + "Cannot read the parameter file \"" + path +
                         "\": " + (errno != 0 ? std::strerror(errno) : "unknown error") +
                         ". Check its name, and the folder it is looked for in.");
      if (text.size() > most_bytes)
        throw InputError(whence + "\"" + path +
                         "\" is larger than 32 MB: it is no parameter file. Check its name.");
      return text;
    }

    /// What a name or a value must not have, because nobody sees that it isn't what it looks like.
    void check_characters(const std::string &text,
                          const bool         look_alikes_only,
                          const std::string &origin)
    {
      std::string       way_out;
      const std::string found = foreign_character(text, look_alikes_only, way_out);
      if (!found.empty())
        throw InputError(origin + ": \"" + text + "\" has " + found + ". " + way_out + ".");
    }

    /// Prose and names of files may have any characters.
    bool is_free_text(const std::string &entry)
    {
      return entry == "Title" || entry == "Directory" || names_file(entry);
    }

    /// Reads a file and those that it includes.
    class StatementReader
    {
    public:
      std::vector<Statement> statements;

      void read_file(const std::string &path, const std::string &contents);

    private:
      /// What has been said of an entry.
      struct Given
      {
        std::string  value, origin;
        unsigned int file; ///< number of the reading of the file
      };

      void        read_line(const std::string      &line,
                            const std::string      &path,
                            const std::string      &origin,
                            std::vector<Statement> &open_sections);
      void        read_entry(const std::string &line,
                             const std::string &rest,
                             const std::string &path,
                             const std::string &origin);
      void        include(std::string name, const std::string &path, const std::string &origin);
      void        check_repeated(const Statement &entry);
      std::string seen_from_outside(const std::string &file, const std::string &path) const;

      std::vector<std::string>     open_files;
      std::vector<unsigned int>    open_numbers;
      std::vector<std::string>     sections; ///< that are open, of all files
      std::map<std::string, Given> given;
      std::size_t                  n_files = 0, n_bytes = 0;
    };

    void StatementReader::read_file(const std::string &path, const std::string &contents)
    {
      n_bytes += contents.size();
      if (++n_files > most_files || n_bytes > most_bytes || open_files.size() >= most_depth)
        throw InputError(fmt::format(
            "The file \"{}\" is included as number {} and at depth {}, {:.0f} MB in all: "
            "the includes have no end. Take out the \"include\" lines that repeat themselves.",
            path, n_files, open_files.size(), n_bytes / 1048576.));
      const std::string text = plain_text(contents, "The file \"" + path + "\"");
      open_files.push_back(path);
      open_numbers.push_back(n_files);

      std::vector<Statement> open_sections;
      std::istringstream     in(text);
      std::string            line, whole;
      unsigned int           number = 0, first_number = 0;
      while (std::getline(in, line))
        {
          ++number;
          line = without_blanks(line);
          if (whole.empty())
            first_number = number;
          const std::size_t comment   = line.find('#');
          const bool        backslash = !line.empty() && line.back() == '\\';
          if (backslash && comment != std::string::npos &&
              in.peek() != std::istream::traits_type::eof())
            note(fmt::format("{}:{}: The comment ends in a backslash, which does not join the next "
                             "line to it: that is read as a line of its own.",
                             path, number));
          else if (backslash && in.peek() != std::istream::traits_type::eof())
            {
              whole += line.substr(0, line.size() - 1);
              continue;
            }
          whole += backslash ? line.substr(0, line.size() - 1) : line;
          read_line(without_blanks(whole.substr(0, whole.find('#'))), path,
                    path + ":" + std::to_string(first_number), open_sections);
          whole.clear();
        }
      if (!open_sections.empty())
        throw InputError(
            open_sections.back().origin + ": Section \"" + open_sections.back().name +
            "\" is opened here and never closed. Add a line \"end\" behind its last entry.");
      open_files.pop_back();
      open_numbers.pop_back();
    }

    void StatementReader::read_line(const std::string      &line,
                                    const std::string      &path,
                                    const std::string      &origin,
                                    std::vector<Statement> &open_sections)
    {
      std::string rest;
      if (line.empty())
        return;
      if (take_keyword(line, "subsection", rest))
        {
          check_characters(line, false, origin);
          if (rest.empty())
            throw InputError(origin +
                             ": \"subsection\" without a name. Write \"subsection NAME\".");
          statements.push_back({ Keyword::subsection, rest, "", origin });
          open_sections.push_back(statements.back());
          sections.push_back(rest);
        }
      else if (take_keyword(line, "end", rest))
        {
          if (!rest.empty())
            throw InputError(origin + ": Text behind \"end\": \"" + rest +
                             "\". Let \"end\" stand alone in its line.");
          if (open_sections.empty())
            throw InputError(origin + ": \"end\" without an open section. Take it out, or find the "
                                      "\"subsection\" line that is missing above.");
          open_sections.pop_back();
          sections.pop_back();
          statements.push_back({ Keyword::end, "", "", origin });
        }
      else if (take_keyword(line, "set", rest))
        read_entry(line, rest, path, origin);
      else if (take_keyword(line, "include", rest))
        include(rest, path, origin);
      else
        {
          check_characters(line, false, origin);
          throw InputError(origin + ": Cannot read \"" + line + "\"." + lines_there_are);
        }
    }

    void StatementReader::read_entry(const std::string &line,
                                     const std::string &rest,
                                     const std::string &path,
                                     const std::string &origin)
    {
      const std::size_t equals = rest.find('=');
      const std::string name   = without_blanks(rest.substr(0, equals));
      check_characters(name, false, origin);
      if (equals == std::string::npos || name.empty())
        throw InputError(origin + ": Cannot read \"" + line + "\". Write \"set NAME = VALUE\".");
      std::string value = without_blanks(rest.substr(equals + 1));
      if (!is_free_text(name))
        check_characters(value, true, origin);
      if (names_file(name))
        value = seen_from_outside(without_quotes(value), path);
      statements.push_back({ Keyword::set, name, value, origin });
      check_repeated(statements.back());
    }

    void
    StatementReader::include(std::string name, const std::string &path, const std::string &origin)
    {
      name = without_quotes(name);
      if (name.empty())
        throw InputError(origin +
                         ": \"include\" without the name of a file. Write \"include FILE\", "
                         "relative to the folder of this file.");
      const fs::path  included = fs::path(path).parent_path() / name;
      std::error_code ignored;
      for (const std::string &open : open_files)
        if (fs::weakly_canonical(open, ignored) == fs::weakly_canonical(included, ignored) ||
            fs::equivalent(open, included, ignored))
          throw InputError(origin + ": The file \"" + included.string() +
                           "\" includes itself, directly or through others. Take out one of the "
                           "\"include\" lines.");
      const std::string whence = "Included by \"" + open_files.back() + "\": ";
      read_file(included.string(), contents_of(included.string(), whence));
    }

    /// Two values of an entry in one file: one of them does nothing, and which one is not seen.
    void StatementReader::check_repeated(const Statement &entry)
    {
      std::string path;
      for (const std::string &section : sections)
        path += section + "/";
      path += entry.name;
      const unsigned int here  = open_numbers.back();
      const auto         found = given.find(path);
      if (found != given.end() && found->second.value != entry.value)
        {
          const Given &before = found->second;
          if (before.file == here)
            throw InputError(
                entry.origin + ": " +
                InputError::entry(path, entry.value,
                                  "it is given twice, with \"" + before.value + "\" at " +
                                      before.origin,
                                  "one value in a file",
                                  "Take one of the two lines out; a scene that includes another "
                                  "may change its entries, and so may --set")
                    .what());
          if (std::find(open_numbers.begin(), open_numbers.end(), before.file) !=
              open_numbers.end())
            note(fmt::format("Entry \"{}\" = \"{}\" at {} is replaced by \"{}\" of the file "
                             "included further down, at {}. Put the \"include\" line first to "
                             "change an entry.",
                             path, before.value, before.origin, entry.value, entry.origin));
        }
      given[path] = { entry.value, entry.origin, here };
    }

    std::string StatementReader::seen_from_outside(const std::string &file,
                                                   const std::string &path) const
    {
      const auto folder_of = [](const std::string &name) {
        std::error_code ignored;
        return fs::absolute(fs::path(name), ignored).lexically_normal().parent_path();
      };
      const fs::path outer = folder_of(open_files.front()), own = folder_of(path);
      if (file.empty() || fs::path(file).is_absolute() || own == outer)
        return file;
      std::error_code ignored;
      if (!fs::exists(own / file, ignored) && fs::exists(outer / file, ignored))
        return file;
      return (own / file).lexically_normal().lexically_relative(outer).string();
    }
  } // namespace

  std::vector<Statement> read_statements(const std::string &path, std::string &text)
  {
    StatementReader reader;
    text = contents_of(path, "");
    reader.read_file(path, text);
    return std::move(reader.statements);
  }

  std::vector<Statement> statements_of_override(const std::string &text)
  {
    const std::string origin = "--set \"" + text + "\"";
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      throw InputError(origin + ": No \"=\" in it. Write --set \"Section/Entry = value\".");
    if (text.find_first_of("#\n") != std::string::npos)
      throw InputError(origin + ": \"#\" and line breaks are not allowed in it. Write --set "
                                "\"Section/Entry = value\".");

    std::vector<std::string> names;
    std::istringstream       parts(text.substr(0, equals) + "/");
    std::string              part;
    while (std::getline(parts, part, '/'))
      names.push_back(without_blanks(part));
    for (const std::string &name : names)
      {
        check_characters(name, false, "--set");
        if (name.empty())
          throw InputError(origin + ": The name of a section or of the entry is empty. Write --set "
                                    "\"Section/Entry = value\".");
      }
    // A parameter of a .geo may have "/" in its name.
    const auto  list = std::find(names.begin() + 1, names.end(), "Geometry parameters");
    std::string key;
    if (names.size() > 2 && list != names.end() && list + 1 != names.end())
      {
        for (auto name = list + 1; name != names.end(); ++name)
          key += (key.empty() ? "" : "/") + *name;
        names.erase(list + 1, names.end());
      }

    std::string value = without_blanks(text.substr(equals + 1));
    if (names_file(names.back()))
      value = without_quotes(value);
    if (!is_free_text(names.back()))
      check_characters(value, true, "--set");
    std::vector<Statement> statements;
    for (std::size_t i = 0; i + 1 < names.size(); ++i)
      statements.push_back({ Keyword::subsection, names[i], "", origin });
    statements.push_back({ Keyword::set, names.back(), value, origin, key });
    for (std::size_t i = 0; i + 1 < names.size(); ++i)
      statements.push_back({ Keyword::end, "", "", origin });
    return statements;
  }

  std::string without_blanks(const std::string &text)
  {
    const std::string blanks = " \t\r\n\v\f";
    const std::size_t first  = text.find_first_not_of(blanks);
    if (first == std::string::npos)
      return "";
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
  }

  bool take_keyword(const std::string &line, const std::string &keyword, std::string &rest)
  {
    const std::string start = line.substr(0, keyword.size());
    std::string       upper = keyword;
    for (char &c : upper)
      c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (start != keyword && start != upper)
      return false;
    if (line.size() > keyword.size() && line[keyword.size()] != ' ' && line[keyword.size()] != '\t')
      return false;
    rest = without_blanks(line.substr(keyword.size()));
    return true;
  }

  bool names_file(const std::string &entry)
  {
    const std::string ending = " file";
    return entry.size() > ending.size() &&
           entry.compare(entry.size() - ending.size(), ending.size(), ending) == 0;
  }
} // namespace axiforge
