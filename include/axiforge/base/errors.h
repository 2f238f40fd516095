// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace axiforge
{
  /**
   * Something the user wrote is wrong: an entry, a file, a mesh, a tool inside the workpiece. The
   * message is complete: it names the entry, its value, what is allowed and the way out. The
   * program prints it and ends with status 1.
   */
  class InputError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;

    /**
     * A message in the common form
     *
     *     Entry "Tool upper/Velocity" = "abc": <what is wrong>. Allowed: <...>. <way out>
     *
     * Empty parts are left out.
     */
    static InputError entry(const std::string &path,
                            const std::string &value,
                            const std::string &wrong,
                            const std::string &allowed = "",
                            const std::string &way_out = "");
  };

  /**
   * The input is sound but the computation can't go on (no convergence, an inverted cell). The
   * message says where, at which time and stroke, and what to try. Status 2.
   */
  class ComputationError : public std::runtime_error
  {
  public:
    using std::runtime_error::runtime_error;
  };
} // namespace axiforge
