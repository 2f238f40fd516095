// SPDX-License-Identifier: GPL-2.0-or-later
#include <fstream>
#include <set>
#include <sstream>

#include <deal.II/base/mpi.h>
#include <deal.II/grid/cell_id.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/binary_archive.h>
#include <axiforge/base/collective.h>
#include <axiforge/state/checkpoint.h>

namespace axiforge
{
  using dealii::CellId;

  namespace
  {
    /// To be raised with every change of what a file holds.
    constexpr std::uint32_t format_version = 2;
    const std::string       magic          = "AXIFORGE CHECKPOINT\n";
    constexpr std::uint32_t byte_order     = 0x01020304;

    /// Before refinement; the same on all ranks.
    struct CoarseMesh
    {
      std::vector<Point>                       vertices; ///< [mm]
      std::vector<std::array<unsigned int, 4>> cells;    ///< vertices, lexicographic
      std::vector<std::array<unsigned int, 3>> lines;    ///< on the boundary: vertices and id
    };

    struct Edge
    {
      unsigned int side;
      EdgeFriction friction;
    };

    struct Cell
    {
      CellId::binary_type         id;
      std::array<unsigned int, 9> nodes; ///< rows in the list of nodes
      std::array<double, 9>       strain;
      CellHistory                 history;
      std::vector<Edge>           edges;
    };

    struct BoundaryPart
    {
      NodeContact contact;
      /// Kept, because the nodes of the line have moved by rounding errors since it was found.
      Vector2 symmetry_normal;
    };

    struct Node
    {
      Vector2                   position, velocity;
      std::vector<BoundaryPart> boundary; ///< none or one
    };

    /// The locally owned part of a state.
    struct Part
    {
      std::vector<Node> nodes; ///< in the order of their global numbers
      std::vector<Cell> cells;
    };
  } // namespace


  // Every member stands in its function: one that is added and not named does not compile.
  template <typename Archive> void visit(Archive &archive, CellHistory &object)
  {
    auto &[pressure, stress, mean_stress, strain_rate, flow_stress] = object;
    archive(pressure, stress, mean_stress, strain_rate, flow_stress);
  }

  template <typename Archive> void visit(Archive &archive, NodeContact &object)
  {
    auto &[tool, face, normal, gap, reaction, slip, pressure, traction] = object;
    archive(tool, face, normal, gap, reaction, slip, pressure, traction);
  }

  template <typename Archive> void visit(Archive &archive, EdgeFriction &object)
  {
    auto &[traction, strain_rate, earlier_rate, previous_slip, has_previous, layer] = object;
    archive(traction, strain_rate, earlier_rate, previous_slip, has_previous, layer);
  }

  template <typename Archive> void visit(Archive &archive, ToolRecord &object)
  {
    auto &[force, radial_force, contact_radius, neutral_radius] = object;
    archive(force, radial_force, contact_radius, neutral_radius);
  }

  template <typename Archive> void visit(Archive &archive, BoundaryRecord &object)
  {
    auto &[force, power, pressure] = object;
    archive(force, power, pressure);
  }

  template <typename Archive> void visit(Archive &archive, StepTimes &object)
  {
    auto &[residual, assembly, factor, solve, contact, total] = object;
    archive(residual, assembly, factor, solve, contact, total);
  }

  template <typename Archive> void visit(Archive &archive, StepRecord &object)
  {
    auto &[step, time, time_step, stroke, tools, boundaries, gauges, volume, relative_volume_change,
           power_tools, power_boundaries, power_plastic, power_friction, power_contact,
           power_volume, power_residual, largest_strain, largest_strain_rate, smallest_jacobian,
           smallest_vertex_jacobian, largest_radius, cells, unknowns, iterations, set_changes,
           repeats, residual, divergence, times, remeshings, remeshing_volume_jump,
           remeshing_strain_jump] = object;
    archive(step, time, time_step, stroke, tools, boundaries, gauges, volume,
            relative_volume_change, power_tools, power_boundaries, power_plastic, power_friction,
            power_contact, power_volume, power_residual, largest_strain, largest_strain_rate,
            smallest_jacobian, smallest_vertex_jacobian, largest_radius, cells, unknowns,
            iterations, set_changes, repeats, residual, divergence, times, remeshings,
            remeshing_volume_jump, remeshing_strain_jump);
  }

  template <typename Archive> void visit(Archive &archive, ResultsProgress &object)
  {
    auto &[n_rows, last_step, field_files, tool_files, last_fields_step, last_fields_stroke,
           last_fields_time, wall_seconds] = object;
    archive(n_rows, last_step, field_files, tool_files, last_fields_step, last_fields_stroke,
            last_fields_time, wall_seconds);
  }

  template <typename Archive> void visit(Archive &archive, CheckpointExtras &object)
  {
    auto &[parameters, record, results] = object;
    archive(parameters, record, results);
  }

