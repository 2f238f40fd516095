// SPDX-License-Identifier: GPL-2.0-or-later
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <utility>

#include <deal.II/base/exceptions.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/errors.h>

namespace axiforge
{
  namespace
  {
    /// With the reason of the last failed system call.
    [[noreturn]] void throw_cannot_write(const std::string &path)
    {
      int reason = errno;
      // Streams lose the reason; a full disk is the usual one.
      std::error_code                   ignored;
      const std::filesystem::path       parent = std::filesystem::path(path).parent_path();
      const std::filesystem::space_info space =
          std::filesystem::space(parent.empty() ? "." : parent, ignored);
      if (reason == 0 && !ignored && space.available < 65536)
        reason = ENOSPC;
      throw ComputationError(fmt::format(
          "Cannot write \"{}\": {}. Check the output folder, its rights and the space left.", path,
          reason != 0 ? std::strerror(reason) : "unknown error"));
    }

    /// Flushes a file or folder to the disk; false with errno set if that fails.
    bool flush_to_disk(const std::string &path, const int flags)
    {
      const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
      if (descriptor < 0)
        return false;
      // Some network file systems cannot flush a folder and say EINVAL: nothing is lost by going
      // on.
      const bool done   = ::fsync(descriptor) == 0 || errno == EINVAL;
      const int  reason = errno;
      ::close(descriptor);
      errno = reason;
      return done;
    }

    std::string csv_field(const std::string &text)
    {
      if (text.find_first_of(",\"\r\n") == std::string::npos)
        return text;
      std::string quoted = "\"";
      for (const char c : text)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
      return quoted + "\"";
    }

    std::string csv_line(const std::vector<std::string> &fields)
    {
      std::string line;
      for (std::size_t i = 0; i < fields.size(); ++i)
        line += (i > 0 ? "," : "") + csv_field(fields[i]);
      return line + "\n";
    }

    /// One past the line end that closes the record which starts at @p start; npos if none does.
    std::size_t end_of_record(const std::string &text, const std::size_t start)
    {
      bool quoted = false;
      for (std::size_t i = start; i < text.size(); ++i)
        if (text[i] == '"')
          quoted = !quoted;
        else if (text[i] == '\n' && !quoted)
          return i + 1;
      return std::string::npos;
    }
  } // namespace

