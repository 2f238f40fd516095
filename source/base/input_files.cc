// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/csv.h>
#include <axiforge/base/input_files.h>

namespace axiforge
{
  namespace
  {
    namespace fs = std::filesystem;

    const std::string mark = "# contents of file ";

    bool names_a_file(const std::string &entry)
    {
      const std::string name = entry.substr(entry.rfind('/') + 1);
      return name == "Geometry file" || name == "Table file";
    }


    std::string contents(const std::string &path)
    {
      std::ifstream      in(path, std::ios::binary);
      std::ostringstream text;
      text << in.rdbuf();
      return text.str();
    }


    bool is_geo(const std::string &path)
    {
      std::string extension = fs::path(path).extension().string();
      std::transform(extension.begin(), extension.end(), extension.begin(),
                     [](const unsigned char c) { return std::tolower(c); });
      return extension == ".geo";
    }


    /// Where the literal names of other files stand in a .geo: begin and length.
    std::vector<std::pair<std::size_t, std::size_t>> names_in_geo(const std::string &text)
    {
      const auto past = [&](const std::string &what, const std::size_t from) {
        const std::size_t found = text.find(what, from);
        return found == std::string::npos ? text.size() : found + what.size();
      };
      const auto is_letter = [](const unsigned char c) { return std::isalnum(c) || c == '_'; };
      std::vector<std::pair<std::size_t, std::size_t>> names;
      std::string                                      word; // the last one before a quote
      for (std::size_t i = 0; i < text.size();)
        if (text.compare(i, 2, "//") == 0)
          i = past("\n", i);
        else if (text.compare(i, 2, "/*") == 0)
          i = past("*/", i + 2);
        else if (text[i] == '"')
          {
            const std::size_t end = past("\"", i + 1);
            if (word == "Include" || word == "Merge" || word == "ShapeFromFile")
              names.emplace_back(i + 1, std::max(end, i + 2) - i - 2);
            word.clear();
            i = end;
          }
        else if (is_letter(text[i]))
          for (word.clear(); i < text.size() && is_letter(text[i]); ++i)
            word += text[i];
        else
          {
            if (!std::isspace(static_cast<unsigned char>(text[i])) && text[i] != '(')
              word.clear();
            ++i;
          }
      return names;
    }


