// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <deal.II/base/types.h>
#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <axiforge/base/geometry.h>
#include <axiforge/base/geometry_parameters.h>

namespace axiforge::meshing
{
  /// Ids of the parts of the boundary every workpiece knows; other named parts follow from 3 on, in
  /// alphabetical order.
  constexpr dealii::types::boundary_id surface_id  = 0;
  constexpr dealii::types::boundary_id axis_id     = 1;
  constexpr dealii::types::boundary_id symmetry_id = 2;

  /**
   * The workpiece's meridian section as quadrilaterals with curved edges (9 nodes), as it comes
   * from gmsh and after all checks: every cell has positive orientation and a positive Jacobian,
   * the mesh is connected and conforming, r >= 0.
   */
  struct WorkpieceMesh
  {
    struct BoundaryEdge
    {
      unsigned int               v0, v1; ///< vertices
      dealii::types::boundary_id id;
    };

    std::vector<Point>                       vertices; ///< [mm]
    std::vector<std::array<unsigned int, 4>> cells; ///< vertices in deal.II's lexicographic order

    /// Q2 nodes of every cell [mm] in the order of dealii::FE_Q(2): 4 vertices, the middle of the
    /// left, right, bottom and top edge, the centre.
    std::vector<std::array<Point, 9>> cell_nodes;

    std::vector<BoundaryEdge> boundary_edges; ///< all of them

    /// Ids by name, those that occur only: "surface" (all that has no name), "axis", "symmetry",
    /// and the other physical curves on the boundary.
    std::map<std::string, dealii::types::boundary_id> boundary_ids;

    /// What was put right on the way, one line each.
    std::vector<std::string> notes;

    /// Volume of the body of revolution [mm^3], exact for the Q2 geometry (5 x 5 Gauss points).
    double volume() const;
  };

  /**
   * Read the workpiece the entries ask for: a `.geo`, `.step`, `.stp` or `.brep` is meshed by gmsh,
   * a
   * `.msh` is taken as it is.
   *
   * - Surface: the physical surface named by the entry, or the only surface of a file without
   *   physical surfaces. Other surfaces and curves (tools in the same file) are left out.
   * - Boundary: edges at r = 0 are the `axis` by themselves; a physical curve `axis` elsewhere is
   * an error. A `symmetry` has to be straight. Other physical curves keep their names, the rest is
   *   `surface`.
   * - Meshing: transfinite where the file says so, else quadrilaterals only. Curved edges get their
   *   middle nodes on the curve. Tried with gmsh 4.8.4 on a disc and a hub of 28 to 780 elements:
   *   Mesh.Algorithm = 6 with Mesh.RecombinationAlgorithm = 2 and Mesh.Smoothing = 10 (used here)
   * has mean scaled Jacobians of 0.92 to 0.95, the worst 0.60 to 0.73, and is the same to the last
   * bit every time; 5 with 2 is as good. 9 (packing of parallelograms) is not used: its mesh
   * depends on where the heap happens to be, it makes twice the elements asked for, and most meshes
   * of the hub had inverted ones. A .geo may ask for others, but for Mesh.Algorithm = 8, which
   * crashes and is replaced by 6. If triangles or corners with a sine below 0.1 are left, 6 with 3,
   * 5 with 2 and 5 with 3 are tried.
   *
   * Throws InputError for what is wrong with the entries, the file or the mesh. @p section is that
   * of the workpiece in the `.prm`, @p directory that of the `.prm`.
   *
   * The same input gives the same mesh to the last bit (but if the .geo asks for Mesh.Algorithm =
   * 9: for several ranks there is share_from_first_rank()).
   */
  WorkpieceMesh read_workpiece(const GeometryParameters &parameters,
                               const std::string        &section,
                               const std::string        &directory);

  /**
   * Replace @p mesh by that of rank 0, so that all ranks have the same to the last bit. Every rank
   * reads the file first, so that a fault in it ends all of them in the same way.
   */
  void share_from_first_rank(WorkpieceMesh &mesh, MPI_Comm communicator);

  /**
   * Make the coarse mesh of @p triangulation: same numbers of cells and vertices as in @p mesh, but
   * cells may have been rotated. Sets the boundary ids.
   */
  void create_triangulation(const WorkpieceMesh                             &mesh,
                            dealii::parallel::distributed::Triangulation<2> &triangulation);

  /**
   * Fill the position field [mm] of an FESystem(FE_Q(2), 2) on the coarse mesh made by
   * create_triangulation(), before any refinement, with the Q2 nodes. Every rank sets its own
   * unknowns; ghost values are updated.
   */
  void interpolate_geometry(const WorkpieceMesh                                &mesh,
                            const dealii::DoFHandler<2>                        &dof_handler,
                            dealii::LinearAlgebra::distributed::Vector<double> &position);
} // namespace axiforge::meshing