  /// The numbers of the state that belong to no cell and no node.
  template <typename Archive> void visit(Archive &archive, RemeshingRecord &object)
  {
    auto &[count, volume_jump, strain_jump, wanted_cells, last_attempt, jacobian, vertex_jacobian,
           penetration] = object;
    archive(count, volume_jump, strain_jump, wanted_cells, last_attempt, jacobian, vertex_jacobian,
            penetration);
  }

  template <typename Archive> void visit_numbers(Archive &archive, State &state)
  {
    archive(state.boundary_ids, state.time, state.step, state.last_time_step,
            state.earlier_time_step, state.initial_volume, state.size, state.remeshing);
  }

  namespace
  {
    template <typename Archive> void visit(Archive &archive, CoarseMesh &object)
    {
      auto &[vertices, cells, lines] = object;
      archive(vertices, cells, lines);
    }

    template <typename Archive> void visit(Archive &archive, Edge &object)
    {
      auto &[side, friction] = object;
      archive(side, friction);
    }

    template <typename Archive> void visit(Archive &archive, Cell &object)
    {
      auto &[id, nodes, strain, history, edges] = object;
      archive(id, nodes, strain, history, edges);
    }

    template <typename Archive> void visit(Archive &archive, BoundaryPart &object)
    {
      auto &[contact, symmetry_normal] = object;
      archive(contact, symmetry_normal);
    }

    template <typename Archive> void visit(Archive &archive, Node &object)
    {
      auto &[position, velocity, boundary] = object;
      archive(position, velocity, boundary);
    }

    template <typename Archive> void visit(Archive &archive, Part &object)
    {
      auto &[nodes, cells] = object;
      archive(nodes, cells);
    }


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


    /// The content of a file behind its head, which is checked.
    std::string read_content(const std::string &path)
    {
      std::ifstream in(path, std::ios::binary);
      if (!in)
        throw InputError("There is no checkpoint \"" + path +
                         "\", or it cannot be read. Name the folder of the results or the file "
                         "behind --resume, or start without it.");
      std::ostringstream buffer;
      buffer << in.rdbuf();
      const std::string text = buffer.str();
      if (text.compare(0, magic.size(), magic) != 0)
        throw InputError("\"" + path +
                         "\" is no checkpoint of axiforge. Name the folder of the results or its "
                         "checkpoint.axi behind --resume.");
      const std::string head = text.substr(0, magic.size() + 2 * 4 + 2 * 8);
      const std::string body = head.substr(magic.size());
      BinaryReader      reader(body, path);
      std::uint32_t     order = 0, version = 0;
      std::uint64_t     size = 0, sum = 0;
      reader(order, version, size, sum);
      if (order != byte_order || version != format_version)
        throw InputError(
            order != byte_order
                ? "\"" + path + "\" was written on a machine with another order of bytes."
                : fmt::format("\"{}\" was written by another version of the program: its format "
                              "is {}, this one reads {}. Continue with the version in versions.txt "
                              "beside it.",
                              path, version, format_version));
      const std::string content = text.substr(head.size());
      const std::string way_out =
          " The one before it is kept as checkpoint.old.axi: try --resume with that file.";
      if (content.size() != size)
        throw InputError(fmt::format("\"{}\" is damaged: it has {} bytes of content, {} were "
                                     "written.{}",
                                     path, content.size(), size, way_out));
      if (checksum(content) != sum)
        throw InputError("\"" + path + "\" is damaged: its checksum does not fit." + way_out);
      return content;
    }
  } // namespace


  void save_checkpoint(const State &state, const CheckpointExtras &extras, const std::string &path)
  {
    BinaryWriter mine;
    Part         part = locally_owned_part(state);
    mine(part);
    const std::vector<std::string> parts = gather_on_first_rank(state.communicator, mine.text);
    on_first_rank(state.communicator, [&] {
      // The writer reads only.
      BinaryWriter content;
      content(const_cast<CheckpointExtras &>(extras));
      visit_numbers(content, const_cast<State &>(state));
      CoarseMesh mesh = coarse_mesh(state);
      content(mesh);
      content.size_of(parts.size());
      for (const std::string &text : parts)
        content.text += text;

      BinaryWriter  head;
      std::uint32_t order = byte_order, version = format_version;
      std::uint64_t size = content.text.size(), sum = checksum(content.text);
      head(order, version, size, sum);
      AtomicFile file(path);
      file.stream() << magic << head.text << content.text;
      file.commit();
    });
  }


  CheckpointExtras load_checkpoint(State &state, const std::string &path)
  {
    std::string content;
    on_first_rank(state.communicator, [&] { content = read_content(path); });
    share_text_of_first_rank(state.communicator, content);

    BinaryReader     reader(content, path);
    CheckpointExtras extras;
    CoarseMesh       mesh;
    reader(extras);
    visit_numbers(reader, state);
    std::vector<Part> parts;
    reader(mesh, parts);
    make_triangulation(mesh, parts, state);
    state.setup_dofs();
    fill(parts, state, path);
    return extras;
  }
} // namespace axiforge
