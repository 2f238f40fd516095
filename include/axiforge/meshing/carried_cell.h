// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <vector>

#include <axiforge/state/state.h>

namespace axiforge::meshing
{
  /// In place of a tool: the node was not there before.
  constexpr unsigned int new_node = no_tool - 1;

  /// What the three nodes (end, end, middle) of a boundary side carry through a change of the mesh.
  struct CarriedSide
  {
    bool                        on_boundary = false;
    std::array<double, 3>       traction{}, strain_rate{}, earlier_rate{}; ///< as in EdgeFriction
    bool                        has_layer = false;
    laws::SmmDual               layer{};
    std::array<unsigned int, 3> tool{ { no_tool, no_tool, no_tool } }; ///< that the node touches
  };

  /**
   * A cell with all that stands at its Gauss points and boundary sides, on its way to the cells
   * that take its place when the mesh is refined or coarsened. Plain bytes: it travels with the
   * cell from rank to rank.
   */
  struct CarriedCell
  {
    /// Values at the Gauss points: strain, stress (4), mean stress, rate, flow stress.
    static constexpr unsigned int                   n_quantities = 8;
    std::array<std::array<double, 9>, n_quantities> points;
    double                                          pressure = 0;  ///< at the centre [MPa]
    std::array<double, 2>                           centre, slope; ///< [mm], [MPa/mm]
    std::array<CarriedSide, 4>                      sides;
  };

  /// The row of each boundary side of the locally owned cells in MeshTables::edges; no_tool: none.
  std::vector<std::array<unsigned int, 4>> edges_of_cells(const State &state);

  CarriedCell
  carry(const State &state, unsigned int cell, const std::array<unsigned int, 4> &edges);

  /// The part of a cell that child c gets: polynomials kept in the range of the old cell, so that
  /// there are no new extremes and the strain is never negative; the pressure exactly.
  CarriedCell child_of(const State &state, const CarriedCell &cell, unsigned int c);

  /// A cell in place of its four children.
  CarriedCell parent_of(const State &state, const std::array<CarriedCell, 4> &children);

  /// Writes what was carried to a cell of the new mesh; the contacts of the nodes are not its
  /// business.
  void put_down(const CarriedCell                 &carried,
                State                             &state,
                unsigned int                       cell,
                const std::array<unsigned int, 4> &edges);
} // namespace axiforge::meshing
