// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <deal.II/base/timer.h>

#include <axiforge/meshing/adapt.h>
#include <axiforge/meshing/remesh.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/operation_summary.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge::process
{
  /// Lines for a log as well as for a terminal: one per step, on the first rank.
  class Progress
  {
  public:
    Progress(const scene::Scene &scene, bool quiet);

    void start(const State &state);
    void step(const StepRecord &record) const;
    void mesh(const meshing::AdaptReport &report) const;
    void remeshed(const State                 &state,
                  const std::string           &reason,
                  const meshing::RemeshResult &result) const;

    /// A line of its own.
    void say(const std::string &line) const;

    /// @param sum of the times of all steps; @param analyse seconds
    void
    end(const State &state, const StepTimes &sum, double analyse, const std::string &folder) const;

  private:
    const scene::Scene &scene;
    bool                quiet;
    double              start_time = 0; ///< of this run, which may continue another [s]
    unsigned int        start_step = 0;
    dealii::Timer       timer;
  };
} // namespace axiforge::process
