// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/scene/scene.h>

namespace axiforge::study
{
  /// One run of a study.
  struct Variation
  {
    std::string              label;     ///< the value as given
    double                   number;    ///< the value as a number; `nan`: it is none
    std::vector<std::string> overrides; ///< "Section/Entry = value"
  };

  /// Where the quantities of runs are compared.
  enum class Place
  {
    end,
    strokes,
    whole_curve
  };

  /// `subsection Study`, checked.
  struct Plan
  {
    std::string              entry; ///< as given
    std::vector<Variation>   variations;
    double                   ratio; ///< 0: no convergence study
    std::vector<std::string> quantities;
    Place                    at;
    std::vector<double>      strokes; ///< [mm], ascending
    bool                     single_velocity_solve;
    std::vector<double>      references; ///< one per quantity, `nan`: none
  };

  /**
   * Reads the section. With no quantities given the list is empty, to be filled when the columns
   * are known (choose_quantities()).
   * @throws InputError that names entry, value, what is allowed and the way out
   */
  Plan make_plan(const scene::SceneParameters &scene);

  /**
   * Checks the quantities against the columns of history.csv, or takes those that a study has by
   * default, and brings `references` to their number.
   * @throws InputError that lists the columns
   */
  void choose_quantities(const scene::SceneParameters   &scene,
                         const std::vector<std::string> &columns,
                         Plan                           &plan);
} // namespace axiforge::study
