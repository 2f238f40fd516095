// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace axiforge
{
  /**
   * Refuses a STEP file (ISO 10303-21) that is damaged: one without its end, or with references to
   * entities that it does not have. A reader passes over what it can't make and says nothing.
   */
  void check_step_text(const std::string &file, const std::string &entry);

  /// Refuses a STEP file of which fewer curves have come out than it has edges.
  void check_step_curves(const std::string &file, const std::string &entry, std::size_t n_curves);
} // namespace axiforge
