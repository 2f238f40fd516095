// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/meshing/outline_mesh.h>

namespace axiforge::meshing
{
  /// Q2 nodes: the given middles on the boundary, straight edges inside, centres between them.
  void place_cell_nodes(NewMesh &made);

  /**
   * Topology that no position of the inner vertices could make sound is changed:
   * - an inner vertex of two cells goes, and they become one;
   * - where a boundary vertex has a single cell although the outline hardly turns (that cell would
   *   have an angle of some 180 degrees), the cells around the opposite corner are framed: they
   *   shrink, and a ring of new ones takes their rim. The vertex then has two cells. (To frame that
   *   cell alone leaves trapezoids of 1 : 4 and a worst scaled Jacobian of 0.15 to 0.2 instead of
   * 0.3 to 0.4.) Returns the number of changes. Expects and keeps boundary edges; sets the cells'
   * nodes.
   */
  unsigned int repair_topology(NewMesh &made);

  /// A row of cells along the whole boundary: every boundary vertex then has two cells or more, and
  /// every cell one boundary edge at most. Sets the cells' nodes.
  void add_boundary_row(NewMesh &made);

  /**
   * Moves the inner vertices to where the cells are best: the sum of 1 / h(d)^2 over corners and
   * inner points of the cells is smallest, with
   *
   *   d = 2 det J / |J|^2,   h(d) = (d + sqrt(d^2 + 4 delta^2)) / 2,
   *
   * vertex by vertex with Newton's method. d is 1 in a square and negative in an inverted cell;
   * delta > 0 only while there are such, which h then turns over (Escobar et al., Comput. Methods
   * Appl. Mech. Engrg. 192 (2003) 2775-2787). Boundary vertices stay. Sets the cells' nodes.
   */
  void smooth(NewMesh &made, unsigned int sweeps);
} // namespace axiforge::meshing
