// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/mpi.h>

#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/laws/deviatoric.h>
#include <axiforge/solvers/edge_points.h>
#include <axiforge/solvers/flow_solver.h>

namespace axiforge::solvers
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// Residual and divergence below which the tangent takes the motion of the cells along.
    constexpr double near_solution = 0.25;
  } // namespace


  void FlowSolver::load_cell(const Field &field, const unsigned int cell, CellDofs &values) const
  {
    const auto &nodes = state.tables.cells[cell];
    for (unsigned int a = 0; a < n_nodes; ++a)
      {
        values[2 * a]     = field.local_element(2 * nodes[a]);
        values[2 * a + 1] = field.local_element(2 * nodes[a] + 1);
      }
  }


  void FlowSolver::load_cells(const Field &field, const CellGroup &cells, GroupDofs &values) const
  {
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        const auto &nodes = state.tables.cells[cells[lane]];
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            values[2 * a + c][lane] = field.local_element(2 * nodes[a] + c);
      }
  }


  void FlowSolver::load_points(const CellGroup &cells, PointGroup &group) const
  {
    const FlowPoint *of_cell[n_lanes];
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      of_cell[lane] = points.data() + n_points * cells[lane];
    solvers::load_points(of_cell, group);
  }


  void FlowSolver::load_pressures(const CellGroup &cells, Lanes (&values)[n_pressure]) const
  {
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      for (unsigned int i = 0; i < n_pressure; ++i)
        values[i][lane] = pressure[cells[lane]][i];
  }


  void
  FlowSolver::scatter_force(const unsigned int cell, const CellDofs &force, Field &target) const
  {
    const auto        &nodes = state.tables.cells[cell];
    const unsigned int last =
        hanging_cell[cell] < 0 ? 0 : 8; // nodes that go through the constraints
    for (unsigned int a = last; a < n_nodes; ++a)
      for (unsigned int c = 0; c < 2; ++c)
        target.local_element(2 * nodes[a] + c) += force[2 * a + c];
    if (last == 0)
      return;
    const HangingCell &expanded = hanging[hanging_cell[cell]];
    for (unsigned int a = 0; a < 8; ++a)
      for (unsigned int j = 0; j < expanded.n_system; ++j)
        for (unsigned int c = 0; c < 2; ++c)
          target.local_element(2 * system_nodes[cell][j] + c) +=
              expanded.weights[a * expanded.n_system + j] * force[2 * a + c];
  }


  void FlowSolver::evaluate_point(FlowPoint &point,
                                  const double (&rate)[4],
                                  const double strain,
                                  const bool   move_dual) const
  {
    const double trace = (rate[0] + rate[1] + rate[2]) / 3;
    const double e[4]  = { rate[0] - trace, rate[1] - trace, rate[2] - trace, 0.5 * rate[3] };

    if (move_dual)
      {
        // S <- 2 mu (e + de) - (kappa/2) (S~ (e:de) + e (S~:de)), all but de of the last iterate
        const double *old = point.strain_rate;
        double       *S   = point.stress;
        const double  length =
            std::sqrt(1.5 * (S[0] * S[0] + S[1] * S[1] + S[2] * S[2] + 2 * S[3] * S[3]));
        const double scale_back = length > point.flow_stress ? point.flow_stress / length : 1;
        double       e_de = 0, S_de = 0, de[4];
        for (unsigned int i = 0; i < 4; ++i)
          {
            const double weight = i == 3 ? 2 : 1;
            de[i]               = e[i] - old[i];
            e_de += weight * old[i] * de[i];
            S_de += weight * scale_back * S[i] * de[i];
          }
        for (unsigned int i = 0; i < 4; ++i)
          S[i] = 2 * point.viscosity * e[i] -
                 0.5 * point.kappa * (scale_back * S[i] * e_de + old[i] * S_de);
      }

    const double square    = 2. / 3 * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + 2 * e[3] * e[3]);
    const double smallest  = scene.flow.regularisation * scene.characteristic_rate;
    const double effective = std::sqrt(square);
    const double regular   = std::sqrt(square + smallest * smallest);
    const double here      = strain + theta * time_step * effective;
    const laws::FlowStress sigma = scene.material.flow_stress(here, regular);
    const double           slope = sigma.d_strain_rate + theta * time_step * sigma.d_strain;
    const double           m     = std::clamp(slope * regular / sigma.value, 0., 1.);

    std::copy_n(e, 4, point.strain_rate);
    point.viscosity      = sigma.value / (3 * regular);
    point.kappa          = 2. / 3 * (1 - m) / (regular * regular);
    point.flow_stress    = sigma.value;
    point.strain         = here;
    point.effective_rate = effective;
  }


  bool FlowSolver::evaluate_cells(const bool move_dual)
  {
    const Phase phase("forces of the cells");
    // The configuration in which the equations hold: x_n + theta dt v.
    position = state.position;
    position.update_ghost_values();
    for (unsigned int i = 0; i < 2 * state.tables.n_nodes; ++i)
      position.local_element(i) += theta * time_step * velocity.local_element(i);

    internal          = 0;
    scale             = 0;
    divergence_square = rate_square = 0;

    double        worst      = 1;
    unsigned int  worst_cell = 0;
    GroupGeometry geometry;
    GroupDofs     x, v, force;
    PointGroup    of_points;
    for (unsigned int first = 0; first < state.tables.cells.size(); first += n_lanes)
      {
        const CellGroup cells(first, state.tables.cells.size());
        load_cells(position, cells, x);
        load_cells(velocity, cells, v);
        group_geometry(x, geometry);
        bool inverted = false;
        for (unsigned int lane = 0; lane < cells.n; ++lane)
          if (const double jacobian = geometry.smallest_jacobian[lane]; !(jacobian > 0))
            {
              inverted = true;
              if (!(jacobian >= worst))
                {
                  worst      = jacobian;
                  worst_cell = cells[lane];
                }
            }
        if (inverted)
          continue;

        Lanes rates[n_points][4];
        group_strain_rates(geometry, v, rates);
        for (unsigned int lane = 0; lane < cells.n; ++lane)
          {
            const unsigned int cell   = cells[lane];
            FlowPoint         *p      = points.data() + n_points * cell;
            const double      *strain = state.strain.begin() + state.tables.first_strain_dof[cell];
            for (unsigned int q = 0; q < n_points; ++q)
              {
                const double rate[4] = { rates[q][0][lane], rates[q][1][lane], rates[q][2][lane],
                                         rates[q][3][lane] };
                evaluate_point(p[q], rate, strain[q], move_dual);
                rate_square += geometry.weight[q][lane] * p[q].effective_rate * p[q].effective_rate;
              }
          }
        load_points(cells, of_points);
        group_internal_force(geometry, of_points, force);

        GroupDivergence &divergence = divergences[first / n_lanes];
        group_divergence(geometry, v, divergence);
        Lanes p[n_pressure], flux[n_pressure], projected[n_pressure];
        if (scene.flow.classical())
          {
            solve_mass(divergence, divergence.flux, projected);
            for (unsigned int i = 0; i < n_pressure; ++i)
              for (unsigned int lane = 0; lane < cells.n; ++lane)
                pressure[cells[lane]][i] = lambda * projected[i][lane];
          }
        load_pressures(cells, p);
        for (unsigned int i = 0; i < n_pressure; ++i)
          {
            flux[i] = divergence.flux[i];
            if (!scene.flow.iterated()) // the plain penalty asks for div v = p / lambda
              for (unsigned int j = 0; j < n_pressure; ++j)
                flux[i] -= divergence.mass[i][j] * p[j] / lambda;
          }
        solve_mass(divergence, flux, projected);
        GroupDofs of_pressure = {};
        add_pressure_force(divergence.gradient, p, of_pressure);

        for (unsigned int lane = 0; lane < cells.n; ++lane)
          {
            CellDofs total, magnitude;
            for (unsigned int j = 0; j < n_dofs; ++j)
              {
                magnitude[j] = std::abs(force[j][lane]) + std::abs(of_pressure[j][lane]);
                total[j]     = force[j][lane] + of_pressure[j][lane];
              }
            for (unsigned int i = 0; i < n_pressure; ++i)
              divergence_square += flux[i][lane] * projected[i][lane];
            scatter_force(cells[lane], total, internal);
            scatter_force(cells[lane], magnitude, scale);
          }
      }
    internal.compress(dealii::VectorOperation::add);
    scale.compress(dealii::VectorOperation::add);
    divergence_square = MPI::sum(divergence_square, state.communicator);
    rate_square       = MPI::sum(rate_square, state.communicator);

    const double worst_of_all = MPI::min(worst, state.communicator);
    if (!(worst_of_all > 0))
      {
        // The rank that has the cell says where.
        double place[2] = { -1e300, -1e300 };
        if (worst == worst_of_all)
          {
            CellDofs x;
            load_cell(state.position, worst_cell, x); // where it was: in the workpiece
            place[0] = x[16];
            place[1] = x[17];
          }
        place[0] = MPI::max(place[0], state.communicator);
        place[1] = MPI::max(place[1], state.communicator);
        failure =
            fmt::format("a cell near r = {:.4g} mm, z = {:.4g} mm turns over", place[0], place[1]);
        return false;
      }
    return true;
  }


  void FlowSolver::add_external_forces()
  {
    if (optional_features && !cell_external.empty())
      {
        for (CellDofs &force : cell_external)
          force.fill(0);
        if (scene.body_force)
          add_body_force();
        add_boundary_pressure();
        external = 0;
        for (unsigned int cell = 0; cell < cell_external.size(); ++cell)
          scatter_force(cell, cell_external[cell], external);
        external.compress(dealii::VectorOperation::add);
        internal.add(-1., external);
      }
    internal.update_ghost_values();
    scale.update_ghost_values();
  }


  void FlowSolver::add_body_force()
  {
    CellGeometry         geometry;
    const ReferenceCell &reference = ReferenceCell::get();
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        CellDofs x;
        load_cell(position, cell, x);
        cell_geometry(x, geometry);
        for (unsigned int q = 0; q < n_points; ++q)
          {
            Point at;
            for (unsigned int a = 0; a < n_nodes; ++a)
              at += reference.shape[q][a] * Point(x[2 * a], x[2 * a + 1]);
            const Vector2 b = scene.body_force(at);
            for (unsigned int a = 0; a < n_nodes; ++a)
              for (unsigned int c = 0; c < 2; ++c)
                cell_external[cell][2 * a + c] += geometry.weight[q] * reference.shape[q][a] * b[c];
          }
      }
  }


  void FlowSolver::add_boundary_pressure()
  {
    // The pressure follows the edge in the present configuration.
    const double time = state.time + theta * time_step;
    for (const BoundaryEdge &edge : state.tables.edges)
      {
        const unsigned int condition = edge.owned ? contact->condition_of(edge.id) : no_tool;
        if (condition == no_tool || scene.boundaries[condition].is_velocity)
          continue;
        const auto &local = InterfaceFriction::side_nodes[edge.side];
        for (const EdgePoint &point : edge_points(position, edge))
          {
            const Vector2 load = -scene.boundaries[condition].pressure(point.x, time) * point.area;
            for (unsigned int a = 0; a < 3; ++a)
              for (unsigned int c = 0; c < 2; ++c)
                cell_external[edge.cell][2 * local[a] + c] += point.shape[a] * load[c];
          }
      }
  }


  void FlowSolver::add_friction_forces()
  {
    if (!optional_features || friction->edges().empty())
      return;
    friction_force = 0;
    for (unsigned int e = 0; e < friction->edges().size(); ++e)
      {
        const InterfaceFriction::Edge &edge = friction->edges()[e];
        if (edge.tool == no_tool)
          continue;
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            friction_force.local_element(2 * state.tables.edges[e].nodes[a] + c) +=
                edge.force[a] * edge.tangent[a][c];
      }
    friction_force.compress(dealii::VectorOperation::add);
    unbalanced = internal;
    unbalanced += friction_force;
    unbalanced.update_ghost_values();
  }


  void FlowSolver::index_frames()
  {
    is_new = false;
    std::fill(frame_of_node.begin(), frame_of_node.end(), -1);
    for (unsigned int f = 0; f < frames.size(); ++f)
      frame_of_node[frames[f].node] = f;
  }


  void FlowSolver::assemble(const Norms &norms)
  {
    const Phase phase("assembly");
    // Far from the solution, and in a first step, which starts from nothing, the motion of an
    // iterate tells nothing. With the classical penalty p follows v at once, so that nothing on the
    // right-hand side balances the J^T of the matrix: it would be off by lambda times the motion.
    const bool moving = theta > 0 && state.step > 0 && norms.residual < near_solution &&
                        norms.divergence < near_solution && !scene.flow.classical();
    index_frames();

    system->clear();
    GroupGeometry geometry;
    GroupDofs     x, v, r;
    PointGroup    of_points;
    Lanes         K[n_dofs][n_dofs];
    for (unsigned int first = 0; first < state.tables.cells.size(); first += n_lanes)
      {
        const CellGroup cells(first, state.tables.cells.size());
        load_cells(position, cells, x);
        group_geometry(x, geometry);
        load_points(cells, of_points);
        const GroupDivergence &divergence = divergences[first / n_lanes];
        GroupRecovery         &kept       = recovery[first / n_lanes];
        for (unsigned int i = 0; i < n_pressure; ++i)
          for (unsigned int j = 0; j < n_dofs; ++j)
            kept.flux_gradient[i][j] = divergence.gradient[i][j];
        if (moving)
          {
            load_cells(velocity, cells, v);
            add_flux_of_motion(geometry, v, theta * time_step, kept.flux_gradient);
          }
        group_tangent(geometry, of_points, divergence, kept.flux_gradient, lambda,
                      scene.flow.newton(), K);

        // Residual with the pressure that this iteration will set, up to J dv: with the iterated
        // penalty p + lambda M^-1 G v, with the plain one lambda M^-1 G v.
        group_internal_force(geometry, of_points, r);
        Lanes now[n_pressure], step[n_pressure];
        load_pressures(cells, now);
        solve_mass(divergence, divergence.flux, step);
        for (unsigned int i = 0; i < n_pressure; ++i)
          {
            step[i] *= lambda;
            if (!scene.flow.iterated())
              step[i] -= now[i];
          }
        add_pressure_force(divergence.gradient, now, r);
        add_pressure_force(kept.flux_gradient, step, r);
        for (unsigned int lane = 0; lane < cells.n; ++lane)
          {
            add_friction_of_cell(cells[lane], lane, K, r);
            add_turning_of_cell(cells[lane], lane, K);
            if (!cell_external.empty())
              for (unsigned int j = 0; j < n_dofs; ++j)
                r[j][lane] -= cell_external[cells[lane]][j];
          }
        condense_centre(K, r, kept);
        for (unsigned int lane = 0; lane < cells.n; ++lane)
          add_to_system(cells[lane], lane, K, r);
      }
  }


  void FlowSolver::add_friction_of_cell(const unsigned int cell,
                                        const unsigned int lane,
                                        Lanes (&K)[n_dofs][n_dofs],
                                        GroupDofs &r) const
  {
    if (friction->edges().empty())
      return;
    for (const unsigned int e : cell_edges[cell])
      {
        const InterfaceFriction::Edge &edge = friction->edges()[e];
        if (edge.tool == no_tool)
          continue;
        const auto &local = InterfaceFriction::side_nodes[state.tables.edges[e].side];
        for (unsigned int a = 0; a < 3; ++a)
          for (unsigned int c = 0; c < 2; ++c)
            {
              const unsigned int i = 2 * local[a] + c;
              r[i][lane] += edge.force[a] * edge.tangent[a][c];
              for (unsigned int b = 0; b < 3; ++b)
                for (unsigned int d = 0; d < 2; ++d)
                  if (const unsigned int j = 2 * local[b] + d; j <= i)
                    K[i][j][lane] += edge.tangent[a][c] * edge.matrix[a][b] * edge.tangent[b][d];
            }
      }
  }


  void FlowSolver::add_turning_of_cell(const unsigned int cell,
                                       const unsigned int lane,
                                       Lanes (&K)[n_dofs][n_dofs]) const
  {
    for (const unsigned int e : cell_edges[cell])
      for (unsigned int a = 0; a < 3; ++a)
        {
          const unsigned int b         = state.tables.edges[e].boundary_nodes[a];
          const double       stiffness = contact->turning_stiffness(b, time_step);
          if (stiffness == 0)
            continue;
          // A vertex belongs to two edges.
          const double       share = (a < 2 ? 0.5 : 1) * stiffness;
          const Vector2      t     = ContactSet::tangent(contact->nodes[b].normal[0]);
          const unsigned int i = 2 * InterfaceFriction::side_nodes[state.tables.edges[e].side][a];
          K[i][i][lane] += share * t[0] * t[0];
          K[i + 1][i][lane] += share * t[1] * t[0];
          K[i + 1][i + 1][lane] += share * t[1] * t[1];
        }
  }


  void FlowSolver::add_to_system(const unsigned int cell,
                                 const unsigned int lane,
                                 const Lanes (&K)[n_dofs][n_dofs],
                                 const GroupDofs &r)
  {
    // Written in full: conditions of nodes turn rows and columns.
    const auto condensed = [&](const unsigned int i, const unsigned int j) {
      return i >= j ? K[i][j][lane] : K[j][i][lane];
    };
    const unsigned int m = system_nodes[cell].size(), n = 2 * m;
    cell_matrix.resize(n * n);
    cell_rhs.resize(n);
    if (hanging_cell[cell] < 0)
      for (unsigned int i = 0; i < n; ++i)
        {
          cell_rhs[i] = -r[i][lane];
          for (unsigned int j = 0; j <= i; ++j)
            cell_matrix[i * n + j] = cell_matrix[j * n + i] = condensed(i, j);
        }
    else
      {
        // C^T K C with the weights of the hanging nodes, component by component
        const HangingCell &expanded = hanging[hanging_cell[cell]];
        cell_wide.assign(n_outer * n, 0);
        for (unsigned int i = 0; i < n_outer; ++i)
          for (unsigned int b = 0; b < 8; ++b)
            for (unsigned int j = 0; j < m; ++j)
              if (const double w = expanded.weights[b * m + j]; w != 0)
                for (unsigned int c = 0; c < 2; ++c)
                  cell_wide[i * n + 2 * j + c] += w * condensed(i, 2 * b + c);
        std::fill(cell_matrix.begin(), cell_matrix.end(), 0);
        std::fill(cell_rhs.begin(), cell_rhs.end(), 0);
        for (unsigned int a = 0; a < 8; ++a)
          for (unsigned int i = 0; i < m; ++i)
            if (const double w = expanded.weights[a * m + i]; w != 0)
              for (unsigned int c = 0; c < 2; ++c)
                {
                  cell_rhs[2 * i + c] += w * -r[2 * a + c][lane];
                  for (unsigned int j = 0; j < n; ++j)
                    cell_matrix[(2 * i + c) * n + j] += w * cell_wide[(2 * a + c) * n + j];
                }
      }
    apply_frames(system_nodes[cell], cell_matrix, cell_rhs);
    system->add(cell, cell_matrix.data(), cell_rhs.data());
  }


  void FlowSolver::apply_frames(const std::vector<unsigned int> &nodes,
                                std::vector<double>             &matrix,
                                std::vector<double>             &rhs) const
  {
    const unsigned int n = 2 * nodes.size();
    for (unsigned int a = 0; a < nodes.size(); ++a)
      {
        const int f = frame_of_node[nodes[a]];
        if (f < 0)
          continue;
        const NodeFrame &frame = frames[f];
        const Vector2   &u = frame.axis[0], &w = frame.axis[1];
        // Rotate rows and columns to the axes of the node, then take the fixed components out.
        for (unsigned int j = 0; j < n; ++j)
          {
            const double r = matrix[2 * a * n + j], z = matrix[(2 * a + 1) * n + j];
            matrix[2 * a * n + j]       = u[0] * r + u[1] * z;
            matrix[(2 * a + 1) * n + j] = w[0] * r + w[1] * z;
          }
        for (unsigned int i = 0; i < n; ++i)
          {
            const double r = matrix[i * n + 2 * a], z = matrix[i * n + 2 * a + 1];
            matrix[i * n + 2 * a]     = r * u[0] + z * u[1];
            matrix[i * n + 2 * a + 1] = r * w[0] + z * w[1];
          }
        const double r = rhs[2 * a], z = rhs[2 * a + 1];
        rhs[2 * a]     = u[0] * r + u[1] * z;
        rhs[2 * a + 1] = w[0] * r + w[1] * z;
      }
    for (unsigned int a = 0; a < nodes.size(); ++a)
      {
        const int f = frame_of_node[nodes[a]];
        if (f < 0)
          continue;
        for (unsigned int c = 0; c < 2; ++c)
          if (frames[f].fixed[c])
            {
              const unsigned int k = 2 * a + c;
              const double       g = frames[f].increment[c], diagonal = matrix[k * n + k];
              for (unsigned int i = 0; i < n; ++i)
                {
                  rhs[i] -= matrix[i * n + k] * g;
                  matrix[i * n + k] = matrix[k * n + i] = 0;
                }
              matrix[k * n + k] = diagonal;
              rhs[k]            = diagonal * g;
            }
      }
  }


  void FlowSolver::recover()
  {
    const Phase phase("pressure and cell centres");
    GroupDofs   dv;
    for (unsigned int first = 0; first < state.tables.cells.size(); first += n_lanes)
      {
        const CellGroup        cells(first, state.tables.cells.size());
        const GroupDivergence &divergence = divergences[first / n_lanes];
        load_cells(increment, cells, dv);
        Lanes flux[n_pressure], correction[n_pressure];
        recover_centre(recovery[first / n_lanes], dv, flux);
        for (unsigned int i = 0; i < n_pressure; ++i)
          flux[i] += divergence.flux[i];
        solve_mass(divergence, flux, correction);
        for (unsigned int lane = 0; lane < cells.n; ++lane)
          {
            const unsigned int cell = cells[lane];
            for (unsigned int c = 0; c < 2; ++c)
              increment.local_element(2 * state.tables.cells[cell][8] + c) = dv[n_outer + c][lane];
            for (unsigned int i = 0; i < n_pressure; ++i)
              pressure[cell][i] =
                  lambda * correction[i][lane] + (scene.flow.iterated() ? pressure[cell][i] : 0);
          }
      }
    friction->update_dual(increment);
    for (unsigned int i = 0; i < 2 * state.tables.n_owned_nodes; ++i)
      velocity.local_element(i) += increment.local_element(i);
    velocity.update_ghost_values();
  }
} // namespace axiforge::solvers
