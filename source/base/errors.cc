// SPDX-License-Identifier: GPL-2.0-or-later
#include <axiforge/base/errors.h>

namespace axiforge
{
  InputError InputError::entry(const std::string &path,
                               const std::string &value,
                               const std::string &wrong,
                               const std::string &allowed,
                               const std::string &way_out)
  {
    std::string text = "Entry \"" + path + "\" = \"" + value + "\": " + wrong + ".";
    if (!allowed.empty())
      text += " Allowed: " + allowed + ".";
    if (!way_out.empty())
      text += " " + way_out + ".";
    return InputError(text);
  }
} // namespace axiforge
