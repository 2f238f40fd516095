// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace axiforge
{
  /// Estimated errors of the tool force in a step, relative to it; theory.md, section 18.
  struct ErrorEstimate
  {
    double space = 0, time = 0, regularisation = 0, nonlinear = 0;

    double total() const
    {
      return space + time + regularisation + nonlinear;
    }
  };

  /// What the estimates of the next steps depend on, and what the summary at the end says.
  struct AccuracyRecord
  {
    double       space_factor = 1;     ///< measured error over the recovery estimate
    bool         checked      = false; ///< since the mesh changed
    unsigned int last_check   = 0;     ///< step after which it was measured

    ErrorEstimate largest, sum; ///< largest of the steps, integral over the time [s]
    double        largest_total = 0, time = 0;
    unsigned int  steps = 0, above = 0; ///< with an estimate, and those above the target
  };
} // namespace axiforge
