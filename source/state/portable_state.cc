// SPDX-License-Identifier: GPL-2.0-or-later
#include <map>
#include <set>

#include <deal.II/base/mpi.h>

#include <axiforge/base/errors.h>
#include <axiforge/state/portable_state.h>

namespace axiforge::portable
{
  using dealii::CellId;

  CoarseMesh coarse_mesh(const State &state)
  {
    CoarseMesh mesh;
    for (const auto &cell : state.triangulation.cell_iterators_on_level(0))
      {
        std::array<unsigned int, 4> vertices;
        for (unsigned int v = 0; v < 4; ++v)
          {
            vertices[v] = cell->vertex_index(v);
            if (vertices[v] >= mesh.vertices.size())
              mesh.vertices.resize(vertices[v] + 1);
            mesh.vertices[vertices[v]] = cell->vertex(v);
          }
        mesh.cells.push_back(vertices);
        for (unsigned int side = 0; side < 4; ++side)
          if (cell->at_boundary(side))
            mesh.lines.push_back(
                { { cell->face(side)->vertex_index(0), cell->face(side)->vertex_index(1),
                    cell->face(side)->boundary_id() } });
      }
    return mesh;
  }


  Part locally_owned_part(const State &state)
  {
    const MeshTables &tables      = state.tables;
    const auto       &partitioner = *state.position.get_partitioner();
    Part              part;
    part.nodes.resize(tables.n_owned_nodes);
    for (unsigned int node = 0; node < tables.n_owned_nodes; ++node)
      for (unsigned int c = 0; c < 2; ++c)
        {
          part.nodes[node].position[c] = state.position.local_element(2 * node + c);
          part.nodes[node].velocity[c] = state.velocity.local_element(2 * node + c);
        }
    for (unsigned int b = 0; b < tables.boundary_nodes.size(); ++b)
      if (const BoundaryNode &node = tables.boundary_nodes[b]; node.owned)
        part.nodes[node.node].boundary.push_back({ state.contacts[b], node.symmetry_normal });

    part.cells.resize(tables.cells.size());
    for (unsigned int c = 0; c < part.cells.size(); ++c)
      {
        Cell &cell   = part.cells[c];
        cell.id      = tables.cell_ids[c].to_binary<2>();
        cell.history = state.cell_history[c];
        for (unsigned int a = 0; a < 9; ++a)
          {
            cell.nodes[a]  = partitioner.local_to_global(2 * tables.cells[c][a]) / 2;
            cell.strain[a] = state.strain.local_element(tables.first_strain_dof[c] + a);
          }
      }
    for (unsigned int e = 0; e < tables.edges.size(); ++e)
      if (const BoundaryEdge &edge = tables.edges[e]; edge.owned)
        part.cells[edge.cell].edges.push_back({ edge.side, state.edge_friction[e] });
    return part;
  }


  namespace
  {
    void make_triangulation(const CoarseMesh &mesh, const std::vector<Part> &parts, State &state)
    {
      std::vector<dealii::CellData<2>> cells(mesh.cells.size());
      for (std::size_t c = 0; c < cells.size(); ++c)
        cells[c].vertices.assign(mesh.cells[c].begin(), mesh.cells[c].end());
      dealii::SubCellData boundary;
      for (const auto &entry : mesh.lines)
        {
          dealii::CellData<1> line(2);
          line.vertices    = { entry[0], entry[1] };
          line.boundary_id = entry[2];
          boundary.boundary_lines.push_back(line);
        }
      state.triangulation.create_triangulation(mesh.vertices, cells, boundary);

      std::set<CellId> refined;
      for (const Part &part : parts)
        for (const Cell &cell : part.cells)
          {
            const CellId id(cell.id);
            const auto   way = id.get_child_indices();
            for (std::size_t n = 0; n < way.size(); ++n)
              refined.emplace(id.get_coarse_cell_id(),
                              std::vector<std::uint8_t>(way.begin(), way.begin() + n));
          }
      // Level by level: what is above a level of a balanced mesh is balanced, too, and nothing else
      // is refined.
      for (;;)
        {
          unsigned int n = 0;
          for (const auto &cell : state.triangulation.active_cell_iterators())
            if (cell->is_locally_owned() && refined.count(cell->id()))
              {
                cell->set_refine_flag();
                ++n;
              }
          if (dealii::Utilities::MPI::sum(n, state.communicator) == 0)
            return;
          state.triangulation.execute_coarsening_and_refinement();
        }
    }


