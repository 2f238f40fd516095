// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/scene/scene.h>
#include <axiforge/state/operation_summary.h>

namespace axiforge::process
{
  /// The finished operations, a line each, as a table that is read on a screen and as Markdown.
  std::string summary_table(const std::vector<OperationSummary> &operations);

  /**
   * Writes `chain.csv` and `chain.md`, a row for each finished operation with its start and end on
   * the clock of the chain (dwells counted), to the folder. First rank only.
   */
  void write_summary(const std::string                         &folder,
                     const std::vector<scene::SceneParameters> &parameters,
                     const std::vector<OperationSummary>       &operations);
} // namespace axiforge::process
