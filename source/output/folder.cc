// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/output/folder.h>

namespace axiforge::output
{
  namespace
  {
    namespace fs = std::filesystem;

    /// What a run writes anew each time, and what tells how it was made.
    const std::vector<std::string> results = { "fields.pvd",        "tools.pvd", "history.csv",
                                               "checkpoint.axi",    "chain.csv", "chain.md",
                                               "checkpoint.old.axi" };
    const std::vector<std::string> provenance_files = { "versions.txt", "input.prm",
                                                        "parameters.prm" };

    bool is_same(const fs::path &a, const fs::path &b)
    {
      std::error_code ignored;
      return fs::equivalent(a, b, ignored);
    }


    bool is_of_scene(const fs::path &path, const Provenance &provenance)
    {
      return std::any_of(provenance.scene_files.begin(), provenance.scene_files.end(),
                         [&](const std::string &file) { return is_same(path, file); });
    }


    /// A file of the fields, of this program and of no one else.
    bool is_field(const std::string &name)
    {
      static const std::regex pattern(R"((workpiece|tools)_\d{5,}\.vtu)");
      return std::regex_match(name, pattern);
    }


    /// What AtomicFile and others have under way in a folder of results when they are killed.
    bool is_left_over(const std::string &name)
    {
      static const std::regex temporary(R"(\.(.+)\.\d+\.tmp)"), part(R"((.+\.vtu)\.part)");
      std::smatch             match;
      if (name == ".checkpoint.link")
        return true;
      if (!std::regex_match(name, match, temporary) && !std::regex_match(name, match, part))
        return false;
      const std::string of = match[1];
      const auto        in = [&](const std::vector<std::string> &list) {
        return std::find(list.begin(), list.end(), of) != list.end();
      };
      return is_field(of) || in(results) || in(provenance_files);
    }


    template <typename Condition>
    void remove_if(const std::string &folder, const Condition &unwanted)
    {
      std::error_code       ignored;
      std::vector<fs::path> found; // not removed under the iterator's feet
      for (const auto &entry : fs::directory_iterator(folder, ignored))
        if (unwanted(entry.path().filename().string()))
          found.push_back(entry.path());
      for (const fs::path &path : found)
        fs::remove(path, ignored);
    }


    bool holds_results(const std::string &folder)
    {
      std::ifstream in(folder + "/versions.txt");
      std::string   word;
      return in >> word && word == "axiforge";
    }
  } // namespace


