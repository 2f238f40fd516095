// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/meshing/outline.h>
#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  /// A mesh and what its boundary nodes know.
  struct NewMesh
  {
    WorkpieceMesh mesh;
    /// Nodes (v0, v1, middle) of mesh.boundary_edges.
    std::vector<std::array<NewNode, 3>> boundary;
    std::string                         fault; ///< why there is none; empty: it is sound
  };

  /**
   * Quadrilaterals within the loops: gmsh, with the boundary edges as they are given and sizes
   * inside by the field, Mesh.Algorithm 6 and 5 with Mesh.RecombinationAlgorithm 2, and 3 where
   * that gives no sound mesh. Each mesh is mended and smoothed (mesh_repair.h); if that does not
   * give good cells, a row of cells is put along the boundary and smoothed in turn. The first mesh
   * whose cells have Jacobians of 0.25 at all vertices and Gauss points is taken, or else the best.
   * Boundary edges are curved, inner ones straight. Not collective: for one rank, whose mesh is
   * then sent to the others.
   */
  NewMesh mesh_outline(const std::vector<NewLoop>                              &loops,
                       const SizeField                                         &field,
                       const std::map<std::string, dealii::types::boundary_id> &boundary_ids);

  /**
   * Moves the free nodes of the boundary along their directions until the body of revolution has
   * the volume [mm^3]; to 1e-13 of it. Returns false if no node may move or the way would be longer
   * than a fifth of an edge: the mesh is then as it was.
   */
  bool restore_volume(NewMesh &mesh, double volume, double edge_length);

  /// The determinant of the worst cell at vertices and Gauss points over the area of the cell.
  double smallest_scaled_jacobian(const WorkpieceMesh &mesh);
} // namespace axiforge::meshing
