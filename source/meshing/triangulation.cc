// SPDX-License-Identifier: GPL-2.0-or-later
// From the mesh of the workpiece to deal.II's triangulation and position field.
#include <algorithm>
#include <utility>

#include <deal.II/base/exceptions.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/grid/grid_tools.h>

#include <axiforge/meshing/workpiece_mesh.h>

namespace axiforge::meshing
{
  namespace
  {
    /// End vertices of the edges of a cell, in the order of its faces and of FE_Q(2)'s edge nodes.
    constexpr std::array<std::array<unsigned int, 2>, 4> edge_vertices = {
      { { { 0, 2 } }, { { 1, 3 } }, { { 0, 1 } }, { { 2, 3 } } }
    };

    /// The node of @p nodes that stands at local node @p k of a cell with the vertices @p rotated,
    /// the same as @p original but in another order.
    const Point &node_of_rotated(const std::array<Point, 9>        &nodes,
                                 const std::array<unsigned int, 4> &original,
                                 const std::array<unsigned int, 4> &rotated,
                                 const unsigned int                 k)
    {
      if (k == 8)
        return nodes[8];
      if (k < 4)
        {
          const auto vertex = std::find(original.begin(), original.end(), rotated[k]);
          AssertThrow(vertex != original.end(),
                      dealii::ExcMessage("The triangulation was not made from this mesh."));
          return nodes[vertex - original.begin()];
        }
      const auto wanted =
          std::minmax(rotated[edge_vertices[k - 4][0]], rotated[edge_vertices[k - 4][1]]);
      for (unsigned int e = 0; e < 4; ++e)
        if (std::minmax(original[edge_vertices[e][0]], original[edge_vertices[e][1]]) == wanted)
          return nodes[4 + e];
      AssertThrow(false, dealii::ExcMessage("The triangulation was not made from this mesh."));
      return nodes[8];
    }
  } // namespace

  void create_triangulation(const WorkpieceMesh                             &mesh,
                            dealii::parallel::distributed::Triangulation<2> &triangulation)
  {
    std::vector<dealii::CellData<2>> cells(mesh.cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c)
      cells[c].vertices.assign(mesh.cells[c].begin(), mesh.cells[c].end());
    dealii::GridTools::consistently_order_cells(cells);

    dealii::SubCellData boundary;
    for (const WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
      {
        dealii::CellData<1> line(2);
        line.vertices    = { edge.v0, edge.v1 };
        line.boundary_id = edge.id;
        boundary.boundary_lines.push_back(line);
      }
    triangulation.create_triangulation(mesh.vertices, cells, boundary);
  }

  void interpolate_geometry(const WorkpieceMesh                                &mesh,
                            const dealii::DoFHandler<2>                        &dof_handler,
                            dealii::LinearAlgebra::distributed::Vector<double> &position)
  {
    const dealii::FiniteElement<2> &element = dof_handler.get_fe();
    AssertThrow(element.n_components() == 2 && element.n_dofs_per_cell() == 18 &&
                    dof_handler.get_triangulation().n_levels() == 1,
                dealii::ExcMessage("The geometry goes to FE_Q(2) x 2 on the unrefined mesh."));

    const dealii::IndexSet                      &owned = dof_handler.locally_owned_dofs();
    std::vector<dealii::types::global_dof_index> dofs(18);
    for (const auto &cell : dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          const unsigned int          c = cell->index(); // on level 0: as in the input
          std::array<unsigned int, 4> vertices;
          for (unsigned int v = 0; v < 4; ++v)
            vertices[v] = cell->vertex_index(v);
          cell->get_dof_indices(dofs);
          for (unsigned int i = 0; i < 18; ++i)
            {
              const auto [component, node] = element.system_to_component_index(i);
              if (owned.is_element(dofs[i]))
                position(dofs[i]) =
                    node_of_rotated(mesh.cell_nodes[c], mesh.cells[c], vertices, node)[component];
            }
        }
    position.update_ghost_values();
  }
} // namespace axiforge::meshing
