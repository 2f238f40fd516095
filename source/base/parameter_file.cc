// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include <deal.II/base/utilities.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/parameter_file.h>
#include <axiforge/base/wording.h>

namespace axiforge
{
  namespace
  {
    using dealii::ParameterHandler;
    using Sections = std::vector<std::string>;

    std::string joined(const Sections &sections, const std::string &name)
    {
      std::string path;
      for (const std::string &section : sections)
        path += section + "/";
      return path + name;
    }

    std::string trimmed(const std::string &text)
    {
      const std::string blanks = " \t\r\n\v\f";
      const std::size_t first  = text.find_first_not_of(blanks);
      if (first == std::string::npos)
        return "";
      return text.substr(first, text.find_last_not_of(blanks) - first + 1);
    }

    /// The rest of @p line behind @p keyword (given in lower case, also accepted in upper case).
    bool take_keyword(const std::string &line, const std::string &keyword, std::string &rest)
    {
      const std::string start = line.substr(0, keyword.size());
      std::string       upper = keyword;
      for (char &c : upper)
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      if (start != keyword && start != upper)
        return false;
      if (line.size() > keyword.size() && line[keyword.size()] != ' ' &&
          line[keyword.size()] != '\t')
        return false;
      rest = trimmed(line.substr(keyword.size()));
      return true;
    }

    std::string contents_of(const std::string &path, const std::string &whence)
    {
      std::error_code ignored;
      if (std::filesystem::is_directory(path, ignored))
        throw InputError(whence + "\"" + path + "\" is a folder, not a parameter file.");
      errno = 0;
      std::ifstream      in(path, std::ios::binary);
      std::ostringstream text;
      if (in && in.peek() != std::ifstream::traits_type::eof())
        text << in.rdbuf();
      if (!in.is_open() || in.bad())
        throw InputError(whence + "Cannot read the parameter file \"" + path +
                         "\": " + (errno != 0 ? std::strerror(errno) : "unknown error") +
                         ". Check its name, and the folder it is looked for in.");
      return text.str();
    }

    /// The text of an exception of deal.II in one line.
    std::string info_of(const dealii::ExceptionBase &error)
    {
      std::ostringstream info;
      error.print_info(info);
      std::istringstream words(info.str());
      std::string        text, word;
      while (words >> word)
        text += (text.empty() ? "" : " ") + word;
      return text;
    }

    /// What is declared: for each section (joined path) the names of its entries and sections.
    struct Declared
    {
      std::map<std::string, std::vector<std::string>> entries, sections;

      explicit Declared(const ParameterHandler &prm)
      {
        std::ostringstream listing;
        prm.print_parameters(listing,
                             ParameterHandler::ShortPRM | ParameterHandler::KeepDeclarationOrder);
        std::istringstream in(listing.str());
        Sections           open;
        std::string        line, rest;
        while (std::getline(in, line))
          {
            line = trimmed(line);
            if (take_keyword(line, "subsection", rest))
              {
                sections[joined(open, "")].push_back(rest);
                open.push_back(rest);
              }
            else if (line == "end" && !open.empty())
              open.pop_back();
            else if (take_keyword(line, "set", rest) && rest.find('=') != std::string::npos)
              entries[joined(open, "")].push_back(trimmed(rest.substr(0, rest.find('='))));
          }
      }

      /// The sections that have @p name, as joined paths with the name, one per section.
      static std::vector<std::string>
      places(const std::map<std::string, std::vector<std::string>> &in, const std::string &name)
      {
        std::vector<std::string> found;
        for (const auto &[section, names] : in)
          if (std::find(names.begin(), names.end(), name) != names.end())
            found.push_back(section + name);
        return found;
      }
    };

