// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/scene/scene.h>
#include <axiforge/state/step_record.h>

namespace axiforge::process
{
  /// Force, height and fill count as reached within this share of their limit.
  constexpr double end_tolerance = 1e-3;

  /**
   * How far the most advanced of the limits on force, height and fill is passed after a step, over
   * the limit: negative before, 0 at it; -1 if there is no such limit.
   */
  double passed_end(const scene::Scene &scene, const StepRecord &record);

  /// The die is full if what the driving tool can still go is this share of its stroke.
  constexpr double filled = 1e-3;

  /// The same where a step has failed, as the last ones before a die is full may do.
  constexpr double nearly_filled = 2e-3;

  /// Whether the die is full to this share of the stroke.
  bool is_full(const scene::Scene &scene, const StepRecord &record, double share);

  /// What has ended the operation after this step: "force", "height", "fill", "full" (the die),
  /// "stroke", "time" or "steps"; empty: it goes on.
  std::string ended_by(const scene::Scene &scene, const StepRecord &record);
} // namespace axiforge::process
