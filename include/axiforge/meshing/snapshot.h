// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /// What a boundary node carries over to another mesh. Numbers only, so that it can be sent.
  struct SurfaceNode
  {
    double tool[2]; ///< -1: no contact
    double pressure, slip, traction;
    double stored_traction, strain_rate, earlier_rate, previous_slip,
        has_previous; ///< EdgeFriction
  };

  /// A cell with all it knows, in the order of dealii::FE_Q(2) and of the 3 x 3 Gauss points.
  struct CellSnapshot
  {
    double id[4]; ///< dealii::CellId: the same whatever the number of ranks
    double position[9][2], velocity[9][2];
    double strain[9], stress[9][4], mean_stress[9], strain_rate[9], flow_stress[9];
    double error; ///< indicator eta^2 [mW], 0 if not asked for
  };

  /// A boundary edge, the workpiece on its left. Nodes: start, end, middle.
  struct EdgeSnapshot
  {
    double      cell_id[4], side, boundary;
    double      vertex[2]; ///< global numbers of start and end
    double      position[3][2];
    SurfaceNode node[3];
  };

  /**
   * The whole workpiece on every rank, in an order that does not depend on the number of ranks: a
   * meridian section has some thousands of cells of 1.3 kB each.
   */
  struct Snapshot
  {
    std::vector<CellSnapshot> cells;
    std::vector<EdgeSnapshot> edges;
  };

  /// @param errors indicators of the owned cells in the order of the tables, or none. Collective.
  Snapshot take_snapshot(const State &state, const std::vector<double> &errors = {});
} // namespace axiforge::meshing
