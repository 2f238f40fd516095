// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::process
{
  /**
   * Sees where an operation uses its flow-stress table outside of what was measured, and says so at
   * the end. What counts is the share of the plastic work that is done there: dead zones are always
   * slower, and a corner always faster, than any table. A material without a table costs nothing.
   */
  class TableWatch
  {
  public:
    TableWatch(const scene::Scene &scene, bool quiet);

    /// After an accepted step of length @p time_step [s].
    void after_step(const State &state, double time_step);

    /// The warning, if there is reason for one. Collective.
    void tell(const State &state) const;

  private:
    const laws::FlowStressTable *table; ///< null: none
    bool                         quiet;
    double                       work = 0, work_outside = 0; ///< of this rank's cells, not scaled
    // Among the points that work hard, see hard_work in the source.
    double lowest_rate, highest_rate = 0, largest_strain = 0;
  };
} // namespace axiforge::process