    [[noreturn]] void throw_unknown(const std::string                                     &origin,
                                    const std::string                                     &what,
                                    const Sections                                        &open,
                                    const std::string                                     &name,
                                    const std::map<std::string, std::vector<std::string>> &declared)
    {
      const auto                     here = declared.find(joined(open, ""));
      const std::vector<std::string> known =
          here == declared.end() ? std::vector<std::string>() : here->second;
      const std::string where =
          open.empty()
              ? "at the top level"
              : "in section \"" + joined({ open.begin(), open.end() - 1 }, open.back()) + "\"";

      std::string       text    = origin + ": Unknown " + what + " \"" + joined(open, name) + "\".";
      const std::string nearest = closest_name(name, known);
      const std::vector<std::string> elsewhere = Declared::places(declared, name);
      if (!nearest.empty())
        text += " Did you mean \"" + nearest + "\"?";
      else if (!elsewhere.empty())
        text += " Did you mean " + list_in_words(elsewhere) + "?";
      if (known.empty())
        text += " Nothing of that kind is known " + where + ".";
      else
        text += " Known " + where + ": " + list_in_words(known) + ".";
      throw InputError(text);
    }

    [[noreturn]] void throw_bad_value(const std::string &origin,
                                      const std::string &entry,
                                      const std::string &value,
                                      const std::string &info)
    {
      const std::string marker  = "does not match the given pattern <";
      const std::size_t start   = info.find(marker) + marker.size();
      const std::string pattern = info.substr(start, info.rfind('>') - start);

      std::string       way_out;
      const std::string nearest = closest_name(value, selection_of_pattern(pattern));
      if (!nearest.empty())
        way_out = "Did you mean \"" + nearest + "\"?";
      else if (pattern.compare(0, 7, "[Double") == 0 && value.find(',') != std::string::npos)
        way_out = "The decimal sign is a point.";
      else if (pattern.compare(0, 7, "[Double") == 0 && !value.empty() &&
               std::isdigit(static_cast<unsigned char>(value[0])) &&
               std::isalpha(static_cast<unsigned char>(value.back())))
        way_out = "Give the number alone; the text of the entry says its unit.";
      throw InputError(
          origin + ": " +
          InputError::entry(entry, value, "this value is not allowed", pattern_in_words(pattern))
              .what() +
          (way_out.empty() ? "" : " " + way_out));
    }

    /// The sections a parse has entered; they are left again whatever happens.
    class EnteredSections
    {
    public:
      explicit EnteredSections(ParameterHandler &prm)
          : prm(prm)
      {
      }
      EnteredSections(const EnteredSections &)            = delete;
      EnteredSections &operator=(const EnteredSections &) = delete;
      ~EnteredSections()
      {
        leave_all();
      }
      void enter(const std::string &name)
      {
        prm.enter_subsection(name);
        names.push_back(name);
      }
      void leave()
      {
        prm.leave_subsection();
        names.pop_back();
      }
      void leave_all()
      {
        while (!names.empty())
          leave();
      }

      std::vector<std::string> names;

    private:
      ParameterHandler &prm;
    };
  } // namespace

  ParameterFile::ParameterFile(const std::string &path, const std::vector<std::string> &overrides)
      : path_(path)
      , text_(contents_of(path, ""))
  {
    std::vector<std::string> open_files;
    read_file(path, open_files);
    n_of_file_ = statements_.size();
    for (const std::string &text : overrides)
      add_override(text);
  }

  void ParameterFile::read_file(const std::string &path, std::vector<std::string> &open_files)
  {
    const std::string whence =
        open_files.empty() ? "" : "Included by \"" + open_files.back() + "\": ";
    std::string text = open_files.empty() ? text_ : contents_of(path, whence);
    if (text.compare(0, 3, "\xEF\xBB\xBF") == 0) // byte order mark of some editors
      text.erase(0, 3);
    open_files.push_back(path);

    std::vector<Statement> open_sections;
    std::istringstream     in(text);
    std::string            line, whole;
    unsigned int           number = 0, first_number = 0;
    while (std::getline(in, line))
      {
        ++number;
        line = trimmed(line);
        if (whole.empty())
          first_number = number;
        if (!line.empty() && line.back() == '\\' && in.peek() != std::istream::traits_type::eof())
          {
            whole += line.substr(0, line.size() - 1);
            continue;
          }
        whole += line.empty() || line.back() != '\\' ? line : line.substr(0, line.size() - 1);
        read_line(trimmed(whole.substr(0, whole.find('#'))), path,
                  path + ":" + std::to_string(first_number), open_sections, open_files);
        whole.clear();
      }
    if (!open_sections.empty())
      throw InputError(
          open_sections.back().origin + ": Section \"" + open_sections.back().name +
          "\" is opened here and never closed. Add a line \"end\" behind its last entry.");
    open_files.pop_back();
  }

