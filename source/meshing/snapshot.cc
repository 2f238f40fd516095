// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>

#include <deal.II/grid/cell_id.h>

#include <axiforge/base/collective.h>
#include <axiforge/meshing/snapshot.h>

namespace axiforge::meshing
{
  namespace
  {
    SurfaceNode surface_node(const NodeContact &contact, const EdgeFriction &friction, unsigned a)
    {
      SurfaceNode node;
      for (unsigned int i = 0; i < 2; ++i)
        node.tool[i] = contact.tool[i] == no_tool ? -1. : contact.tool[i];
      node.pressure        = contact.pressure;
      node.slip            = contact.slip;
      node.traction        = contact.traction;
      node.stored_traction = friction.traction[a];
      node.strain_rate     = friction.strain_rate[a];
      node.earlier_rate    = friction.earlier_rate[a];
      node.previous_slip   = friction.previous_slip[a];
      node.has_previous    = friction.has_previous[a];
      return node;
    }
  } // namespace


  Snapshot take_snapshot(const State &state, const std::vector<double> &errors)
  {
    Snapshot mine;
    for (unsigned int row = 0; row < state.tables.cells.size(); ++row)
      {
        CellSnapshot snapshot;
        const auto   id = state.tables.cell_ids[row].to_binary<2>();
        std::copy(id.begin(), id.end(), snapshot.id);
        for (unsigned int a = 0; a < 9; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            {
              const unsigned int dof  = 2 * state.tables.cells[row][a] + c;
              snapshot.position[a][c] = state.position.local_element(dof);
              snapshot.velocity[a][c] = state.velocity.local_element(dof);
            }
        const CellHistory &history = state.cell_history[row];
        for (unsigned int q = 0; q < 9; ++q)
          {
            snapshot.strain[q] = state.strain.local_element(state.tables.first_strain_dof[row] + q);
            std::copy(history.stress[q].begin(), history.stress[q].end(), snapshot.stress[q]);
            snapshot.mean_stress[q] = history.mean_stress[q];
            snapshot.strain_rate[q] = history.strain_rate[q];
            snapshot.flow_stress[q] = history.flow_stress[q];
          }
        snapshot.error = errors.empty() ? 0 : errors[row];
        mine.cells.push_back(snapshot);
      }

    const auto &partitioner = *state.position.get_partitioner();
    for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
      {
        const BoundaryEdge &edge = state.tables.edges[e];
        if (!edge.owned)
          continue;
        // The table runs upwards and to the right: turn left and top sides.
        const bool                        turned = edge.side == 0 || edge.side == 3;
        const std::array<unsigned int, 3> order  = { { turned ? 1u : 0u, turned ? 0u : 1u, 2u } };
        EdgeSnapshot                      snapshot;
        std::copy_n(mine.cells[edge.cell].id, 4, snapshot.cell_id);
        snapshot.side     = edge.side;
        snapshot.boundary = edge.id;
        for (unsigned int a = 0; a < 3; ++a)
          {
            const unsigned int b    = order[a];
            const Point        x    = state.node_position(edge.nodes[b]);
            snapshot.position[a][0] = x[0];
            snapshot.position[a][1] = x[1];
            snapshot.node[a] =
                surface_node(state.contacts[edge.boundary_nodes[b]], state.edge_friction[e], b);
            if (a < 2)
              snapshot.vertex[a] = partitioner.local_to_global(2 * edge.nodes[b]) / 2;
          }
        mine.edges.push_back(snapshot);
      }

    Snapshot all{ gather_rows(state.communicator, mine.cells),
                  gather_rows(state.communicator, mine.edges) };
    std::sort(all.cells.begin(), all.cells.end(), [](const auto &a, const auto &b) {
      return std::lexicographical_compare(a.id, a.id + 4, b.id, b.id + 4);
    });
    std::sort(all.edges.begin(), all.edges.end(), [](const auto &a, const auto &b) {
      if (!std::equal(a.cell_id, a.cell_id + 4, b.cell_id))
        return std::lexicographical_compare(a.cell_id, a.cell_id + 4, b.cell_id, b.cell_id + 4);
      return a.side < b.side;
    });
    return all;
  }
} // namespace axiforge::meshing