    /// Puts the cells and nodes of the file into the places they have on this rank.
    class Placement
    {
    public:
      Placement(const std::vector<Part> &parts, const State &state, const std::string &path)
      {
        for (const Part &part : parts)
          {
            for (const Node &node : part.nodes)
              nodes.push_back(&node);
            for (const Cell &cell : part.cells)
              cells.emplace(CellId(cell.id), &cell);
          }
        bool fits = cells.size() == state.triangulation.n_global_active_cells() &&
                    nodes.size() == state.flow_dofs.n_dofs() / 2;
        for (const auto &entry : cells)
          for (const unsigned int node : entry.second->nodes)
            fits &= node < nodes.size();
        if (!fits)
          throw InputError("\"" + path + "\" is damaged: its cells make no mesh.");

        const auto &partitioner = *state.position.get_partitioner();
        node_of.resize(partitioner.locally_owned_size() / 2 + partitioner.n_ghost_indices() / 2);
        std::vector<dealii::types::global_dof_index> dofs(state.flow_element.n_dofs_per_cell());
        for (const auto &cell : state.flow_dofs.active_cell_iterators())
          if (!cell->is_artificial())
            {
              cell->get_dof_indices(dofs);
              for (unsigned int a = 0; a < 9; ++a)
                node_of[partitioner.global_to_local(dofs[2 * a]) / 2] =
                    nodes[at(cell->id()).nodes[a]];
            }
      }

      const Cell &at(const CellId &id) const
      {
        return *cells.at(id);
      }

      std::vector<const Node *> node_of; ///< of each local node

    private:
      std::vector<const Node *>      nodes;
      std::map<CellId, const Cell *> cells;
    };


    void fill(const std::vector<Part> &parts, State &state, const std::string &path)
    {
      const Placement placement(parts, state, path);
      for (unsigned int node = 0; node < state.position.locally_owned_size() / 2; ++node)
        for (unsigned int c = 0; c < 2; ++c)
          {
            const Node &stored                         = *placement.node_of[node];
            state.position.local_element(2 * node + c) = stored.position[c];
            state.velocity.local_element(2 * node + c) = stored.velocity[c];
          }
      state.position.update_ghost_values();
      state.velocity.update_ghost_values();
      state.setup_tables();

      MeshTables &tables = state.tables;
      for (unsigned int b = 0; b < tables.boundary_nodes.size(); ++b)
        if (const Node &stored = *placement.node_of[tables.boundary_nodes[b].node];
            !stored.boundary.empty())
          {
            state.contacts[b]                        = stored.boundary[0].contact;
            tables.boundary_nodes[b].symmetry_normal = stored.boundary[0].symmetry_normal;
          }
      for (unsigned int c = 0; c < tables.cells.size(); ++c)
        {
          const Cell &stored    = placement.at(tables.cell_ids[c]);
          state.cell_history[c] = stored.history;
          for (unsigned int q = 0; q < 9; ++q)
            state.strain.local_element(tables.first_strain_dof[c] + q) = stored.strain[q];
        }
      for (unsigned int e = 0; e < tables.edges.size(); ++e)
        if (tables.edges[e].owned)
          for (const Edge &edge : placement.at(tables.cell_ids[tables.edges[e].cell]).edges)
            if (edge.side == tables.edges[e].side)
              state.edge_friction[e] = edge.friction;
    }
  } // namespace


  void rebuild(const CoarseMesh        &mesh,
               const std::vector<Part> &parts,
               State                   &state,
               const std::string       &name)
  {
    make_triangulation(mesh, parts, state);
    state.setup_dofs();
    fill(parts, state, name);
  }
} // namespace axiforge::portable
