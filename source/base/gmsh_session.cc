// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <gmsh.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/forked.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/base/step_file.h>
#include <axiforge/base/wording.h>

namespace axiforge
{
  namespace
  {
    unsigned int open_sessions = 0;

    std::string lower_extension(const std::string &file)
    {
      std::string extension = std::filesystem::path(file).extension().string();
      std::transform(extension.begin(), extension.end(), extension.begin(),
                     [](unsigned char c) { return std::tolower(c); });
      return extension;
    }

    bool is_cad(const std::string &extension)
    {
      return extension == ".step" || extension == ".stp" || extension == ".brep";
    }

    /// What a `.geo` says, and what it says outside of comments and texts in quotes.
    struct Script
    {
      std::string without_comments, code;

      explicit Script(const std::string &file)
      {
        std::ifstream     in(file, std::ios::binary);
        const std::string text{ std::istreambuf_iterator<char>(in),
                                std::istreambuf_iterator<char>() };
        const auto        end = [&](const std::string &mark, const std::size_t from) {
          const std::size_t at = text.find(mark, from);
          return at == std::string::npos ? text.size() : at + mark.size();
        };
        for (std::size_t i = 0; i < text.size();)
          if (text.compare(i, 2, "//") == 0)
            i = std::min(text.find('\n', i), text.size());
          else if (text.compare(i, 2, "/*") == 0)
            i = end("*/", i + 2);
          else if (text[i] == '"')
            {
              const std::size_t behind = end("\"", i + 1);
              without_comments += text.substr(i, behind - i);
              i = behind;
            }
          else
            {
              without_comments += text[i];
              code += text[i++];
            }
      }
    };

    struct Forbidden
    {
      std::string command, does;
    };

