// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/tolerances.h>
#include <axiforge/state/state.h>

namespace axiforge
{
  using namespace dealii;

  namespace
  {
    /// Owned and ghost cells, coarse cell by coarse cell as in the triangulation, then by their
    /// ids. The order of deal.II's own iterators depends on how the mesh was refined, this one on
    /// the mesh alone.
    std::vector<DoFHandler<2>::active_cell_iterator> ordered_cells(const DoFHandler<2> &dof_handler)
    {
      std::map<std::pair<unsigned int, CellId>, DoFHandler<2>::active_cell_iterator> cells;
      for (const auto &cell : dof_handler.active_cell_iterators())
        if (!cell->is_artificial())
          {
            DoFHandler<2>::cell_iterator root = cell;
            while (root->level() > 0)
              root = root->parent();
            cells.emplace(std::make_pair(root->index(), cell->id()), cell);
          }
      std::vector<DoFHandler<2>::active_cell_iterator> list;
      for (const auto &entry : cells)
        list.push_back(entry.second);
      return list;
    }


    /// Numbers the unknowns of this rank as its cells come.
    void number_by_cells(DoFHandler<2> &dof_handler)
    {
      const IndexSet                       owned = dof_handler.locally_owned_dofs();
      std::vector<types::global_dof_index> dofs(dof_handler.get_fe().n_dofs_per_cell());
      std::vector<types::global_dof_index> number(owned.n_elements(), numbers::invalid_dof_index);
      types::global_dof_index              next = 0;
      for (const auto &cell : ordered_cells(dof_handler))
        if (cell->is_locally_owned())
          {
            cell->get_dof_indices(dofs);
            for (const auto dof : dofs)
              if (owned.is_element(dof))
                if (auto &n = number[owned.index_within_set(dof)]; n == numbers::invalid_dof_index)
                  n = owned.nth_index_in_set(next++);
          }
      dof_handler.renumber_dofs(number);
    }
  } // namespace


  State::State(const MPI_Comm comm)
      : communicator(comm)
      , triangulation(comm)
      , flow_element(FE_Q<2>(2), 2)
      , flow_dofs(triangulation)
      , history_element(QGauss<1>(3))
      , history_dofs(triangulation)
  {
  }


  void State::clear_mesh()
  {
    hanging_nodes.clear();
    flow_dofs.clear();
    history_dofs.clear();
    triangulation.clear();
    tables = MeshTables();
    cell_history.clear();
    contacts.clear();
    edge_friction.clear();
  }


  void State::setup_dofs()
  {
    flow_dofs.distribute_dofs(flow_element);
    history_dofs.distribute_dofs(history_element);
    number_by_cells(flow_dofs);
    number_by_cells(history_dofs);

    const IndexSet relevant = DoFTools::extract_locally_relevant_dofs(flow_dofs);
    position.reinit(flow_dofs.locally_owned_dofs(), relevant, communicator);
    velocity.reinit(position);

    const IndexSet relevant_history = DoFTools::extract_locally_relevant_dofs(history_dofs);
    strain.reinit(history_dofs.locally_owned_dofs(), relevant_history, communicator);

    hanging_nodes.clear();
    hanging_nodes.reinit(relevant);
    DoFTools::make_hanging_node_constraints(flow_dofs, hanging_nodes);
    hanging_nodes.close();
  }


