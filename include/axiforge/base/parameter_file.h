// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <deal.II/base/parameter_handler.h>

#include <axiforge/base/parameter_statements.h>

namespace axiforge
{
  /**
   * The text of a `.prm` file with its `include` lines resolved relative to the file that has them,
   * and the overrides of the command line applied after it.
   *
   * deal.II's own reader resolves includes against the working directory and reports an error with
   * the text of an exception. This one takes the same language (`subsection`, `end`, `set a = b`,
   * `include file`, comments from `#` on, a backslash at the end of a line joins the next one to
   * it; keywords all lower or all upper case) and keeps file and line of every statement, so that a
   * mistake is told in one line: where it is, what is wrong, what is allowed.
   *
   * Every `subsection` must be closed in the file that opens it, and may be opened again. The last
   * `set` of an entry counts; a file that gives an entry twice, with two values, is refused. A
   * comment that ends in a backslash does not join the next line.
   */
  class ParameterFile
  {
  public:
    /**
     * Reads @p path and the files it includes.
     *
     * @param overrides as given to `--set`: "Section/Sub section/Entry = value"; a name cannot
     * contain
     *   "/" or "=", a value cannot contain "#" or a line break. One of the geometry parameters is
     *   changed by "Section/Geometry parameters/NAME = value"; an override that replaces their list
     *   and drops some that the file gave is noted.
     *
     * Throws InputError if a file cannot be read or includes itself, if a line is no statement, if
     * subsections are not balanced, or if an override is malformed.
     */
    explicit ParameterFile(const std::string &path, const std::vector<std::string> &overrides = {});

    /// No file, overrides alone.
    explicit ParameterFile(const std::vector<std::string> &overrides);

    /**
     * Sets the entries of @p prm, which is at its top level, in the order of the file, overrides
     * last, and leaves it at its top level whether it throws or not.
     *
     * @param skip_undefined pass over entries and sections that are not declared: for the first of
     * two passes, when entries of the first tell which sections there are.
     *
     * Throws InputError with a message of one line for an unknown section or entry (with the names
     * that are known, and the nearest), for a value its pattern does not allow, and for whatever an
     * action of the entry throws.
     */
    void parse(dealii::ParameterHandler &prm, bool skip_undefined = false) const;

    /// The path as given.
    const std::string &path() const;

    /// The folder of the file, "." for a bare name: relative paths in the scene are relative to it.
    std::string directory() const;

    /// The file byte by byte as it was read, without includes and overrides.
    const std::string &text() const;

    /**
     * One file that says all: includes put in their places, each entry once with the value that
     * counts, in the place where it was first given; entries of overrides alone are appended as
     * sections. Comments are not kept.
     */
    std::string resolved_text() const;

    /// The entries that the section @p section (joined by "/") is given, each once.
    std::vector<std::string> entries_of(const std::string &section) const;

    /// Names of the sections at the top level that begin with the word @p family and a blank,
    /// without these, each once, in the order of the file: "upset" of "Operation upset".
    std::vector<std::string> sections_of_family(const std::string &family) const;

    /**
     * The file as one member of a family of sections sees it: everything that is in no section of
     * the family, then what stands in "FAMILY MEMBER", as if it stood at the top level, and last
     * the overrides of the command line for both. So the member's own entries win over the common
     * ones.
     */
    ParameterFile seen_by(const std::string &family, const std::string &member) const;

  private:
    void add_overrides(const std::vector<std::string> &overrides);

    /// Notes which names of the list so far an override of the whole list does not have.
    void note_dropped(const std::string &path, const Statement &list) const;

    std::string            path_;
    std::string            text_;
    std::vector<Statement> statements_;
    std::size_t            n_of_file_ = 0; ///< statements; those behind them are overrides
  };
} // namespace axiforge
