// SPDX-License-Identifier: GPL-2.0-or-later
#include <cstring>

#include <deal.II/base/mpi.h>
#include <deal.II/distributed/grid_refinement.h>
#include <deal.II/distributed/solution_transfer.h>

#include <axiforge/meshing/adapt.h>
#include <axiforge/state/measures.h>
#include <axiforge/state/recovery.h>

namespace axiforge::meshing
{
  using namespace dealii;
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// Everything that stands at the Gauss points of a cell: strain, stress (4), mean stress, rate,
    /// flow stress.
    constexpr unsigned int n_quantities = 8;
    using CellQuantities                = std::array<std::array<double, 9>, n_quantities>;

    CellQuantities quantities_of(const State &state, const unsigned int cell)
    {
      const CellHistory &history = state.cell_history[cell];
      CellQuantities     all;
      for (unsigned int q = 0; q < 9; ++q)
        {
          all[0][q] = state.strain.local_element(state.tables.first_strain_dof[cell] + q);
          for (unsigned int c = 0; c < 4; ++c)
            all[1 + c][q] = history.stress[q][c];
          all[5][q] = history.mean_stress[q];
          all[6][q] = history.strain_rate[q];
          all[7][q] = history.flow_stress[q];
        }
      return all;
    }


    void set_quantities(State &state, const unsigned int cell, const CellQuantities &all)
    {
      CellHistory &history = state.cell_history[cell];
      double       mean    = 0;
      for (unsigned int q = 0; q < 9; ++q)
        {
          state.strain.local_element(state.tables.first_strain_dof[cell] + q) = all[0][q];
          for (unsigned int c = 0; c < 4; ++c)
            history.stress[q][c] = all[1 + c][q];
          history.mean_stress[q] = all[5][q];
          history.strain_rate[q] = all[6][q];
          history.flow_stress[q] = all[7][q];
          mean += all[5][q] / 9;
        }
      history.pressure = { { mean, 0, 0 } }; // the next solve starts from it
    }


    /// The polynomial of the cell at a reference point, kept in the range of its nine values.
    double continued(const State &state, const std::array<double, 9> &values, const Point &at)
    {
      double sum = 0;
      for (unsigned int q = 0; q < 9; ++q)
        sum += state.history_element.shape_value(q, at) * values[q];
      const auto range = std::minmax_element(values.begin(), values.end());
      return std::clamp(sum, *range.first, *range.second);
    }


    const Point &gauss_point(const State &state, const unsigned int q)
    {
      return state.history_element.get_unit_support_points()[q];
    }


