// SPDX-License-Identifier: GPL-2.0-or-later
#include <utility>

#include <axiforge/base/collective.h>
#include <axiforge/state/measures.h>
#include <axiforge/state/portable_archive.h>
#include <axiforge/state/turn_over.h>

namespace axiforge
{
  namespace
  {
    /// The parts of all ranks, on every rank.
    std::vector<portable::Part> all_parts(const State &state)
    {
      BinaryWriter   writer;
      portable::Part mine = portable::locally_owned_part(state);
      writer(mine);
      const std::vector<std::string> texts = gather_on_first_rank(state.communicator, writer.text);
      BinaryWriter                   all;
      all.size_of(texts.size());
      for (const std::string &text : texts)
        all.text += text;
      share_text_of_first_rank(state.communicator, all.text);
      BinaryReader                reader(all.text, "state");
      std::vector<portable::Part> parts;
      reader(parts);
      return parts;
    }


    /// Exchange of the reference coordinates: of vertices and children, nodes, sides, Gauss points.
    constexpr unsigned int child_of[4] = { 0, 2, 1, 3 };
    constexpr unsigned int node_of[9]  = { 0, 2, 1, 3, 6, 7, 4, 5, 8 };
    constexpr unsigned int side_of[4]  = { 2, 3, 0, 1 };

    template <typename T> std::array<T, 9> exchanged(const std::array<T, 9> &points)
    {
      std::array<T, 9> result;
      for (unsigned int q = 0; q < 9; ++q)
        result[q] = points[q / 3 + 3 * (q % 3)];
      return result;
    }


    void exchange(portable::Cell &cell)
    {
      const dealii::CellId      id(cell.id);
      const auto                way = id.get_child_indices();
      std::vector<std::uint8_t> children;
      for (const auto child : way)
        children.push_back(child_of[child]);
      cell.id = dealii::CellId(id.get_coarse_cell_id(), children).to_binary<2>();

      const auto nodes = cell.nodes;
      for (unsigned int a = 0; a < 9; ++a)
        cell.nodes[a] = nodes[node_of[a]];
      cell.strain              = exchanged(cell.strain);
      cell.history.stress      = exchanged(cell.history.stress);
      cell.history.mean_stress = exchanged(cell.history.mean_stress);
      cell.history.strain_rate = exchanged(cell.history.strain_rate);
      cell.history.flow_stress = exchanged(cell.history.flow_stress);
      for (auto &stress : cell.history.stress)
        stress[3] *= -1;
      cell.history.pressure[2] *= -1;
      for (portable::Edge &edge : cell.edges)
        edge.side = side_of[edge.side];
    }
  } // namespace


  void let_go(State &state)
  {
    state.velocity = 0;
    state.velocity.update_ghost_values();
    for (NodeContact &contact : state.contacts)
      contact = NodeContact();
    for (EdgeFriction &friction : state.edge_friction)
      friction = EdgeFriction();
    state.accuracy       = AccuracyRecord();
    state.time           = 0;
    state.step           = 0;
    state.last_time_step = state.earlier_time_step = 0;
    state.remeshing.last_attempt                   = 0;
    state.remeshing.wanted_cells                   = 0;
  }


  void turn_over(State &state)
  {
    const Measures              size  = measure(state);
    const double                sum   = size.lowest + size.highest;
    portable::CoarseMesh        mesh  = portable::coarse_mesh(state);
    std::vector<portable::Part> parts = all_parts(state);

    for (Point &x : mesh.vertices)
      x[1] = sum - x[1];
    for (auto &cell : mesh.cells)
      std::swap(cell[1], cell[2]);
    for (portable::Part &part : parts)
      {
        for (portable::Cell &cell : part.cells)
          exchange(cell);
        for (portable::Node &node : part.nodes)
          {
            node.position[1] = sum - node.position[1];
            node.velocity[1] *= -1;
            for (portable::BoundaryPart &boundary : node.boundary)
              boundary.symmetry_normal[1] *= -1;
          }
      }
    state.clear_mesh();
    portable::rebuild(mesh, parts, state, "the workpiece turned over");
  }


  void move_axially(State &state, const double way)
  {
    for (std::size_t i = 1; i < state.position.locally_owned_size(); i += 2)
      state.position.local_element(i) += way;
    state.position.update_ghost_values();
  }
} // namespace axiforge
