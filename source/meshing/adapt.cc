// SPDX-License-Identifier: GPL-2.0-or-later
#include <cstring>
#include <limits>

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/grid_refinement.h>
#include <deal.II/distributed/solution_transfer.h>

#include <axiforge/meshing/adapt.h>
#include <axiforge/meshing/carried_cell.h>
#include <axiforge/meshing/geometry_marks.h>
#include <axiforge/meshing/volume.h>
#include <axiforge/state/measures.h>
#include <axiforge/state/recovery.h>

namespace axiforge::meshing
{
  using namespace dealii;
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    const Point &gauss_point(const State &state, const unsigned int q)
    {
      return state.history_element.get_unit_support_points()[q];
    }


    std::vector<char> packed(const std::vector<CarriedCell> &cells)
    {
      static_assert(std::is_trivially_copyable_v<CarriedCell>);
      std::vector<char> bytes(cells.size() * sizeof(CarriedCell));
      std::memcpy(bytes.data(), cells.data(), bytes.size());
      return bytes;
    }


    /// Row in the tables of each active cell that is owned here.
    std::vector<unsigned int> rows_of_cells(const State &state)
    {
      std::vector<unsigned int> rows(state.triangulation.n_active_cells(), no_tool);
      for (unsigned int row = 0; row < state.tables.cell_ids.size(); ++row)
        rows[state.triangulation.create_cell_iterator(state.tables.cell_ids[row])
                 ->active_cell_index()] = row;
      return rows;
    }


    /// Coarsening that would move the outline is taken back; returns how many families.
    unsigned int keep_outline(State &state)
    {
      constexpr unsigned int side_nodes[4][3] = {
        { 0, 2, 4 }, { 1, 3, 5 }, { 0, 1, 6 }, { 2, 3, 7 }
      };
      std::vector<types::global_dof_index> dofs(state.flow_element.n_dofs_per_cell());
      unsigned int                         refused = 0;
      for (const auto &parent : state.flow_dofs.cell_iterators())
        {
          if (parent->is_active() || !parent->at_boundary())
            continue;
          bool all = true;
          for (unsigned int c = 0; c < parent->n_children(); ++c)
            all &= parent->child(c)->is_active() && parent->child(c)->is_locally_owned() &&
                   parent->child(c)->coarsen_flag_set();
          if (!all)
            continue;
          bool moves = false;
          for (unsigned int side = 0; side < 4; ++side)
            if (parent->at_boundary(side))
              {
                // Nodes of the two halves: end, middle, common, middle, end.
                std::array<Point, 5> x;
                for (unsigned int half = 0; half < 2; ++half)
                  {
                    const auto child = parent->child(GeometryInfo<2>::child_cell_on_face(
                        RefinementCase<2>::isotropic_refinement, side, half));
                    child->get_dof_indices(dofs);
                    for (unsigned int a = 0; a < 3; ++a)
                      for (unsigned int c = 0; c < 2; ++c)
                        x[2 * half + (a == 0   ? 0
                                      : a == 1 ? 2
                                               : 1)][c] =
                            state.position(dofs[2 * side_nodes[side][a] + c]);
                  }
                const Vector2 chord = x[4] - x[0];
                const Vector2 first = x[1] - (0.375 * x[0] + 0.75 * x[2] - 0.125 * x[4]);
                const Vector2 last  = x[3] - (-0.125 * x[0] + 0.75 * x[2] + 0.375 * x[4]);
                moves |= std::max(first.norm(), last.norm()) > 1e-6 * chord.norm();
              }
          if (moves)
            {
              ++refused;
              for (unsigned int c = 0; c < parent->n_children(); ++c)
                parent->child(c)->clear_coarsen_flag();
            }
        }
      return MPI::sum(refused, state.communicator);
    }


    /**
     * The tool that each boundary node of the new mesh touches. A node of the old mesh keeps its
     * own; a new one, which is the middle of an edge between old nodes, touches the tool that both
     * of them touch.
     * @param known per owned side, what its old nodes touch
     */
    struct Touching
    {
      std::vector<unsigned int> tool;   ///< no_tool: none
      std::vector<bool>         is_new; ///< per boundary node
    };

