// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/scene/scene.h>
#include <axiforge/state/measures.h>
#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /**
   * Why the workpiece should have a new mesh now, by the entries of the section Remeshing; empty:
   * no need. After a remeshing the limits are relaxed to what the new mesh has, so that what a new
   * mesh can't mend does not call for another one in every step. Collective.
   */
  std::string reason_to_remesh(const scene::Scene &scene, const State &state);

  /// Whether the mesh still tells the shape of the workpiece, and that of the tools beside it.
  struct Soundness
  {
    double vertex_jacobian; ///< smallest at a vertex: below 0 the outline folds over there
    double penetration;     ///< largest depth of an edge inside a tool, over its length

    /// What a step has spoilt that a new mesh before it would have kept; empty: nothing.
    std::string lost_since(const Soundness &before) const;
  };

  /// @param time of the tools [s]. Collective.
  Soundness soundness(const scene::Scene &scene, const State &state, double time);

  /// What a remeshing did.
  struct RemeshResult
  {
    bool        done = false;
    std::string fault; ///< if not done: why; the state is as it was

    unsigned int cells_before = 0, cells = 0;
    double       jacobian_before = 0, jacobian = 0; ///< smallest at Gauss points and vertices
    double       volume          = 0;               ///< before [mm^3]
    double       volume_jump     = 0; ///< of the new outline, before the volume was restored [mm^3]
    bool         restored        = false; ///< false: there is no free surface, the jump stays
    double       strain_integral = 0, strain_jump = 0; ///< int strain dV and its change [mm^3]
  };

  /**
   * Gives the workpiece a new mesh in its present shape and carries all fields over: doc/theory.md,
   * section 11. The boundary keeps its names, nodes on tools stay on them, the volume is restored
   * by the free surface. Everything that looks into the state's mesh (FlowSolver) has to be made
   * anew. Collective.
   * @param size_factor on the element size, for another mesh than the one that did not help
   */
  RemeshResult remesh(const scene::Scene &scene, State &state, double size_factor = 1);

  /// One line for the screen.
  std::string describe(const RemeshResult &result);
} // namespace axiforge::meshing