  void ParameterFile::read_line(const std::string        &line,
                                const std::string        &path,
                                const std::string        &origin,
                                std::vector<Statement>   &open_sections,
                                std::vector<std::string> &open_files)
  {
    std::string rest;
    if (line.empty())
      return;
    if (take_keyword(line, "subsection", rest))
      {
        if (rest.empty())
          throw InputError(origin + ": \"subsection\" without a name. Write \"subsection NAME\".");
        statements_.push_back({ Keyword::subsection, rest, "", origin });
        open_sections.push_back(statements_.back());
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
        statements_.push_back({ Keyword::end, "", "", origin });
      }
    else if (take_keyword(line, "set", rest))
      {
        const std::size_t equals = rest.find('=');
        const std::string name   = trimmed(rest.substr(0, equals));
        if (equals == std::string::npos || name.empty())
          throw InputError(origin + ": Cannot read \"" + line + "\". Write \"set NAME = VALUE\".");
        statements_.push_back({ Keyword::set, name, trimmed(rest.substr(equals + 1)), origin });
      }
    else if (take_keyword(line, "include", rest))
      {
        if (rest.size() > 1 && rest.front() == '"' && rest.back() == '"')
          rest = rest.substr(1, rest.size() - 2);
        if (rest.empty())
          throw InputError(origin +
                           ": \"include\" without the name of a file. Write \"include FILE\", "
                           "relative to the folder of this file.");
        namespace fs            = std::filesystem;
        const fs::path included = fs::path(path).parent_path() / rest;
        for (const std::string &open : open_files)
          if (fs::weakly_canonical(open) == fs::weakly_canonical(included))
            throw InputError(origin + ": The file \"" + included.string() +
                             "\" includes itself, directly or through others. Take out one of the "
                             "\"include\" lines.");
        read_file(included.string(), open_files);
      }
    else
      throw InputError(
          origin + ": Cannot read \"" + line +
          "\". A line is \"subsection NAME\", \"set NAME = VALUE\", \"end\", \"include "
          "FILE\" or a comment that begins with #.");
  }

  void ParameterFile::add_override(const std::string &text)
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
      names.push_back(trimmed(part));
    for (const std::string &name : names)
      if (name.empty())
        throw InputError(origin + ": The name of a section or of the entry is empty. Write --set "
                                  "\"Section/Entry = value\".");

