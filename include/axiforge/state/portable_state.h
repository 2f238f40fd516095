// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include <deal.II/grid/cell_id.h>

#include <axiforge/state/state.h>

/**
 * A state as plain numbers that do not depend on how its cells are shared out: what checkpoints
 * hold, and what is changed where a state is to be made anew on the same mesh.
 */
namespace axiforge::portable
{
  /// Before refinement; the same on all ranks.
  struct CoarseMesh
  {
    std::vector<Point>                       vertices; ///< [mm]
    std::vector<std::array<unsigned int, 4>> cells;    ///< vertices, lexicographic
    std::vector<std::array<unsigned int, 3>> lines;    ///< on the boundary: vertices and id
  };

  struct Edge
  {
    unsigned int side;
    EdgeFriction friction;
  };

  struct Cell
  {
    dealii::CellId::binary_type id;
    std::array<unsigned int, 9> nodes; ///< rows in the list of nodes
    std::array<double, 9>       strain;
    CellHistory                 history;
    std::vector<Edge>           edges;
  };

  struct BoundaryPart
  {
    NodeContact contact;
    /// Kept, because the nodes of the line have moved by rounding errors since it was found.
    Vector2 symmetry_normal;
  };

  struct Node
  {
    Vector2                   position, velocity;
    std::vector<BoundaryPart> boundary; ///< none or one
  };

  /// The locally owned part of a state.
  struct Part
  {
    std::vector<Node> nodes; ///< in the order of their global numbers
    std::vector<Cell> cells;
  };


  CoarseMesh coarse_mesh(const State &state);

  Part locally_owned_part(const State &state);

  /**
   * Makes mesh, fields and history of a state without a mesh. Collective.
   * @param parts of all ranks of the state that is put back
   * @param name of where they come from, for the message
   * @throws InputError if they make no mesh
   */
  void rebuild(const CoarseMesh        &mesh,
               const std::vector<Part> &parts,
               State                   &state,
               const std::string       &name);
} // namespace axiforge::portable
