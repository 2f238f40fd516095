// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <string>

namespace axiforge
{
  /**
   * Does @p action in a child of this process and tells how that ended: empty if it came to its
   * end, with or without an exception, else words like "crashed (Segmentation fault)". What it
   * writes is lost. It must not use MPI. Where there can't be a child nothing is done.
   */
  std::string fate_of(const std::function<void()> &action);
} // namespace axiforge