    fs::path shared_folder(const fs::path &a, const fs::path &b)
    {
      fs::path shared;
      for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end() && *i == *j; ++i, ++j)
        shared /= *i;
      return shared;
    }
  } // namespace


  std::vector<std::pair<std::string, std::string>> entries_of_text(const std::string &text)
  {
    std::vector<std::pair<std::string, std::string>> entries;
    std::vector<std::string>                         sections;
    std::istringstream                               in(text);
    for (std::string line; std::getline(in, line);)
      {
        const std::string statement(trim(line.substr(0, line.find('#'))));
        if (statement == "end" && !sections.empty())
          sections.pop_back();
        else if (statement.compare(0, 11, "subsection ") == 0)
          sections.push_back(statement.substr(11));
        else if (const std::size_t equals = statement.find('=');
                 statement.compare(0, 4, "set ") == 0 && equals != std::string::npos)
          {
            std::string path;
            for (const std::string &section : sections)
              path += section + "/";
            entries.emplace_back(path + std::string(trim(statement.substr(4, equals - 4))),
                                 trim(statement.substr(equals + 1)));
          }
      }
    return entries;
  }


  InputFiles::InputFiles(const std::string &text, const std::string &directory)
  {
    std::error_code ignored;
    for (const auto &[entry, value] : entries_of_text(text))
      if (names_a_file(entry) && !value.empty())
        {
          const fs::path path = fs::absolute(fs::path(directory) / value).lexically_normal();
          if (fs::is_regular_file(path, ignored))
            entries.push_back({ entry, value, read(path.string()) });
        }
    for (const File &file : files)
      {
        const fs::path folder = fs::path(file.path).parent_path();
        root = (&file == &files.front() ? folder : shared_folder(root, folder)).string();
      }
  }


  std::size_t InputFiles::read(const std::string &path)
  {
    for (std::size_t i = 0; i < files.size(); ++i)
      if (files[i].path == path)
        return i;
    const std::size_t number = files.size();
    files.push_back({ path, contents(path), {} });
    if (!is_geo(path))
      return number;
    std::error_code ignored;
    for (const auto &[begin, length] : names_in_geo(files[number].content))
      {
        const std::string name   = files[number].content.substr(begin, length);
        const fs::path    target = (fs::path(path).parent_path() / name).lexically_normal();
        if (!fs::is_regular_file(target, ignored))
          continue;
        const std::size_t file = read(target.string()); // files may move
        files[number].included.push_back({ begin, length, file });
      }
    return number;
  }


  std::string InputFiles::copy_of(const std::size_t file) const
  {
    return fs::path(files[file].path).lexically_relative(root).generic_string();
  }


  std::string InputFiles::content_of_copy(const std::size_t file) const
  {
    std::string text = files[file].content;
    for (auto i = files[file].included.rbegin(); i != files[file].included.rend(); ++i)
      if (fs::path(text.substr(i->begin, i->length)).is_absolute())
        text.replace(i->begin, i->length,
                     fs::path(files[i->file].path)
                         .lexically_relative(fs::path(files[file].path).parent_path())
                         .generic_string());
    return text;
  }


  std::string InputFiles::with_copies(const std::string &text, const std::string &folder) const
  {
    std::istringstream in(text);
    std::string        result;
    for (std::string line; std::getline(in, line);)
      {
        for (const auto &[entry, value] : entries_of_text(line))
          for (const Entry &known : entries)
            if (names_a_file(entry) && value == known.value)
              {
                line.replace(line.find(value, line.find('=')), value.size(),
                             folder + "/" + copy_of(known.file));
                break;
              }
        result += line + "\n";
      }
    if (!text.empty() && text.back() != '\n')
      result.pop_back();
    return result;
  }


  void InputFiles::add_to_checksum(const std::size_t         file,
                                   std::vector<std::size_t> &done,
                                   std::uint64_t            &sum) const
  {
    // FNV-1a, 64 bits. Names of included files may change with their folder, contents may not.
    const auto add = [&](const std::string &text, const std::size_t begin, const std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        sum = (sum ^ static_cast<unsigned char>(text[i])) * 0x100000001b3ull;
    };
    done.push_back(file);
    const std::string &text = files[file].content;
    std::size_t        at   = 0;
    for (const Included &included : files[file].included)
      {
        add(text, at, included.begin);
        at = included.begin + included.length;
        if (std::find(done.begin(), done.end(), included.file) == done.end())
          add_to_checksum(included.file, done, sum);
      }
    add(text, at, text.size());
  }


  std::string InputFiles::fingerprints() const
  {
    std::string text;
    for (const Entry &entry : entries)
      {
        std::vector<std::size_t> done;
        std::uint64_t            sum = 0xcbf29ce484222325ull;
        add_to_checksum(entry.file, done, sum);
        text += fmt::format("{}{} = {:016x} {}\n", mark, entry.path, sum, files[entry.file].path);
      }
    return text;
  }


  std::vector<Fingerprint> fingerprints_in(const std::string &text)
  {
    std::vector<Fingerprint> found;
    std::istringstream       in(text);
    for (std::string line; std::getline(in, line);)
      if (const std::size_t equals = line.find(" = "); line.compare(0, mark.size(), mark) == 0 &&
                                                       equals != std::string::npos &&
                                                       line.size() > equals + 20)
        found.push_back({ line.substr(mark.size(), equals - mark.size()),
                          line.substr(equals + 3, 16), line.substr(equals + 20) });
    return found;
  }


  void InputFiles::write(const std::string &folder) const
  {
    std::error_code error;
    for (std::size_t i = 0; i < files.size(); ++i)
      {
        const std::string target = folder + "/" + copy_of(i), content = content_of_copy(i);
        if (fs::equivalent(target, files[i].path, error) ||
            (fs::is_regular_file(target, error) && contents(target) == content))
          continue;
        fs::create_directories(fs::path(target).parent_path(), error);
        write_file_atomically(target, content);
      }
  }


  bool InputFiles::has(const std::string &path) const
  {
    std::error_code ignored;
    for (const File &file : files)
      if (fs::equivalent(file.path, path, ignored))
        return true;
    return false;
  }
} // namespace axiforge
