// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <sstream>

#include <deal.II/base/utilities.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/geometry_parameters.h>
#include <axiforge/base/notes.h>
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
            line = without_blanks(line);
            if (take_keyword(line, "subsection", rest))
              {
                sections[joined(open, "")].push_back(rest);
                open.push_back(rest);
              }
            else if (line == "end" && !open.empty())
              open.pop_back();
            else if (take_keyword(line, "set", rest) && rest.find('=') != std::string::npos)
              entries[joined(open, "")].push_back(without_blanks(rest.substr(0, rest.find('='))));
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

    const std::string geometry_parameters = "Geometry parameters";

    /// The names of a list "a = 1, b = 2".
    std::vector<std::string> names_of_list(const std::string &list)
    {
      std::vector<std::string> names;
      std::istringstream       parts(list);
      std::string              part;
      while (std::getline(parts, part, ','))
        names.push_back(without_blanks(part.substr(0, part.find('='))));
      return names;
    }

    /// What an entry has after a statement: the value, or the list with an element changed.
    std::string value_after(const Statement &statement, const std::string &before)
    {
      return statement.key.empty()
                 ? statement.value
                 : with_geometry_parameter(before, statement.key, statement.value);
    }

    /// The full name of the entry of each statement that sets one; empty for the others.
    std::vector<std::string> paths_of(const std::vector<Statement> &statements)
    {
      Sections                 open;
      std::vector<std::string> paths;
      for (const Statement &statement : statements)
        {
          if (statement.keyword == Keyword::subsection)
            open.push_back(statement.name);
          else if (statement.keyword == Keyword::end)
            open.pop_back();
          paths.push_back(statement.keyword == Keyword::set ? joined(open, statement.name) : "");
        }
      return paths;
    }
    /**
     * What to do about a section "Tool lower" where the list "Tools" doesn't have "lower". Empty if
     * it is no such section.
     */
    std::string way_out_of_family(const ParameterHandler       &prm,
                                  const std::vector<Statement> &statements,
                                  const std::string            &section)
    {
      const std::size_t blank = section.find(' ');
      if (blank == std::string::npos)
        return "";
      const std::string family = section.substr(0, blank), member = section.substr(blank + 1);
      const Declared    declared(prm);
      const auto        top = declared.entries.find("");
      if (top == declared.entries.end())
        return "";
      for (const std::string &list : { family + "s", family.substr(0, family.size() - 1) + "ies" })
        {
          if (std::find(top->second.begin(), top->second.end(), list) == top->second.end())
            continue;
          const std::vector<std::string> paths = paths_of(statements);
          std::string                    value; // wherever it stands in the file
          for (std::size_t i = 0; i < statements.size(); ++i)
            if (paths[i] == list)
              value = statements[i].value;
          std::vector<std::string> members = dealii::Utilities::split_string_list(value);
          if (std::find(members.begin(), members.end(), member) != members.end())
            return "";
          const std::string nearest = closest_name(member, members);
          return " The list \"" + list + "\" = \"" + value + "\" does not have it: add " + member +
                 " to \"set " + list + "\", as \"set " + list + " = " +
                 (value.empty() ? "" : value + ", ") + member + "\", or take the section out." +
                 (nearest.empty() ? "" : " Or did you mean \"" + family + " " + nearest + "\"?");
        }
      return "";
    }

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
      else if (const bool number =
                   pattern.compare(0, 7, "[Double") == 0 || pattern.compare(0, 8, "[Integer") == 0;
               (number || pattern.compare(0, 17, "[List of <[Double") == 0) &&
               std::count(value.begin(), value.end(), ',') > (number ? 0 : 1))
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
      , statements_(read_statements(path, text_))
      , n_of_file_(statements_.size())
  {
    add_overrides(overrides);
  }

  ParameterFile::ParameterFile(const std::vector<std::string> &overrides)
  {
    add_overrides(overrides);
  }

  void ParameterFile::add_overrides(const std::vector<std::string> &overrides)
  {
    for (const std::string &text : overrides)
      {
        const std::vector<Statement> added = statements_of_override(text);
        for (const Statement &statement : added)
          if (statement.name == geometry_parameters && statement.key.empty())
            note_dropped(paths_of(added).at(&statement - added.data()), statement);
        statements_.insert(statements_.end(), added.begin(), added.end());
      }
  }

  void ParameterFile::note_dropped(const std::string &path, const Statement &list) const
  {
    const std::vector<std::string> paths = paths_of(statements_);
    std::string                    before;
    for (std::size_t i = 0; i < statements_.size(); ++i)
      if (paths[i] == path)
        before = value_after(statements_[i], before);
    std::string dropped;
    const auto  given = names_of_list(list.value);
    for (const std::string &name : names_of_list(before))
      if (std::find(given.begin(), given.end(), name) == given.end())
        dropped += (dropped.empty() ? "" : ", ") + name;
    if (!dropped.empty())
      note(list.origin + " replaces the whole list \"" + before + "\": " + dropped +
           " back at the default of the geometry file. To change one of them, write --set \"" +
           path + "/NAME = value\".");
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
              if (const std::string way_out =
                      sections.empty() ? way_out_of_family(prm, statements_, statement.name) : "";
                  !way_out.empty())
                throw InputError(statement.origin + ": Unknown section \"" + statement.name +
                                 "\"." + way_out);
              throw_unknown(statement.origin, "section", sections, statement.name,
                            Declared(prm).sections);
            }
        }
      else
        {
          const std::string entry = joined(open.names, statement.name);
          try
            {
              prm.set(statement.name, statement.key.empty()
                                          ? statement.value
                                          : value_after(statement, prm.get(statement.name)));
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
          const std::string member = without_blanks(statement.name.substr(family.size()));
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
              open = without_blanks(statement.name.substr(family.size()));
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
    const std::vector<std::string>     paths = paths_of(statements_);
    std::map<std::string, std::string> last; // values by the full names
    for (std::size_t i = 0; i < statements_.size(); ++i)
      if (!paths[i].empty())
        last[paths[i]] = value_after(statements_[i], last[paths[i]]);

    std::string              text, indent;
    std::vector<std::size_t> begins; // of the sections that are open, in the text
    for (std::size_t i = 0; i < statements_.size(); ++i)
      switch (statements_[i].keyword)
        {
        case Keyword::subsection:
          begins.push_back(text.size());
          text += indent + "subsection " + statements_[i].name + "\n";
          indent += "  ";
          break;
        case Keyword::end:
          indent.erase(0, 2);
          // Of an override that changes an entry of the file nothing is left.
          if (i >= n_of_file_ && text.find("set ", begins.back()) == std::string::npos)
            text.erase(begins.back());
          else
            text += indent + "end\n";
          begins.pop_back();
          break;
        case Keyword::set:
          if (const auto value = last.find(paths[i]); value != last.end())
            {
              text += indent + "set " + statements_[i].name + " = " + value->second + "\n";
              last.erase(value);
            }
          break;
        }
    return text;
  }

  std::vector<std::string> ParameterFile::entries_of(const std::string &section) const
  {
    std::vector<std::string> names;
    for (const std::string &path : paths_of(statements_))
      if (path.compare(0, section.size() + 1, section + "/") == 0)
        {
          const std::string name = path.substr(section.size() + 1);
          if (std::find(names.begin(), names.end(), name) == names.end())
            names.push_back(name);
        }
    return names;
  }
} // namespace axiforge