  AtomicFile::AtomicFile(const std::string &path)
      : path(path)
  {
    const std::filesystem::path target(path);
    temporary_path =
        (target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid()))
            .string();
    const std::string folder = target.parent_path().string();
    descriptor =
        ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor >= 0)
      {
        out.open(fmt::format("/proc/self/fd/{}", descriptor), std::ios::binary);
        if (out)
          return;
        ::close(descriptor);
        descriptor = -1;
        out.clear();
      }
    errno = 0;
    out.open(temporary_path, std::ios::binary | std::ios::trunc);
    if (!out)
      throw_cannot_write(path);
  }

  AtomicFile::~AtomicFile()
  {
    out.close();
    if (!committed)
      std::remove(temporary_path.c_str());
    if (descriptor >= 0)
      ::close(descriptor);
  }

  /// Gives the written file its temporary name, from which it can be renamed over another one.
  bool AtomicFile::get_name()
  {
    if (descriptor < 0)
      return flush_to_disk(temporary_path, O_RDONLY);
    if (::fsync(descriptor) != 0)
      return false;
    ::unlink(temporary_path.c_str()); // of a process of that number which was killed just here
    const std::string nameless = fmt::format("/proc/self/fd/{}", descriptor);
    if (::linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, temporary_path.c_str(), AT_SYMLINK_FOLLOW) ==
        0)
      return true;
    std::error_code error; // a file system that can't do this
    std::filesystem::copy_file(nameless, temporary_path, error);
    errno = error.value();
    return !error && flush_to_disk(temporary_path, O_RDONLY);
  }

  std::ostream &AtomicFile::stream()
  {
    return out;
  }

  void AtomicFile::commit()
  {
    AssertThrow(!committed, dealii::ExcMessage("AtomicFile::commit() was called twice."));
    errno = 0;
    out.flush();
    if (!out)
      throw_cannot_write(path);
    out.close();
    if (!out || !get_name() || std::rename(temporary_path.c_str(), path.c_str()) != 0)
      throw_cannot_write(path);
    committed = true;

    const std::string folder = std::filesystem::path(path).parent_path().string();
    if (!flush_to_disk(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY))
      throw_cannot_write(path);
  }

  void write_file_atomically(const std::string &path, const std::string &content)
  {
    AtomicFile file(path);
    file.stream() << content;
    file.commit();
  }

  std::string csv_number(const double value)
  {
    return fmt::format("{}", value);
  }

  CsvFile CsvFile::create(const std::string &path, const std::vector<std::string> &columns)
  {
    AssertThrow(!columns.empty(), dealii::ExcMessage("A table needs columns."));
    write_file_atomically(path, csv_line(columns));
    return CsvFile(path, columns.size(), 0);
  }

  CsvFile CsvFile::resume(const std::string              &path,
                          const std::vector<std::string> &columns,
                          const std::size_t               n_rows)
  {
    std::ifstream in(path, std::ios::binary);
    if (!in)
      throw InputError("Cannot continue \"" + path +
                       "\": the file cannot be read. Start the run anew, or put the file back.");
    std::ostringstream buffer;
    buffer << in.rdbuf();
    const std::string text   = buffer.str();
    const std::string header = csv_line(columns);
    if (text.compare(0, header.size(), header) != 0)
      throw InputError(
          "Cannot continue \"" + path +
          "\": its columns are not those of this scene. Write to another output folder.");

    std::size_t kept_rows = 0;
    std::size_t kept_size = header.size();
    while (kept_rows < n_rows)
      {
        const std::size_t end = end_of_record(text, kept_size);
        if (end == std::string::npos)
          break;
        kept_size = end;
        ++kept_rows;
      }
    if (n_rows != all_rows && kept_rows < n_rows)
      throw InputError(
          fmt::format("Cannot continue \"{}\": it has {} rows, the checkpoint was written "
                      "after {}. Start the run anew, or put the whole file back.",
                      path, kept_rows, n_rows));
    if (kept_size < text.size() && ::truncate(path.c_str(), static_cast<off_t>(kept_size)) != 0)
      throw_cannot_write(path);
    return CsvFile(path, columns.size(), kept_rows);
  }

  CsvFile::CsvFile(const std::string &path, const std::size_t n_columns, const std::size_t n_rows)
      : path(path)
      , descriptor(::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC))
      , n_columns(n_columns)
      , n_rows_(n_rows)
  {
    if (descriptor < 0)
      throw_cannot_write(path);
  }

  CsvFile::CsvFile(CsvFile &&other) noexcept
      : path(std::move(other.path))
      , descriptor(std::exchange(other.descriptor, -1))
      , n_columns(other.n_columns)
      , n_rows_(other.n_rows_)
  {
  }

  CsvFile &CsvFile::operator=(CsvFile &&other) noexcept
  {
    if (this != &other)
      {
        close();
        path       = std::move(other.path);
        descriptor = std::exchange(other.descriptor, -1);
        n_columns  = other.n_columns;
        n_rows_    = other.n_rows_;
      }
    return *this;
  }

  CsvFile::~CsvFile()
  {
    close();
  }

  void CsvFile::close()
  {
    if (descriptor >= 0)
      {
        ::fsync(descriptor);
        ::close(descriptor);
        descriptor = -1;
      }
  }

  void CsvFile::write_row(const std::vector<double> &values)
  {
    std::vector<std::string> fields;
    fields.reserve(values.size());
    for (const double value : values)
      fields.push_back(csv_number(value));
    write_row(fields);
  }

  void CsvFile::write_row(const std::vector<std::string> &fields)
  {
    AssertThrow(fields.size() == n_columns,
                dealii::ExcMessage(fmt::format("A row of {} values for the {} columns of \"{}\".",
                                               fields.size(), n_columns, path)));
    append_line(csv_line(fields));
    ++n_rows_;
  }

  std::size_t CsvFile::n_rows() const
  {
    return n_rows_;
  }

  void CsvFile::append_line(const std::string &line)
  {
    struct stat before;
    if (::fstat(descriptor, &before) != 0)
      throw_cannot_write(path);

    ssize_t written;
    do
      written = ::write(descriptor, line.data(), line.size());
    while (written < 0 && errno == EINTR);

    if (written == static_cast<ssize_t>(line.size()))
      return;
    const int reason = written < 0 ? errno : ENOSPC;
    if (written > 0 && ::ftruncate(descriptor, before.st_size) != 0)
      throw_cannot_write(path);
    errno = reason;
    throw_cannot_write(path);
  }
} // namespace axiforge
