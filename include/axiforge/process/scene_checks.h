// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::process
{
  /**
   * Whether anything will be formed, as far as it can be told before the first step: something
   * holds the workpiece along z or lies in its way, a moving tool reaches it, no tool lies inside
   * of it. Collective.
   * @return what is allowed but doubtful, one line each
   * @throws InputError that names the way out
   */
  std::vector<std::string> check_before_run(const scene::Scene            &scene,
                                            const scene::WorkpieceOutline &outline,
                                            const State                   &state);

  /**
   * Named curves of the workpiece that no operation uses: each gives a line.
   * @throws InputError if the name of one is all but "axis" or "symmetry": what was meant to be
   * held would be free
   */
  std::vector<std::string>
  check_curves(const std::vector<scene::SceneParameters>               &operations,
               const std::map<std::string, dealii::types::boundary_id> &curves);

  /**
   * Force [N] below which nothing is formed: a millionth of what it takes to yield the workpiece's
   * section. Rounding errors of a body that is carried along stay below.
   */
  double least_force(const scene::Scene &scene);
} // namespace axiforge::process
