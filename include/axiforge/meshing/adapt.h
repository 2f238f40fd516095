// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /// What a change of the mesh has done.
  struct AdaptReport
  {
    bool         changed         = false;
    unsigned int cells           = 0; ///< afterwards
    unsigned int refused         = 0; ///< families that were not coarsened, to keep the outline
    double       estimated_error = 0; ///< recovery estimate over the norm of the stress, before
    double       volume_change   = 0; ///< relative, by new nodes that are put on a tool
    double       missing_volume  = 0; ///< relative: what of all changes could not be given back
    double       strain_change   = 0; ///< relative, of the integral of the effective strain
  };

  /**
   * Error indicator of each active cell (index of the triangulation; zero on cells of other ranks):
   * eta^2 = int (S* - S):(S* - S) / (2 mu), with S the deviatoric stress at the Gauss points and S*
   * its recovered continuous field (Zienkiewicz and Zhu 1987); equation (26) of doc/theory.md [mW].
   * @param relative set to the root of sum eta^2 over int S:S / (2 mu)
   * @param smallest_rate eps0 [1/s]
   */
  dealii::Vector<float>
  error_indicators(const State &state, double smallest_rate, double &relative);

  /**
   * Refines and coarsens by the indicator and carries all of the state over: position and velocity
   * exactly on refinement, the quantities of the Gauss points by their polynomial, kept in the
   * range of the old cell (no new extremes, strain never negative). Coarsening that would move the
   * outline by more than 1e-6 of the edge is refused. New surface nodes inside a tool are put on
   * its profile; the volume that this takes is given back by the free surface (volume.h). The
   * FlowSolver has to be made anew if something changed. Collective.
   */
  AdaptReport adapt(const scene::Scene &scene, State &state);

  /// Which cells are divided and joined.
  struct Marking
  {
    dealii::Vector<float> indicators; ///< as of error_indicators(); empty: by the geometry alone
    double                refine_fraction = 0, coarsen_fraction = 0; ///< of their sum
  };

  /// The same by given indicators. Whatever these say, cells are divided where the geometry of the
  /// tools and the regions of the scene ask for it (geometry_marks.h).
  AdaptReport adapt(const scene::Scene &scene, State &state, const Marking &marking);

  /// Divides every cell, whatever the limits are.
  void refine_everywhere(const scene::Scene &scene, State &state);
} // namespace axiforge::meshing