    std::vector<char> packed(const std::vector<CellQuantities> &cells)
    {
      std::vector<char> bytes(cells.size() * sizeof(CellQuantities));
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


    /// Puts surface nodes that are inside a tool on its profile, and finds the contacts of all
    /// nodes.
    void find_contacts(const scene::Scene &scene, State &state)
    {
      const double touching = 1e-7 * scene.size;
      for (unsigned int b = 0; b < state.tables.boundary_nodes.size(); ++b)
        {
          const BoundaryNode &node    = state.tables.boundary_nodes[b];
          NodeContact        &contact = state.contacts[b];
          if (!node.free_surface)
            continue;
          for (unsigned int tool = 0; tool < scene.tools.size(); ++tool)
            {
              const Vector2 shift = scene.tools[tool].motion.displacement(state.time);
              const Vector2 speed = scene.tools[tool].motion.velocity(state.time);
              std::array<tools::Contact, 2> found;
              const unsigned int            n = scene.tools[tool].profile.find(
                             state.node_position(node.node) - shift, touching, found);
              for (unsigned int i = 0; i < n; ++i)
                {
                  const unsigned int slot = contact.active() ? 1 : 0;
                  if (contact.tool[slot] != no_tool)
                    continue;
                  contact.tool[slot]   = tool;
                  contact.face[slot]   = found[i].face;
                  contact.normal[slot] = found[i].normal;
                  if (found[i].gap < 0 && i == 0)
                    for (unsigned int c = 0; c < 2; ++c)
                      state.position.local_element(2 * node.node + c) -=
                          found[i].gap * found[i].normal[c];
                  if (slot == 0)
                    {
                      Vector2 relative;
                      for (unsigned int c = 0; c < 2; ++c)
                        relative[c] = state.velocity.local_element(2 * node.node + c) - speed[c];
                      contact.slip =
                          relative * Vector2({ -contact.normal[0][1], contact.normal[0][0] });
                    }
                }
            }
        }
      state.position.update_ghost_values();
      for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
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
    const scene::RefinementParameters &limits = scene.refinement;
    AdaptReport                        report;
    const dealii::Vector<float>        indicators = error_indicators(
               state, scene.flow.regularisation * scene.characteristic_rate, report.estimated_error);

    parallel::distributed::GridRefinement::refine_and_coarsen_fixed_fraction(
        state.triangulation, indicators, limits.refine_fraction, limits.coarsen_fraction);
    const std::vector<unsigned int> rows    = rows_of_cells(state);
    const bool                      is_full = state.tables.n_global_cells >= limits.most_cells;
    for (const auto &cell : state.triangulation.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        const auto  &nodes = state.tables.cells[rows[cell->active_cell_index()]];
        const double size =
            std::min(state.node_position(nodes[0]).distance(state.node_position(nodes[3])),
                     state.node_position(nodes[1]).distance(state.node_position(nodes[2])));
        if (is_full || cell->level() >= static_cast<int>(limits.largest_level) ||
            size < 2 * limits.smallest_size)
          cell->clear_refine_flag();
      }
    report.refused = keep_outline(state);
    state.triangulation.prepare_coarsening_and_refinement();
    bool any = false;
    for (const auto &cell : state.triangulation.active_cell_iterators())
      any |= cell->is_locally_owned() && (cell->refine_flag_set() || cell->coarsen_flag_set());
    report.cells = state.tables.n_global_cells;
    if (!MPI::logical_or(any, state.communicator))
      return report;

    const double volume = measure(state).volume, strain = strain_integral(state);

    parallel::distributed::SolutionTransfer<2, Field> transfer(state.flow_dofs);
    state.position.update_ghost_values();
    state.velocity.update_ghost_values();
    transfer.prepare_for_coarsening_and_refinement(
        std::vector<const Field *>{ &state.position, &state.velocity });

    using Cell                = parallel::distributed::Triangulation<2>::cell_iterator;
    using Status              = parallel::distributed::Triangulation<2>::CellStatus;
    const unsigned int handle = state.triangulation.register_data_attach(
        [&](const Cell &cell, const Status status) {
          std::vector<CellQuantities> cells;
          if (status == parallel::distributed::Triangulation<2>::CELL_COARSEN)
            for (unsigned int c = 0; c < cell->n_children(); ++c)
              cells.push_back(quantities_of(state, rows[cell->child(c)->active_cell_index()]));
          else
            cells.push_back(quantities_of(state, rows[cell->active_cell_index()]));
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

    const std::vector<unsigned int> new_rows = rows_of_cells(state);
    state.triangulation.notify_ready_to_unpack(
        handle, [&](const Cell &cell, const Status status,
                    const boost::iterator_range<std::vector<char>::const_iterator> &bytes) {
          std::vector<CellQuantities> old(bytes.size() / sizeof(CellQuantities));
          std::memcpy(old.data(), &*bytes.begin(), bytes.size());
          if (status == parallel::distributed::Triangulation<2>::CELL_PERSIST)
            set_quantities(state, new_rows[cell->active_cell_index()], old[0]);
          else if (status == parallel::distributed::Triangulation<2>::CELL_REFINE)
            for (unsigned int c = 0; c < cell->n_children(); ++c)
              {
                CellQuantities all;
                for (unsigned int q = 0; q < 9; ++q)
                  {
                    const Point at =
                        GeometryInfo<2>::child_to_cell_coordinates(gauss_point(state, q), c);
                    for (unsigned int i = 0; i < n_quantities; ++i)
                      all[i][q] = continued(state, old[0][i], at);
                  }
                set_quantities(state, new_rows[cell->child(c)->active_cell_index()], all);
              }
          else
            {
              CellQuantities all;
              for (unsigned int q = 0; q < 9; ++q)
                {
                  const Point       &at     = gauss_point(state, q);
                  const unsigned int child  = GeometryInfo<2>::child_cell_from_point(at);
                  const Point        inside = GeometryInfo<2>::cell_to_child_coordinates(at, child);
                  for (unsigned int i = 0; i < n_quantities; ++i)
                    all[i][q] = continued(state, old[child][i], inside);
                }
              set_quantities(state, new_rows[cell->active_cell_index()], all);
            }
        });

    find_contacts(scene, state);
    report.changed       = true;
    report.cells         = state.tables.n_global_cells;
    report.volume_change = measure(state).volume / volume - 1;
    report.strain_change = strain > 0 ? strain_integral(state) / strain - 1 : 0;
    return report;
  }
} // namespace axiforge::meshing