    /**
     * Refuses a `.geo` whose commands reach beyond the geometry: `Exit` ends this program, silently
     * and with status 0; others run programs. Files that it merges or includes count as well.
     */
    void check_commands(const std::string &script,
                        const std::string &file,
                        const std::string &entry,
                        const unsigned int depth = 0)
    {
      static const std::vector<Forbidden> forbidden = {
        { R"(Exit\s*;)", "would end the program" },
        { R"((NonBlocking)?SystemCall\b)", "runs a program" },
        { R"(OnelabRun\b)", "runs a program" },
        { R"(GetValue\b)", "waits for an answer from the keyboard" }
      };
      const Script text(script);
      for (const Forbidden &f : forbidden)
        {
          const std::regex command("(^|[^A-Za-z0-9_])(" + f.command + ")");
          std::smatch      found;
          if (std::regex_search(text.code, found, command))
            throw InputError::entry(entry, file,
                                    fmt::format("{} has the command \"{}\", which {}",
                                                depth == 0 ? "it" : "\"" + script + "\"",
                                                found[2].str(), f.does),
                                    "", "Remove that line");
        }
      constexpr unsigned int  most = 10;
      static const std::regex other(R"re((Include|Merge|MergeFile)\s+"([^"\n]+)")re");
      for (auto it = std::sregex_iterator(text.without_comments.begin(),
                                          text.without_comments.end(), other);
           it != std::sregex_iterator() && depth < most; ++it)
        check_commands((std::filesystem::path(script).parent_path() / (*it)[2].str()).string(),
                       file, entry, depth + 1);
    }

    /// Files that gmsh has read in a process of its own without crashing, with their last change.
    std::set<std::string> tried;

    /// Names of the parameters that the loaded `.geo` itself defined.
    std::vector<std::string> parameters_of_file()
    {
      std::vector<std::string> names, defined;
      gmsh::onelab::getNames(names);
      for (const std::string &name : names)
        {
          if (name.rfind("Gmsh/", 0) == 0)
            continue;
          std::string description; // ONELAB lists the clients that use it: the parser, or nobody
          gmsh::onelab::get(description, name);
          if (description.find("\"clients\"") != std::string::npos)
            defined.push_back(name);
        }
      return defined;
    }
  } // namespace

  GeometryValues parse_geometry_parameters(const std::string &text, const std::string &entry)
  {
    const auto wrong = [&](const std::string &what) {
      return InputError::entry(entry, text, what, "a list like \"Radius = 25, Height = 12.5\"");
    };

    GeometryValues parameters;
    if (trim(text).empty())
      return parameters;

    std::size_t begin = 0;
    while (begin <= text.size())
      {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string item =
            std::string(trim(std::string_view(text).substr(begin, end - begin)));
        begin = end + 1;

        const std::size_t equals   = item.find('=');
        double            decimals = 0;
        if (equals == std::string::npos)
          throw wrong(fmt::format("\"{}\" has no \"=\"{}", item,
                                  !parameters.empty() && parse_number(item, decimals)
                                      ? ", and the decimal sign is a point"
                                      : ""));
        const std::string name(trim(std::string_view(item).substr(0, equals)));
        const std::string number(trim(std::string_view(item).substr(equals + 1)));
        double            value = 0;
        if (name.empty())
          throw wrong(fmt::format("\"{}\" has no name before \"=\"", item));
        if (!parse_number(number, value))
          throw wrong(fmt::format("\"{}\" for {} is not a number", number, name));
        if (!parameters.emplace(name, value).second)
          throw wrong(fmt::format("{} is given twice", name));
      }
    return parameters;
  }

  std::string resolve_path(const std::string &directory, const std::string &file)
  {
    const std::filesystem::path path(file);
    if (path.is_absolute() || directory.empty())
      return path.lexically_normal().string();
    return (std::filesystem::path(directory) / path).lexically_normal().string();
  }

  std::string quoted_list(const std::vector<std::string> &names)
  {
    if (names.empty())
      return "none";
    return list_in_words(names);
  }

  GmshSession::GmshSession()
  {
    if (open_sessions++ > 0)
      return;
    gmsh::initialize(0, nullptr, /* readConfigFiles = */ false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.AbortOnError", 0);
    gmsh::option::setNumber("General.NumThreads", 1);
    gmsh::option::setNumber("Mesh.RandomSeed", 1);
    gmsh::option::setString("Geometry.OCCTargetUnit", "MM");
  }

  GmshSession::~GmshSession()
  {
    if (--open_sessions == 0)
      gmsh::finalize();
  }

  void GmshSession::run(const std::string &what, const std::function<void()> &action) const
  {
    std::vector<std::string> errors;
    gmsh::logger::start();
    try
      {
        action();
      }
    catch (const std::string &text) // gmsh 4.8 throws strings, other versions other things
      {
        errors.push_back(text);
      }
    catch (const int code)
      {
        errors.push_back(fmt::format("error {}", code));
      }
    catch (const InputError &)
      {
        gmsh::logger::stop();
        throw;
      }
    catch (const std::exception &exception)
      {
        errors.push_back(exception.what());
      }

    std::vector<std::string> log;
    gmsh::logger::get(log);
    gmsh::logger::stop();
    std::vector<std::string> logged;
    for (const std::string &line : log)
      for (const std::string prefix : { "Error: ", "Fatal: " })
        if (line.rfind(prefix, 0) == 0)
          logged.push_back(line.substr(prefix.size()));
    if (!logged.empty())
      errors = logged;
    if (!errors.empty() && file.empty()) // a mesh of the program's own
      throw ComputationError(
          fmt::format("gmsh failed while {}: {}", what, fmt::join(errors, "; ")));
    if (!errors.empty())
      throw InputError::entry(
          entry, file, fmt::format("gmsh failed while {}: {}", what, fmt::join(errors, "; ")));
  }

  void GmshSession::try_out(const std::string &what, const std::function<void()> &action) const
  {
    const std::string fate = fate_of(action);
    if (!fate.empty())
      throw InputError::entry(entry, file, fmt::format("gmsh {} while {}", fate, what), "",
                              "The file is damaged, or has something that gmsh can't take: write "
                              "it anew, or try it in gmsh itself");
  }

  void GmshSession::open(const std::string    &new_file,
                         const GeometryValues &parameters,
                         const std::string    &new_entry)
  {
    file  = new_file;
    entry = new_entry;

    const std::string extension = lower_extension(file);
    if (extension != ".geo" && extension != ".msh" && !is_cad(extension))
      throw InputError::entry(entry, file, "this kind of file is not known",
                              ".geo, .msh, .step, .stp or .brep");
    if (!std::filesystem::is_regular_file(file))
      throw InputError::entry(entry, file, "there is no such file", "",
                              "A relative path counts from the folder of the parameter file");
    if (extension != ".geo" && !parameters.empty())
      throw InputError::entry(entry, file,
                              fmt::format("it can't take geometry parameters ({} was given)",
                                          parameters.begin()->first),
                              "parameters for a .geo only");
    if (extension == ".geo")
      check_commands(file, file, entry);
    else if (extension != ".msh" && extension != ".brep")
      check_step_text(file, entry);

    const auto read = [&]() {
      gmsh::clear();
      gmsh::onelab::clear();
      for (const auto &[name, value] : parameters)
        gmsh::onelab::setNumber(name, { value });
      gmsh::open(file);
    };
    std::error_code ignored;
    std::string     state =
        file +
        std::to_string(std::filesystem::last_write_time(file, ignored).time_since_epoch().count());
    for (const auto &[name, value] : parameters)
      state += fmt::format(",{}={}", name, value);
    if (tried.insert(state).second)
      try_out("reading the file", read);
    run("reading the file", read);
    if (extension == ".step" || extension == ".stp")
      {
        gmsh::vectorpair curves;
        gmsh::model::getEntities(curves, 1);
        check_step_curves(file, entry, curves.size());
      }

    const std::vector<std::string> known = parameters_of_file();
    for (const auto &[name, value] : parameters)
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw InputError::entry(
            entry, file, fmt::format("it has no parameter \"{}\" (value {})", name, value),
            fmt::format("the parameters of this file: {}", quoted_list(known)),
            fmt::format("A .geo declares one by DefineConstant[ {0} = {{{1}, Name \"{0}\"}} ];",
                        name, value));
  }

  std::vector<int> GmshSession::entities_of_group(const int dim, const std::string &name) const
  {
    gmsh::vectorpair groups;
    gmsh::model::getPhysicalGroups(groups, dim);
    std::vector<int> entities;
    for (const auto &group : groups)
      {
        std::string group_name;
        gmsh::model::getPhysicalName(dim, group.second, group_name);
        if (group_name.empty())
          group_name = std::to_string(group.second);
        if (group_name != name)
          continue;
        std::vector<int> tags;
        gmsh::model::getEntitiesForPhysicalGroup(dim, group.second, tags);
        for (const int tag : tags) // a .geo may give curves a direction by their sign
          entities.push_back(std::abs(tag));
      }
    std::sort(entities.begin(), entities.end());
    entities.erase(std::unique(entities.begin(), entities.end()), entities.end());
    return entities;
  }

  std::vector<std::string> GmshSession::group_names(const int dim) const
  {
    gmsh::vectorpair groups;
    gmsh::model::getPhysicalGroups(groups, dim);
    std::vector<std::string> names;
    for (const auto &group : groups)
      {
        std::string name;
        gmsh::model::getPhysicalName(dim, group.second, name);
        names.push_back(name.empty() ? std::to_string(group.second) : name);
      }
    return names;
  }

  bool GmshSession::mentions(const std::string &word) const
  {
    return lower_extension(file) == ".geo" && Script(file).code.find(word) != std::string::npos;
  }

  bool GmshSession::holds_mesh() const
  {
    return lower_extension(file) == ".msh";
  }

  bool GmshSession::holds_cad() const
  {
    return is_cad(lower_extension(file));
  }
} // namespace axiforge
