// SPDX-License-Identifier: GPL-2.0-or-later
#include <cstdlib>
#include <random>

#include <deal.II/distributed/solution_transfer.h>

#include <axiforge/base/collective.h>
#include <axiforge/base/errors.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/state/measures.h>

namespace axiforge::meshing
{
  scene::WorkpieceOutline outline_of(const WorkpieceMesh &mesh)
  {
    scene::WorkpieceOutline outline;
    outline.lower = outline.upper = mesh.vertices.front();
    std::map<std::pair<unsigned int, unsigned int>, Point> middle;
    constexpr unsigned int edges[4][2] = { { 0, 2 }, { 1, 3 }, { 0, 1 }, { 2, 3 } };
    for (unsigned int cell = 0; cell < mesh.cells.size(); ++cell)
      {
        for (const Point &x : mesh.cell_nodes[cell])
          for (unsigned int c = 0; c < 2; ++c)
            {
              outline.lower[c] = std::min(outline.lower[c], x[c]);
              outline.upper[c] = std::max(outline.upper[c], x[c]);
            }
        for (unsigned int side = 0; side < 4; ++side)
          {
            const unsigned int a                       = mesh.cells[cell][edges[side][0]],
                               b                       = mesh.cells[cell][edges[side][1]];
            middle[{ std::min(a, b), std::max(a, b) }] = mesh.cell_nodes[cell][4 + side];
          }
      }
    const auto id_of = [&](const std::string &name) {
      const auto found = mesh.boundary_ids.find(name);
      return found == mesh.boundary_ids.end() ? dealii::numbers::invalid_boundary_id
                                              : found->second;
    };
    for (const auto &entry : mesh.boundary_ids)
      if (entry.first != "axis" && entry.first != "symmetry" && entry.first != "surface")
        outline.boundary_names.push_back(entry.first);
    std::set<unsigned int> vertices;
    for (const auto &edge : mesh.boundary_edges)
      if (edge.id != id_of("axis") && edge.id != id_of("symmetry"))
        {
          vertices.insert(edge.v0);
          vertices.insert(edge.v1);
          outline.boundary_points.push_back(
              middle.at({ std::min(edge.v0, edge.v1), std::max(edge.v0, edge.v1) }));
          for (const std::string &name : outline.boundary_names)
            if (edge.id == mesh.boundary_ids.at(name))
              for (const Point &x : { outline.boundary_points.back(), mesh.vertices[edge.v0],
                                      mesh.vertices[edge.v1] })
                outline.named_points[name].push_back(x);
        }
    for (const unsigned int v : vertices)
      outline.boundary_points.push_back(mesh.vertices[v]);
    return outline;
  }


  scene::WorkpieceOutline outline_of(const State &state)
  {
    scene::WorkpieceOutline                           outline;
    std::map<dealii::types::boundary_id, std::string> name_of;
    for (const auto &[name, id] : state.boundary_ids)
      if (id != axis_id && id != symmetry_id && id != surface_id)
        {
          name_of[id] = name;
          outline.boundary_names.push_back(name);
        }

    // Numbers that can be sent: r, z, whether tools can touch, the named parts or -1.
    std::vector<std::array<double, 5>> mine;
    for (const BoundaryNode &node : state.tables.boundary_nodes)
      if (node.owned)
        {
          const Point x    = state.node_position(node.node);
          const auto  part = [&](const unsigned int i) {
            return name_of.count(node.prescribed[i]) ? static_cast<double>(node.prescribed[i])
                                                      : -1.;
          };
          mine.push_back({ { x[0], x[1], node.free_surface ? 1. : 0., part(0), part(1) } });
        }
    std::vector<std::array<double, 5>> all = gather_rows(state.communicator, mine);
    std::sort(all.begin(), all.end());

    outline.lower = Point(1e300, 1e300);
    outline.upper = Point(-1e300, -1e300);
    for (const auto &node : all)
      {
        const Point x(node[0], node[1]);
        for (unsigned int c = 0; c < 2; ++c)
          {
            outline.lower[c] = std::min(outline.lower[c], x[c]);
            outline.upper[c] = std::max(outline.upper[c], x[c]);
          }
        if (node[2] > 0)
          outline.boundary_points.push_back(x);
        for (const unsigned int i : { 3u, 4u })
          if (node[i] >= 0)
            outline.named_points[name_of.at(static_cast<dealii::types::boundary_id>(node[i]))]
                .push_back(x);
      }
    return outline;
  }


  void refine_at_start(State &state, const std::function<bool(const Point &)> &choose)
  {
    std::vector<dealii::types::global_dof_index> dofs(state.flow_element.n_dofs_per_cell());
    for (const auto &cell : state.flow_dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          cell->get_dof_indices(dofs);
          if (choose(Point(state.position(dofs[16]), state.position(dofs[17]))))
            cell->set_refine_flag();
        }
    state.triangulation.prepare_coarsening_and_refinement();
    dealii::parallel::distributed::SolutionTransfer<2, Field> transfer(state.flow_dofs);
    state.position.update_ghost_values();
    transfer.prepare_for_coarsening_and_refinement(state.position);
    state.triangulation.execute_coarsening_and_refinement();

    state.setup_dofs();
    state.position.zero_out_ghost_values();
    transfer.interpolate(state.position);
    state.position.update_ghost_values();
    state.setup_tables();
  }


  namespace
  {
    /**
     * For tests: moves each node by a share of the size given by the environment variable
     * AXIFORGE_DISTURB (1e-12, say), as another processor's rounding might. Nodes of the axis and
     * of symmetry lines are put back by setup_tables().
     */
    void disturb(State &state)
    {
      const char *text = std::getenv("AXIFORGE_DISTURB");
      if (!text)
        return;
      const double                           share = std::strtod(text, nullptr) * state.size;
      std::uniform_real_distribution<double> shift(-share, share);
      for (std::size_t i = 0; i < state.position.locally_owned_size(); ++i)
        {
          std::minstd_rand random(state.position.get_partitioner()->local_to_global(i) + 1);
          random.discard(3);
          state.position.local_element(i) += shift(random);
        }
      state.position.update_ghost_values();
      state.setup_tables();
    }
  } // namespace


  void
  make_initial_state(const WorkpieceMesh &mesh, const unsigned int refinement_levels, State &state)
  {
    create_triangulation(mesh, state.triangulation);
    state.boundary_ids = mesh.boundary_ids;
    state.setup_dofs();
    interpolate_geometry(mesh, state.flow_dofs, state.position);
    state.setup_tables();
    for (unsigned int level = 0; level < refinement_levels; ++level)
      refine_at_start(state, [](const Point &) { return true; });

    const auto outline = outline_of(mesh);
    state.size = std::max(outline.upper[0] - outline.lower[0], outline.upper[1] - outline.lower[1]);
    disturb(state);
    state.initial_volume = measure(state).volume;
  }
} // namespace axiforge::meshing
