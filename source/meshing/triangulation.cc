// SPDX-License-Identifier: GPL-2.0-or-later
// From the mesh of the workpiece to deal.II's triangulation and position field.
#include <algorithm>
#include <utility>

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>
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

  void share_from_first_rank(WorkpieceMesh &mesh, const MPI_Comm communicator)
  {
    if (dealii::Utilities::MPI::n_mpi_processes(communicator) == 1)
      return;

    // One list of numbers each for the geometry and the edges' topology.
    std::vector<Point> points = mesh.vertices;
    for (const std::array<Point, 9> &nodes : mesh.cell_nodes)
      points.insert(points.end(), nodes.begin(), nodes.end());
    std::vector<unsigned int> numbers = { static_cast<unsigned int>(mesh.vertices.size()),
                                          static_cast<unsigned int>(mesh.cells.size()) };
    for (const std::array<unsigned int, 4> &cell : mesh.cells)
      numbers.insert(numbers.end(), cell.begin(), cell.end());
    for (const WorkpieceMesh::BoundaryEdge &edge : mesh.boundary_edges)
      numbers.insert(numbers.end(), { edge.v0, edge.v1, static_cast<unsigned int>(edge.id) });

    points            = dealii::Utilities::MPI::broadcast(communicator, points, 0);
    numbers           = dealii::Utilities::MPI::broadcast(communicator, numbers, 0);
    mesh.boundary_ids = dealii::Utilities::MPI::broadcast(communicator, mesh.boundary_ids, 0);

    const unsigned int n_vertices = numbers[0], n_cells = numbers[1];
    mesh.vertices.assign(points.begin(), points.begin() + n_vertices);
    mesh.cells.resize(n_cells);
    mesh.cell_nodes.resize(n_cells);
    for (unsigned int c = 0; c < n_cells; ++c)
      {
        std::copy_n(points.begin() + n_vertices + 9 * c, 9, mesh.cell_nodes[c].begin());
        std::copy_n(numbers.begin() + 2 + 4 * c, 4, mesh.cells[c].begin());
      }
    mesh.boundary_edges.clear();
    for (std::size_t i = 2 + 4 * n_cells; i < numbers.size(); i += 3)
      mesh.boundary_edges.push_back(
          { numbers[i], numbers[i + 1], static_cast<dealii::types::boundary_id>(numbers[i + 2]) });
  }

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
