// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <iostream>

#include <axiforge/base/errors.h>
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/process/fold_watch.h>
#include <axiforge/process/step.h>

namespace axiforge::process
{
  namespace
  {
    /// Folds within this share of the size are one that goes on.
    constexpr double same_fold = 0.05;


    /// Length of the step to come [s]; where there can be none, of the one before.
    double next_step(const scene::Scene &scene, const State &state, const StepRecord &record)
    {
      try
        {
          return choose_step_size(scene, state, record);
        }
      catch (const ComputationError &) // the next step will say so
        {
          return record.time_step;
        }
    }


    std::string stroke_of(const scene::Scene &scene, const State &state, const double time_left)
    {
      // Beyond the end nothing is known: tools stop, and a bore that closes at last does not
      // matter.
      return time_left > 0 && state.time + time_left <= scene.end_time()
                 ? fmt::format(", at about {:.6g} s, stroke {:.6g} mm, if it goes on "
                               "like this",
                               state.time + time_left, scene.stroke(state.time + time_left))
                 : "";
    }
  } // namespace


  FoldWatch::FoldWatch(const scene::Scene &scene, const bool quiet)
      : scene(scene)
      , quiet(quiet)
  {
  }


  void FoldWatch::after_step(const State &state, const StepRecord &record)
  {
    if (!optional_features || scene.folding.when_found == "off")
      return;
    const Phase phase("folds");
    const auto  fold =
        meshing::find_fold(state, next_step(scene, state, record), scene.folding.smallest_gap);
    if (!fold)
      return;
    const std::string what = fold->describe() + stroke_of(scene, state, fold->time_left);
    if (scene.folding.when_found == "stop")
      throw ComputationError(fmt::format(
          "The surface folds at time {:.6g} s, stroke {:.6g} mm, after step {}: {}. The workpiece "
          "has no contact with itself, so the run ends here; its results are sound up to this "
          "step. Change the preform or the tools (a wider groove, larger radii, another sequence), "
          "or \"Process/End stroke\"; \"Folding/When found = warn\" goes on as if the parts could "
          "pass through each other.",
          state.time, record.stroke, record.step, what));
    const bool known = std::any_of(noted.begin(), noted.end(), [&](const meshing::Fold &before) {
      return before.place.distance(fold->place) < same_fold * state.size;
    });
    noted.push_back(*fold);
    if (!known && !quiet)
      std::cout << fmt::format("Warning: the surface folds after step {}: {}\n", record.step, what)
                << std::flush;
  }
} // namespace axiforge::process