    for (std::size_t i = 0; i + 1 < names.size(); ++i)
      statements_.push_back({ Keyword::subsection, names[i], "", origin });
    statements_.push_back({ Keyword::set, names.back(), trimmed(text.substr(equals + 1)), origin });
    for (std::size_t i = 0; i + 1 < names.size(); ++i)
      statements_.push_back({ Keyword::end, "", "", origin });
  }

  void ParameterFile::parse(ParameterHandler &prm, const bool skip_undefined) const
  {
    EnteredSections open(prm);
    unsigned int    skipped_sections = 0; // that are open and not declared
    for (const Statement &statement : statements_)
      if (skipped_sections > 0)
        {
          if (statement.keyword == Keyword::subsection)
            ++skipped_sections;
          else if (statement.keyword == Keyword::end)
            --skipped_sections;
        }
      else if (statement.keyword == Keyword::end)
        open.leave();
      else if (statement.keyword == Keyword::subsection)
        {
          if (prm.subsection_path_exists({ statement.name }))
            open.enter(statement.name);
          else if (skip_undefined)
            skipped_sections = 1;
          else
            {
              const Sections sections = open.names;
              open.leave_all();
              throw_unknown(statement.origin, "section", sections, statement.name,
                            Declared(prm).sections);
            }
        }
      else
        {
          const std::string entry = joined(open.names, statement.name);
          try
            {
              prm.set(statement.name, statement.value);
            }
          catch (const ParameterHandler::ExcEntryUndeclared &)
            {
              if (skip_undefined)
                continue;
              if (prm.subsection_path_exists({ statement.name }))
                throw InputError(statement.origin + ": \"" + entry +
                                 "\" is a section, not an entry. Write \"subsection " +
                                 statement.name + "\" and set the entries in it.");
              const Sections sections = open.names;
              open.leave_all();
              throw_unknown(statement.origin, "entry", sections, statement.name,
                            Declared(prm).entries);
            }
          catch (const ParameterHandler::ExcValueDoesNotMatchPattern &error)
            {
              throw_bad_value(statement.origin, entry, statement.value, info_of(error));
            }
          catch (const dealii::ExceptionBase &error)
            {
              throw InputError(statement.origin + ": " +
                               InputError::entry(entry, statement.value, "cannot be used").what() +
                               " " + info_of(error));
            }
          catch (const InputError &error)
            {
              throw InputError(statement.origin + ": " + error.what());
            }
          catch (const std::exception &error)
            {
              throw InputError(statement.origin + ": " +
                               InputError::entry(entry, statement.value, error.what()).what());
            }
        }
  }

  const std::string &ParameterFile::path() const
  {
    return path_;
  }

  std::string ParameterFile::directory() const
  {
    const std::string folder = std::filesystem::path(path_).parent_path().string();
    return folder.empty() ? "." : folder;
  }

  const std::string &ParameterFile::text() const
  {
    return text_;
  }

  std::vector<std::string> ParameterFile::sections_of_family(const std::string &family) const
  {
    std::vector<std::string> members;
    unsigned int             depth = 0;
    for (const Statement &statement : statements_)
      if (statement.keyword == Keyword::end)
        --depth;
      else if (statement.keyword == Keyword::subsection && depth++ == 0 &&
               statement.name.compare(0, family.size() + 1, family + " ") == 0)
        {
          const std::string member = trimmed(statement.name.substr(family.size()));
          if (std::find(members.begin(), members.end(), member) == members.end())
            members.push_back(member);
        }
    return members;
  }

  ParameterFile ParameterFile::seen_by(const std::string &family, const std::string &member) const
  {
    ParameterFile result(*this);
    result.statements_.clear();
    // Common and own statements of the file, then those of the command line.
    for (const bool overrides : { false, true })
      {
        std::vector<Statement> common, own;
        const std::size_t      begin = overrides ? n_of_file_ : 0,
                          end        = overrides ? statements_.size() : n_of_file_;
        std::string  open; // the member whose section this is; empty outside of the family
        unsigned int depth = 0;
        for (std::size_t i = begin; i < end; ++i)
          {
            const Statement &statement = statements_[i];
            if (statement.keyword == Keyword::subsection && depth++ == 0 &&
                statement.name.compare(0, family.size() + 1, family + " ") == 0)
              open = trimmed(statement.name.substr(family.size()));
            else if (statement.keyword == Keyword::end && --depth == 0 && !open.empty())
              open.clear();
            else if (open.empty())
              common.push_back(statement);
            else if (open == member)
              own.push_back(statement);
          }
        result.statements_.insert(result.statements_.end(), common.begin(), common.end());
        result.statements_.insert(result.statements_.end(), own.begin(), own.end());
        if (!overrides)
          result.n_of_file_ = result.statements_.size();
      }
    return result;
  }

  std::string ParameterFile::resolved_text() const
  {
    std::string text, indent;
    for (const Statement &statement : statements_)
      switch (statement.keyword)
        {
        case Keyword::subsection:
          text += indent + "subsection " + statement.name + "\n";
          indent += "  ";
          break;
        case Keyword::end:
          indent.erase(0, 2);
          text += indent + "end\n";
          break;
        case Keyword::set:
          text += indent + "set " + statement.name + " = " + statement.value + "\n";
          break;
        }
    return text;
  }
} // namespace axiforge
