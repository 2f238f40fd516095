// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace axiforge
{
  /**
   * The geometry files and tables that a scene names, with what a `.geo` includes or merges: read
   * once, so that they can be kept beside the results and told apart from others later.
   *
   * The copies keep their places relative to each other, below the folder that all of them share:
   * so files of one name stay apart, and what is included relative to a file is found there. What a
   * `.geo` includes by an absolute path is named by a relative one in the copy. Only literal names
   * of `Include`, `Merge` and `ShapeFromFile` are followed.
   */
  class InputFiles
  {
  public:
    InputFiles() = default;

    /// @param entries text of all entries in effect, @param directory where relative names count
    /// from. Names of no file are passed over.
    InputFiles(const std::string &entries, const std::string &directory);

    /// @p text of a `.prm` with the names of the copies as the values of its entries. @param folder
    /// of the copies, relative to where the text is written.
    std::string with_copies(const std::string &text, const std::string &folder) const;

    /// A comment line for each entry: its path, a checksum of what it names with all that belongs
    /// to it, and where that lies.
    std::string fingerprints() const;

    /// Writes the copies; those that are there already, or are the files themselves, stay.
    void write(const std::string &folder) const;

    /// Whether @p path is one of the files.
    bool has(const std::string &path) const;

  private:
    struct Included
    {
      std::size_t begin, length; ///< of the name in the text
      std::size_t file;          ///< its number
    };

    struct File
    {
      std::string           path, content;
      std::vector<Included> included;
    };

    struct Entry
    {
      std::string path, value;
      std::size_t file;
    };

    std::size_t read(const std::string &path);
    std::string copy_of(std::size_t file) const;
    std::string content_of_copy(std::size_t file) const;
    void
    add_to_checksum(std::size_t file, std::vector<std::size_t> &done, std::uint64_t &sum) const;

    std::vector<File>  files;
    std::vector<Entry> entries;
    std::string        root; ///< that all files share
  };

  /// What fingerprints() has written, found in a text again: entry, checksum, path of the file.
  struct Fingerprint
  {
    std::string entry, checksum, path;
  };
  std::vector<Fingerprint> fingerprints_in(const std::string &text);

  /// The set entries of a `.prm` as the program prints it: "Section/Entry" and value.
  std::vector<std::pair<std::string, std::string>> entries_of_text(const std::string &text);
} // namespace axiforge