  void State::setup_tables()
  {
    tables                  = MeshTables();
    const auto &partitioner = *position.get_partitioner();
    tables.n_owned_nodes    = partitioner.locally_owned_size() / 2;
    tables.n_nodes          = tables.n_owned_nodes + partitioner.n_ghost_indices() / 2;
    tables.n_global_cells   = triangulation.n_global_active_cells();

    // Node k has the unknowns 2k and 2k+1: FESystem numbers the two components of a support point
    // one after the other; everything here rests on it.
    std::vector<types::global_dof_index> dofs(flow_element.n_dofs_per_cell());
    std::vector<types::global_dof_index> history(history_element.n_dofs_per_cell());
    std::map<unsigned int, unsigned int> row_of_node;

    const types::boundary_id axis =
        boundary_ids.count("axis") ? boundary_ids.at("axis") : numbers::invalid_boundary_id;
    const types::boundary_id symmetry =
        boundary_ids.count("symmetry") ? boundary_ids.at("symmetry") : numbers::invalid_boundary_id;

    const types::boundary_id surface =
        boundary_ids.count("surface") ? boundary_ids.at("surface") : numbers::invalid_boundary_id;

    const unsigned int side_nodes[4][3] = { { 0, 2, 4 }, { 1, 3, 5 }, { 0, 1, 6 }, { 2, 3, 7 } };

    for (const auto &cell : ordered_cells(flow_dofs))
      {
        cell->get_dof_indices(dofs);
        std::array<unsigned int, 9> nodes;
        for (unsigned int a = 0; a < 9; ++a)
          {
            const unsigned int r = partitioner.global_to_local(dofs[2 * a]);
            AssertThrow(r % 2 == 0 && partitioner.global_to_local(dofs[2 * a + 1]) == r + 1,
                        ExcInternalError());
            nodes[a] = r / 2;
          }
        for (unsigned int side = 0; side < 4; ++side)
          if (cell->at_boundary(side))
            {
              BoundaryEdge edge;
              edge.owned = cell->is_locally_owned();
              edge.cell  = tables.cells.size();
              edge.side  = side;
              edge.id    = cell->face(side)->boundary_id();
              for (unsigned int a = 0; a < 3; ++a)
                {
                  const unsigned int node = nodes[side_nodes[side][a]];
                  edge.nodes[a]           = node;
                  const auto found        = row_of_node.emplace(node, tables.boundary_nodes.size());
                  if (found.second)
                    {
                      BoundaryNode entry{};
                      entry.node           = node;
                      entry.owned          = node < tables.n_owned_nodes;
                      entry.axis_neighbour = no_tool;
                      tables.boundary_nodes.push_back(entry);
                    }
                  edge.boundary_nodes[a] = found.first->second;
                }
              tables.edges.push_back(edge);
            }
        if (cell->is_locally_owned())
          {
            tables.cells.push_back(nodes);
            tables.cell_ids.push_back(cell->id());
            const DoFHandler<2>::active_cell_iterator history_cell(&triangulation, cell->level(),
                                                                   cell->index(), &history_dofs);
            history_cell->get_dof_indices(history);
            const unsigned int first = strain.get_partitioner()->global_to_local(history[0]);
            for (unsigned int q = 0; q < history.size(); ++q)
              AssertThrow(strain.get_partitioner()->global_to_local(history[q]) == first + q,
                          ExcInternalError());
            tables.first_strain_dof.push_back(first);
          }
      }

    // Directions of one line differ by no more than this.
    constexpr double line_direction = 1e-6;
    for (const BoundaryEdge &edge : tables.edges)
      for (const unsigned int b : edge.boundary_nodes)
        {
          BoundaryNode &node = tables.boundary_nodes[b];
          if (edge.id == axis)
            node.on_axis = true;
          else if (edge.id == symmetry)
            {
              node.on_symmetry     = true;
              const Vector2 along  = node_position(edge.nodes[1]) - node_position(edge.nodes[0]);
              node.symmetry_normal = Vector2({ -along[1], along[0] }) / along.norm();
              for (unsigned int c = 0; c < 2; ++c)
                if (std::abs(node.symmetry_normal[c]) < line_direction)
                  {
                    node.symmetry_normal[c]     = 0;
                    node.symmetry_normal[1 - c] = std::copysign(1., node.symmetry_normal[1 - c]);
                  }
            }
          else
            {
              node.free_surface = true;
              if (edge.id != surface && edge.id != node.prescribed[0])
                node.prescribed[node.prescribed[0] != numbers::invalid_boundary_id] = edge.id;
            }
        }

    // In an axisymmetric Q2 edge the node on the axis has weight zero: its reaction says nothing,
    // and the middle of its edge decides for it.
    for (const BoundaryEdge &edge : tables.edges)
      if (edge.id != axis)
        for (unsigned int a = 0; a < 2; ++a)
          if (tables.boundary_nodes[edge.boundary_nodes[a]].on_axis)
            tables.boundary_nodes[edge.boundary_nodes[a]].axis_neighbour = edge.boundary_nodes[2];

    contacts.assign(tables.boundary_nodes.size(), NodeContact());
    edge_friction.assign(tables.edges.size(), EdgeFriction());
    cell_history.assign(tables.cells.size(), CellHistory{});
    put_on_lines();
  }


  void State::put_on_lines()
  {
    // The lines r = 0, and r or z = const of the symmetry lines, whose nodes differ by round-off.
    std::vector<std::array<double, 2>> mine;
    double                             extent = size;
    for (const BoundaryNode &node : tables.boundary_nodes)
      {
        const Point x = node_position(node.node);
        if (size == 0)
          extent = std::max({ extent, std::abs(x[0]), std::abs(x[1]) });
        for (unsigned int c = 0; c < 2; ++c)
          if (node.owned && node.on_symmetry && std::abs(node.symmetry_normal[c]) == 1)
            mine.push_back({ { static_cast<double>(c), x[c] } });
      }
    extent                                   = Utilities::MPI::max(extent, communicator);
    std::vector<std::array<double, 2>> lines = gather_rows(communicator, mine);
    std::sort(lines.begin(), lines.end());
    const double close = tolerance::same_place * extent;
    const auto   line  = [&](const unsigned int c, const double x) {
      if (std::abs(x) < close)
        return 0.;
      const auto found =
          std::lower_bound(lines.begin(), lines.end(),
                              std::array<double, 2>{ { static_cast<double>(c), x - close } });
      return found != lines.end() && (*found)[0] == c && (*found)[1] < x ? (*found)[1] : x;
    };
    for (const BoundaryNode &node : tables.boundary_nodes)
      {
        if (node.on_axis)
          position.local_element(2 * node.node) = 0;
        if (node.on_symmetry)
          for (unsigned int c = 0; c < 2; ++c)
            if (std::abs(node.symmetry_normal[c]) == 1)
              {
                double &x = position.local_element(2 * node.node + c);
                x         = line(c, x);
              }
      }
  }


  void State::move_nodes(const Field &speed, const double duration)
  {
    for (std::size_t i = 0; i < position.locally_owned_size(); ++i)
      position.local_element(i) += duration * speed.local_element(i);
    for (const BoundaryNode &node : tables.boundary_nodes)
      if (node.on_axis && node.owned)
        position.local_element(2 * node.node) = 0;
    position.update_ghost_values();
  }
} // namespace axiforge