    Touching find_touching(const scene::Scene             &scene,
                           const State                    &state,
                           const std::vector<CarriedSide> &carried_sides)
    {
      // Every rank tells what it knows of its own edges: 0 nothing, 1 open, 2 + tool.
      Field known(state.velocity);
      known = 0;
      for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
        if (carried_sides[e].on_boundary)
          for (unsigned int a = 0; a < 3; ++a)
            if (const unsigned int tool = carried_sides[e].tool[a]; tool != new_node)
              known.local_element(2 * state.tables.edges[e].nodes[a]) =
                  tool == no_tool ? 1. : 2. + tool;
      known.compress(VectorOperation::max);
      known.update_ghost_values();

      Touching touching;
      for (const BoundaryNode &node : state.tables.boundary_nodes)
        {
          const double value = known.local_element(2 * node.node);
          touching.is_new.push_back(value == 0);
          touching.tool.push_back(value < 2 ? no_tool : static_cast<unsigned int>(value - 2));
        }
      // The contacts may be those that a step will end with: it has to touch now.
      const auto touches_now = [&](const unsigned int b, const unsigned int tool) {
        std::array<tools::Contact, 2> found;
        return scene.tools[tool].profile.find(
                   Point(state.node_position(state.tables.boundary_nodes[b].node) -
                         scene.tools[tool].motion.displacement(state.time)),
                   1e-6 * scene.size, found) > 0;
      };
      const std::vector<unsigned int> old = touching.tool;
      for (const BoundaryEdge &edge : state.tables.edges)
        {
          const auto &[begin, end, middle] = edge.boundary_nodes;
          const unsigned int tool          = old[begin];
          if (touching.is_new[middle] && tool != no_tool && old[end] == tool &&
              touches_now(begin, tool) && touches_now(end, tool))
            touching.tool[middle] = tool;
        }
      return touching;
    }


    /// Slip of a node along its first contact [mm/s].
    double slip_of(const scene::Scene &scene, const State &state, const unsigned int b)
    {
      const NodeContact &contact = state.contacts[b];
      const Vector2      speed   = scene.tools[contact.tool[0]].motion.velocity(state.time);
      const Vector2      tangent({ -contact.normal[0][1], contact.normal[0][0] });
      double             slip = 0;
      for (unsigned int c = 0; c < 2; ++c)
        slip +=
            (state.velocity.local_element(2 * state.tables.boundary_nodes[b].node + c) - speed[c]) *
            tangent[c];
      return slip;
    }


    /// Puts new surface nodes between touching ones, and those inside a tool, on its profile, and
    /// fills the contacts of all nodes.
    void find_contacts(const scene::Scene &scene, State &state, const Touching &touching)
    {
      const double close = 1e-7 * scene.size;
      for (unsigned int b = 0; b < state.tables.boundary_nodes.size(); ++b)
        {
          const BoundaryNode &node    = state.tables.boundary_nodes[b];
          NodeContact        &contact = state.contacts[b];
          if (!node.free_surface || (touching.tool[b] == no_tool && !touching.is_new[b]))
            continue;
          // The tool that it touches for sure comes first.
          for (const bool sure : { true, false })
            for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
              {
                if ((touching.tool[b] == tool) != sure)
                  continue;
                const Vector2 shift = scene.tools[tool].motion.displacement(state.time);
                std::array<tools::Contact, 2> found;
                const unsigned int            n = scene.tools[tool].profile.find(
                               Point(state.node_position(node.node) - shift),
                    sure ? std::numeric_limits<double>::max() : close, found);
                for (unsigned int i = 0; i < n; ++i)
                  {
                    const unsigned int slot = contact.active() ? 1 : 0;
                    if (contact.tool[slot] != no_tool || (i > 0 && found[i].gap > close))
                      continue;
                    contact.tool[slot]   = tool;
                    contact.face[slot]   = found[i].face;
                    contact.normal[slot] = found[i].normal;
                    if (i == 0 && touching.is_new[b] && (sure || found[i].gap < 0))
                      for (unsigned int c = 0; c < 2; ++c)
                        state.position.local_element(2 * node.node + c) -=
                            found[i].gap * found[i].normal[c];
                  }
              }
          if (contact.active())
            contact.slip = slip_of(scene, state, b);
        }
      state.position.update_ghost_values();
      // Nothing is "the last step" before the first one.
      for (unsigned int e = 0; e < state.tables.edges.size() && state.step > 0; ++e)
        for (unsigned int a = 0; a < 3; ++a)
          {
            const NodeContact &contact = state.contacts[state.tables.edges[e].boundary_nodes[a]];
            state.edge_friction[e].has_previous[a]  = contact.active();
            state.edge_friction[e].previous_slip[a] = contact.slip;
          }
    }


