// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <axiforge/meshing/folding.h>
#include <axiforge/scene/scene.h>
#include <axiforge/state/step_record.h>

namespace axiforge::process
{
  /// Looks for folds after each step and does what `subsection Folding` says.
  class FoldWatch
  {
  public:
    FoldWatch(const scene::Scene &scene, bool quiet);

    /**
     * After an accepted step whose results are written. Collective.
     * @throws ComputationError if a fold is found and the scene says stop: place, stroke, what to
     * try
     */
    void after_step(const State &state, const StepRecord &record);

  private:
    const scene::Scene        &scene;
    bool                       quiet;
    std::vector<meshing::Fold> noted; ///< with 'warn', so that each place is told once
  };
} // namespace axiforge::process
