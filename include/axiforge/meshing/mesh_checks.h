// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  /**
   * What is wrong with the cells of a mesh, in one sentence with the place, or an empty text:
   * r < 0; a Jacobian of the Q2 map that is not positive at a vertex or at one of the 3 x 3 Gauss
   * points; two vertices in one place; a vertex on the inside of another cell's boundary edge;
   * parts that are not connected. Expects vertices, cells, nodes and boundary edges to be filled.
   */
  std::string fault_of_mesh(const WorkpieceMesh &mesh);

  /// Determinant of the derivative of the Q2 map at a point of the unit cell [mm^2].
  double jacobian(const std::array<Point, 9> &nodes, const Point &unit_point);

  /// Length of the diagonal of the mesh's bounding box [mm].
  double size_of_mesh(const WorkpieceMesh &mesh);
} // namespace axiforge::meshing