    double strain_integral(const State &state)
    {
      double sum = 0;
      for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
        sum += integral(state, cell, [&](const unsigned int q) {
          return state.strain.local_element(state.tables.first_strain_dof[cell] + q);
        });
      return MPI::sum(sum, state.communicator);
    }


    /// Does what the flags of the cells say and carries all of the state over.
    void change_mesh(const scene::Scene &scene, State &state, AdaptReport &report)
    {
      const std::vector<unsigned int> rows = rows_of_cells(state);
      state.triangulation.prepare_coarsening_and_refinement();
      bool any = false;
      for (const auto &cell : state.triangulation.active_cell_iterators())
        any |= cell->is_locally_owned() && (cell->refine_flag_set() || cell->coarsen_flag_set());
      report.cells = state.tables.n_global_cells;
      if (!MPI::logical_or(any, state.communicator))
        return;

      const double volume = measure(state).volume, strain = strain_integral(state);

      parallel::distributed::SolutionTransfer<2, Field> transfer(state.flow_dofs);
      state.position.update_ghost_values();
      state.velocity.update_ghost_values();
      transfer.prepare_for_coarsening_and_refinement(
          std::vector<const Field *>{ &state.position, &state.velocity });

      using Cell   = parallel::distributed::Triangulation<2>::cell_iterator;
      using Status = parallel::distributed::Triangulation<2>::CellStatus;
      const std::vector<std::array<unsigned int, 4>> old_edges = edges_of_cells(state);
      const unsigned int handle = state.triangulation.register_data_attach(
          [&](const Cell &cell, const Status status) {
            std::vector<CarriedCell> cells;
            const auto               add = [&](const auto &active) {
              const unsigned int row = rows[active->active_cell_index()];
              cells.push_back(carry(state, row, old_edges[row]));
            };
            if (status == parallel::distributed::Triangulation<2>::CELL_COARSEN)
              for (unsigned int c = 0; c < cell->n_children(); ++c)
                add(cell->child(c));
            else
              add(cell);
            return packed(cells);
          },
          true);
      state.triangulation.execute_coarsening_and_refinement();

      state.setup_dofs();
      state.position.zero_out_ghost_values();
      state.velocity.zero_out_ghost_values();
      std::vector<Field *> fields = { &state.position, &state.velocity };
      transfer.interpolate(fields);
      state.hanging_nodes.distribute(state.position);
      state.hanging_nodes.distribute(state.velocity);
      state.position.update_ghost_values();
      state.velocity.update_ghost_values();
      state.setup_tables();

      const std::vector<unsigned int>                new_rows  = rows_of_cells(state);
      const std::vector<std::array<unsigned int, 4>> new_edges = edges_of_cells(state);
      std::vector<CarriedSide>                       sides(state.tables.edges.size());
      const auto place = [&](const auto &active, const CarriedCell &carried) {
        const unsigned int row = new_rows[active->active_cell_index()];
        put_down(carried, state, row, new_edges[row]);
        for (unsigned int s = 0; s < 4; ++s)
          if (new_edges[row][s] != no_tool)
            sides[new_edges[row][s]] = carried.sides[s];
      };
      state.triangulation.notify_ready_to_unpack(
          handle, [&](const Cell &cell, const Status status,
                      const boost::iterator_range<std::vector<char>::const_iterator> &bytes) {
            std::array<CarriedCell, 4> old;
            std::memcpy(old.data(), &*bytes.begin(), bytes.size());
            if (status == parallel::distributed::Triangulation<2>::CELL_PERSIST)
              place(cell, old[0]);
            else if (status == parallel::distributed::Triangulation<2>::CELL_REFINE)
              for (unsigned int c = 0; c < cell->n_children(); ++c)
                place(cell->child(c), child_of(state, old[0], c));
            else
              place(cell, parent_of(state, old));
          });

      find_contacts(scene, state, find_touching(scene, state, sides));
      report.changed       = true;
      report.cells         = state.tables.n_global_cells;
      report.volume_change = measure(state).volume / volume - 1;
      state.remeshing.missing_volume =
          give_volume_back(scene, state, volume + state.remeshing.missing_volume);
      report.missing_volume = state.remeshing.missing_volume / volume;
      report.strain_change  = strain > 0 ? strain_integral(state) / strain - 1 : 0;
    }
  } // namespace


  dealii::Vector<float>
  error_indicators(const State &state, const double smallest_rate, double &relative)
  {
    const auto stress_of = [&](const unsigned int first) {
      return recover(state, [&, first](const unsigned int cell, const unsigned int q) {
        const auto &S = state.cell_history[cell].stress[q];
        return std::array<double, 2>{ { S[first], S[first + 1] } };
      });
    };
    const Field normal = stress_of(0), other = stress_of(2);

    const FE_Q<2>                   nodes(2);
    dealii::Vector<float>           indicators(state.triangulation.n_active_cells());
    double                          error = 0, norm = 0;
    const std::vector<unsigned int> rows = rows_of_cells(state);
    for (const auto &cell : state.triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const unsigned int row                = rows[cell->active_cell_index()];
        const CellHistory &history            = state.cell_history[row];
        const auto        &numbers            = state.tables.cells[row];
        double             cell_norm          = 0;
        const double       cell_error         = integral(state, row, [&](const unsigned int q) {
          const Point &x    = gauss_point(state, q);
          double       S[4] = { 0, 0, 0, 0 };
          for (unsigned int a = 0; a < 9; ++a)
            {
              const double N = nodes.shape_value(a, x);
              for (unsigned int c = 0; c < 2; ++c)
                {
                  S[c] += N * normal.local_element(2 * numbers[a] + c);
                  S[2 + c] += N * other.local_element(2 * numbers[a] + c);
                }
            }
          double square = 0;
          for (unsigned int c = 0; c < 4; ++c)
            square += (c == 3 ? 2 : 1) * std::pow(S[c] - history.stress[q][c], 2);
          const double rate = std::hypot(history.strain_rate[q], smallest_rate);
          return square * 3 * rate / (2 * history.flow_stress[q]);
        });
        cell_norm                             = integral(state, row, [&](const unsigned int q) {
          const double rate = history.strain_rate[q];
          return rate * history.flow_stress[q] * rate / std::hypot(rate, smallest_rate);
        });
        indicators[cell->active_cell_index()] = cell_error;
        error += cell_error;
        norm += cell_norm;
      }
    error    = MPI::sum(error, state.communicator);
    norm     = MPI::sum(norm, state.communicator);
    relative = norm > 0 ? std::sqrt(error / norm) : 0;
    return indicators;
  }


  AdaptReport adapt(const scene::Scene &scene, State &state)
  {
    Marking marking;
    marking.refine_fraction  = scene.refinement.refine_fraction;
    marking.coarsen_fraction = scene.refinement.coarsen_fraction;
    double estimated_error   = 0;
    marking.indicators       = error_indicators(
              state, scene.flow.regularisation * scene.characteristic_rate, estimated_error);
    AdaptReport report     = adapt(scene, state, marking);
    report.estimated_error = estimated_error;
    return report;
  }


  AdaptReport adapt(const scene::Scene &scene, State &state, const Marking &marking)
  {
    const scene::RefinementParameters &limits = scene.refinement;
    if (marking.indicators.size() > 0)
      parallel::distributed::GridRefinement::refine_and_coarsen_fixed_fraction(
          state.triangulation, marking.indicators, marking.refine_fraction,
          marking.coarsen_fraction);
    const std::vector<unsigned int> rows    = rows_of_cells(state);
    const bool                      is_full = state.tables.n_global_cells >= limits.most_cells;
    const int deepest = std::max(limits.largest_level, limits.largest_by_error);
    for (const auto &cell : state.triangulation.active_cell_iterators())
      if (cell->is_locally_owned() &&
          (is_full || cell->level() >= deepest ||
           shorter_diagonal(state, rows[cell->active_cell_index()]) < 2 * limits.smallest_size))
        cell->clear_refine_flag();
    mark_by_geometry(scene, state);
    AdaptReport report;
    report.refused = keep_outline(state);
    change_mesh(scene, state, report);
    return report;
  }


  void refine_everywhere(const scene::Scene &scene, State &state)
  {
    for (const auto &cell : state.triangulation.active_cell_iterators())
      if (cell->is_locally_owned())
        cell->set_refine_flag();
    AdaptReport report;
    change_mesh(scene, state, report);
  }
} // namespace axiforge::meshing
