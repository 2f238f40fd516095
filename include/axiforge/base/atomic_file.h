// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <fstream>
#include <string>
#include <vector>

namespace axiforge
{
  /**
   * A file that appears whole or not at all: it is written without a name in the same folder, and
   * gets one by commit(). A run that is killed before leaves an older file of that name untouched,
   * and nothing behind; where the file system knows no files without a name (O_TMPFILE) at most a
   * temporary one (`.NAME.PID.tmp`).
   *
   *     AtomicFile file("solution_0001.vtu");
   *     data_out.write_vtu(file.stream());
   *     file.commit();
   *
   * Throws ComputationError with the file's name and the system's reason if anything cannot be
   * written (no such folder, no rights, disk full).
   */
  class AtomicFile
  {
  public:
    /// Begins the file; the folder must exist.
    explicit AtomicFile(const std::string &path);
    AtomicFile(const AtomicFile &)            = delete;
    AtomicFile &operator=(const AtomicFile &) = delete;

    /// Takes the temporary file away if commit() was not reached.
    ~AtomicFile();

    std::ostream &stream();

    /// Flushes to the disk (fsync) and renames. To be called once, last.
    void commit();

  private:
    bool get_name();

    std::string   path;
    std::string   temporary_path;
    int           descriptor = -1; ///< of the file without a name, if there are such
    std::ofstream out;
    bool          committed = false;
  };

  /// Writes @p content to @p path as an AtomicFile.
  void write_file_atomically(const std::string &path, const std::string &content);

  /// The shortest decimal number that reads back as exactly @p value: the same text on every
  /// machine.
  std::string csv_number(double value);

  /**
   * A CSV table that grows by a row at a time and is readable at any moment, also after a kill.
   *
   * Each row is handed to the system as one whole line in one write() at the end of the file: a
   * killed process has written a row or not. It isn't rewritten and renamed, which would cost more
   * with every row and make `tail -f` lose it; it is not fsynced at each row, which would cost more
   * than a small step and helps only against a power cut. What remains is recovered: if a write
   * stops half-way (disk full) the file is cut back to its last whole row before the error is
   * thrown, and resume() cuts off a line without an end.
   *
   * One object writes; on several ranks the first. Throws ComputationError if the file cannot be
   * written.
   */
  class CsvFile
  {
  public:
    /// A new table with the header alone; replaces an older file of that name at once.
    static CsvFile create(const std::string &path, const std::vector<std::string> &columns);

    /**
     * Continues a table: keeps its first @p n_rows whole rows (those up to a checkpoint; by default
     * all), cuts off the rest. Throws InputError if the file is missing, has another header or
     * fewer rows.
     */
    static CsvFile resume(const std::string              &path,
                          const std::vector<std::string> &columns,
                          std::size_t                     n_rows = all_rows);

    static constexpr std::size_t all_rows = static_cast<std::size_t>(-1);

    CsvFile(CsvFile &&other) noexcept;
    CsvFile &operator=(CsvFile &&other) noexcept;
    ~CsvFile();

    /// One row, a value per column, written as csv_number().
    void write_row(const std::vector<double> &values);

    /// One row of texts, a text per column; those with comma, quote or line break are quoted (RFC
    /// 4180).
    void write_row(const std::vector<std::string> &fields);

    /// The number of rows in the file, the header not counted.
    std::size_t n_rows() const;

  private:
    CsvFile(const std::string &path, std::size_t n_columns, std::size_t n_rows);
    void append_line(const std::string &line);
    void close();

    std::string path;
    int         descriptor = -1;
    std::size_t n_columns  = 0;
    std::size_t n_rows_    = 0;
  };
} // namespace axiforge
