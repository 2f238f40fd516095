// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace axiforge
{
  /// What is left to say of an operation when it is over.
  struct OperationSummary
  {
    std::string  name;
    std::string  ended_by; ///< stroke, time, force, height, fill, full, steps
    unsigned int steps          = 0;
    double       time           = 0; ///< its own length [s], the dwell not counted
    double       stroke         = 0; ///< [mm]
    double       height         = 0; ///< of the workpiece [mm]
    double       fill           = 0; ///< share; 0 if it is not asked for
    double       force          = 0; ///< of the driving tool at the end [N]
    double       largest_force  = 0; ///< of the driving tool [N]
    double       work           = 0; ///< of all tools and boundaries [mJ]
    double       imbalance      = 0; ///< largest axial sum of the tools' forces over their largest
    double       volume_change  = 0; ///< relative, since the start of the first operation
    double       largest_strain = 0;
    double       largest_radius = 0; ///< [mm]
    unsigned int cells          = 0;
    unsigned int remeshings     = 0; ///< in this operation
    double       wall_seconds   = 0;
  };
} // namespace axiforge
