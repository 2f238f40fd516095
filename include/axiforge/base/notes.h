// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace axiforge
{
  /**
   * Remembers something doubtful about the input that may be meant: one sentence or two, in one
   * line. Readers on all floors say what they notice; whoever runs the scene prints it. A text is
   * remembered once however often it is noticed, since files are read again at every operation.
   */
  void note(const std::string &text);

  /// The notes since the last call, in their order.
  std::vector<std::string> take_notes();

  /// Prints them, each as a line "Note: ...".
  void print_notes(std::ostream &out);
} // namespace axiforge