  FolderLock::FolderLock(const std::string &folder)
      : path(folder + "/.axiforge.lock")
  {
    std::error_code ignored;
    for (fs::path missing = fs::absolute(folder).lexically_normal();
         missing.has_relative_path() && !fs::exists(missing, ignored);
         missing = missing.parent_path())
      made.insert(made.begin(), missing.string());
    make_folder(folder);
    for (;;)
      {
        descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0)
          return; // nothing else can be written here, and what is written first says so
        const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
        if (!locked && errno == EWOULDBLOCK)
          {
            ::close(descriptor);
            std::string who;
            std::getline(std::ifstream(path) >> std::ws, who);
            throw InputError(fmt::format(
                "The folder of the results \"{}\" is in use by another run{}. Wait until it has "
                "ended, stop it, or choose another folder with --output.",
                folder, who.empty() ? "" : " (" + who + ")"));
          }
        // Who had it may have taken the file away between opening and locking.
        struct stat mine, there;
        if (!locked || (::fstat(descriptor, &mine) == 0 && ::stat(path.c_str(), &there) == 0 &&
                        mine.st_ino == there.st_ino && mine.st_dev == there.st_dev))
          break;
        ::close(descriptor);
      }
    char host[256] = "";
    ::gethostname(host, sizeof(host) - 1);
    const std::string who = fmt::format("process {} on {}\n", ::getpid(), host);
    // To be read by people: a full disk is told by what matters.
    if (::ftruncate(descriptor, 0) != 0 || ::write(descriptor, who.data(), who.size()) < 0)
      return;
  }


  FolderLock::~FolderLock()
  {
    if (descriptor >= 0)
      {
        ::unlink(path.c_str());
        ::close(descriptor);
      }
    for (auto folder = made.rbegin(); folder != made.rend(); ++folder)
      if (::rmdir(folder->c_str()) != 0) // which does it to empty ones only
        break;
  }


  void make_folder(const std::string &folder)
  {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
      throw InputError::entry("Output/Directory", folder,
                              "the folder can't be made (" + error.message() + ")",
                              "a folder that you may write to", "Choose another with --output");
  }


  void check_folder(const std::string &folder, const Provenance &provenance)
  {
    std::error_code          ignored;
    std::vector<std::string> names(results), foreign;
    names.insert(names.end(), provenance_files.begin(), provenance_files.end());
    for (const std::string &name : names)
      {
        const std::string path = folder + "/" + name;
        if (!fs::exists(path, ignored))
          continue;
        const bool scene = is_of_scene(path, provenance),
                   kept  = scene && name.find(".prm") < name.size();
        if (!kept && (scene || provenance.files.has(path)))
          throw InputError(
              fmt::format("The scene reads the file \"{}\", and the run would write its results "
                          "over it. Choose "
                          "another folder with --output, or give the file another name.",
                          path));
        if (!kept)
          foreign.push_back(path);
      }
    if (holds_results(folder))
      return;
    for (const std::string sub : { "fields", "input" })
      for (const auto &entry : fs::directory_iterator(folder + "/" + sub, ignored))
        if (entry.is_regular_file(ignored) &&
            (sub == "input" || is_field(entry.path().filename().string())))
          foreign.push_back(folder + "/" + sub + "/" + entry.path().filename().string());
    if (!foreign.empty())
      throw InputError(fmt::format(
          "The folder \"{}\" has a file \"{}\" and is no folder of results (it has no "
          "versions.txt of axiforge): the run would write over it. Choose another folder with "
          "--output, or move the file away.",
          folder, fs::path(foreign.front()).lexically_relative(folder).string()));
  }


  void remove_results(const std::string &folder)
  {
    std::error_code ignored;
    for (const std::string &name : results)
      fs::remove(folder + "/" + name, ignored);
    remove_fields(folder, {});
  }


  void remove_fields(const std::string &folder, const std::vector<std::string> &kept)
  {
    remove_if(folder, is_left_over);
    remove_if(folder + "/fields", [&](const std::string &name) {
      return is_left_over(name) ||
             (is_field(name) && std::find(kept.begin(), kept.end(), name) == kept.end());
    });
  }


  void write_provenance(const std::string &folder, const Provenance &provenance)
  {
    // First what tells that this is a folder of results.
    write_file_atomically(folder + "/versions.txt", provenance.versions);
    const auto write = [&](const std::string &path, const std::string &text) {
      if (!is_of_scene(path, provenance))
        write_file_atomically(path, provenance.files.with_copies(text, provenance.folder_of_files));
    };
    write(folder + "/input.prm", provenance.input);
    write(folder + "/parameters.prm", provenance.parameters);
  }


  std::vector<std::string> files_of_scene(const std::string &parameter_file)
  {
    std::vector<std::string> files = { parameter_file };
    for (std::size_t i = 0; i < files.size(); ++i)
      {
        std::ifstream in(files[i]);
        for (std::string line; std::getline(in, line);)
          {
            std::istringstream words(line.substr(0, line.find('#')));
            std::string        keyword, name;
            if (!(words >> keyword) || (keyword != "include" && keyword != "INCLUDE"))
              continue;
            std::getline(words, name);
            name = trim(name);
            if (name.size() > 1 && name.front() == '"' && name.back() == '"')
              name = name.substr(1, name.size() - 2);
            const std::string path = (fs::path(files[i]).parent_path() / name).string();
            if (std::find(files.begin(), files.end(), path) == files.end())
              files.push_back(path);
          }
      }
    return files;
  }
} // namespace axiforge::output
