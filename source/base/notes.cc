// SPDX-License-Identifier: GPL-2.0-or-later
#include <ostream>
#include <set>

#include <axiforge/base/notes.h>

namespace axiforge
{
  namespace
  {
    std::set<std::string>    noticed;
    std::vector<std::string> not_taken;
  } // namespace

  void note(const std::string &text)
  {
    if (noticed.insert(text).second)
      not_taken.push_back(text);
  }

  std::vector<std::string> take_notes()
  {
    std::vector<std::string> notes;
    notes.swap(not_taken);
    return notes;
  }

  void print_notes(std::ostream &out)
  {
    for (const std::string &text : take_notes())
      out << "Note: " << text << '\n';
  }
} // namespace axiforge
