// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/mpi.h>
#include <deal.II/base/timer.h>

#include <axiforge/base/phases.h>
#include <axiforge/base/tolerances.h>
#include <axiforge/solvers/flow_solver.h>

namespace axiforge::solvers
{
  using dealii::Timer;
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// Releases are decided on iterates whose residual is below this: further away the sign of a
    /// reaction says little.
    constexpr double release_residual = 1e-2;

    /// Share of the characteristic forces and rates below which a workpiece counts as at rest.
    constexpr double at_rest = 1e-3;

    /// As long as contact still changes, a step may take so many times "Flow solver/Most
    /// iterations".
    constexpr unsigned int most_changing = 3;

    /// An increment with which a cell turns over within the step is halved so many times at most.
    constexpr unsigned int most_halvings = 8;

    /// Passes over the lagged strain rate of friction in the first step, which has no step before
    /// it.
    constexpr unsigned int first_step_passes = 3;
  } // namespace


  FlowSolver::FlowSolver(const scene::Scene &scene, const State &state)
      : scene(scene)
      , state(state)
      , theta(scene.time.scheme() == scene::TimeScheme::midpoint ? 0.5 : 0.)
  {
    const double rate = scene.characteristic_rate;
    reference_stress  = scene.material.flow_stress(0, rate).value;
    lambda            = scene.flow.penalty * reference_stress / (3 * rate);

    velocity.reinit(state.velocity);
    increment.reinit(velocity);
    position.reinit(velocity);
    internal.reinit(velocity);
    external.reinit(velocity);
    friction_force.reinit(velocity);
    unbalanced.reinit(velocity);
    scale.reinit(velocity);

    const std::size_t n_cells = state.tables.cells.size();
    points.resize(n_points * n_cells);
    pressure.resize(n_cells);
    divergences.resize((n_cells + n_lanes - 1) / n_lanes);
    recovery.resize(divergences.size());
    frame_of_node.assign(state.tables.n_nodes, -1);
    cell_edges.resize(n_cells);
    for (unsigned int e = 0; e < state.tables.edges.size(); ++e)
      if (state.tables.edges[e].owned)
        cell_edges[state.tables.edges[e].cell].push_back(e);
    bool loads = static_cast<bool>(scene.body_force);
    for (const scene::BoundaryCondition &boundary : scene.boundaries)
      loads |= !boundary.is_velocity;
    if (loads)
      cell_external.resize(n_cells);
    make_system();
  }


  void FlowSolver::make_system()
  {
    const Phase phase("set-up of the system");
    const auto &partitioner = *state.velocity.get_partitioner();
    any_hanging             = MPI::sum(state.hanging_nodes.n_constraints(), state.communicator) > 0;
    system_nodes.resize(state.tables.cells.size());
    hanging_cell.assign(state.tables.cells.size(), -1);
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        const auto &nodes = state.tables.cells[cell];
        bool        plain = true;
        for (unsigned int a = 0; any_hanging && a < 8; ++a)
          plain &= !state.hanging_nodes.is_constrained(partitioner.local_to_global(2 * nodes[a]));
        if (plain)
          {
            system_nodes[cell].assign(nodes.begin(), nodes.begin() + 8);
            continue;
          }
        std::map<unsigned int, std::array<double, 8>> columns;
        for (unsigned int a = 0; a < 8; ++a)
          {
            const auto dof = partitioner.local_to_global(2 * nodes[a]);
            if (!state.hanging_nodes.is_constrained(dof))
              columns[nodes[a]][a] += 1;
            else
              for (const auto &entry : *state.hanging_nodes.get_constraint_entries(dof))
                columns[partitioner.global_to_local(entry.first) / 2][a] += entry.second;
          }
        HangingCell expanded;
        expanded.n_system = columns.size();
        expanded.weights.resize(8 * columns.size());
        unsigned int j = 0;
        for (const auto &column : columns)
          {
            system_nodes[cell].push_back(column.first);
            for (unsigned int a = 0; a < 8; ++a)
              expanded.weights[a * columns.size() + j] = column.second[a];
            ++j;
          }
        hanging_cell[cell] = hanging.size();
        hanging.push_back(expanded);
      }

    system = make_linear_system(scene.flow.linear_solver, scene.flow.ordering, state, system_nodes);
  }


  FlowResult FlowSolver::solve(const double dt, const bool adheres)
  {
    const Phase phase("flow solver");
    Timer       total;
    FlowResult  result;
    time_step                  = dt;
    times                      = StepTimes();
    const double factor_before = system->factor_seconds;
    const double solve_before  = system->solve_seconds;
    contact                    = std::make_unique<ContactSet>(scene, state, adheres);
    friction                   = std::make_unique<InterfaceFriction>(scene, state);
    velocity                   = state.velocity;
    velocity.update_ghost_values();
    for (unsigned int cell = 0; cell < pressure.size(); ++cell)
      {
        pressure[cell] = state.cell_history[cell].pressure;
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int c = 0; c < 4; ++c)
            points[n_points * cell + q].stress[c] = state.cell_history[cell].stress[q][c];
      }
    failure.clear();
    const bool at_rest = nothing_drives() && !contact->presses(time_step);
    if (at_rest || (state.step > 0 && contact->any_tool_turns(time_step)))
      start_anew();

    bool                move_dual = false;
    unsigned int        passes = 0, stalled = 0, last_change = 0;
    std::vector<double> residuals;
    for (unsigned int iteration = 0;; ++iteration)
      {
        Timer timer;
        bool  sound = evaluate_cells(move_dual);
        for (unsigned int i = 0; !sound && iteration > 0 && i < most_halvings; ++i)
          {
            // Nodes that contact has let go may shoot through a cell: take half of the increment
            // back.
            increment *= 0.5;
            velocity -= increment;
            velocity.update_ghost_values();
            failure.clear();
            sound = evaluate_cells(false);
          }
        if (!sound)
          break;
        move_dual = false;
        add_external_forces();
        times.residual += timer.wall_time();

        timer.restart();
        unsigned int changes = at_rest ? 0 : contact->locate(velocity, time_step);
        contact->update_reactions(internal);
        if (iteration == 0 && state.step > 0)
          changes += contact->release_departing(scale);
        contact->set_pressures(position);
        friction->evaluate(*contact, position, velocity, points, time_step, scene.flow.newton());
        add_friction_forces();
        contact->make_frames(velocity, time_step, frames);
        if (is_new) // what is fixed counts from the first residual on, also on a new mesh
          index_frames();
        contact->update_reactions(balance());
        Norms norms = measure();
        if (norms.residual < release_residual)
          {
            const unsigned int released = contact->release_pulled(scale, norms.residual);
            if (MPI::sum(released, state.communicator) > 0)
              {
                changes += released;
                contact->set_pressures(position);
                friction->evaluate(*contact, position, velocity, points, time_step,
                                   scene.flow.newton());
                add_friction_forces();
                contact->make_frames(velocity, time_step, frames);
                norms = measure();
              }
          }
        changes = MPI::sum(changes, state.communicator);
        if (changes == 0 && converged(norms)) // no reaction may pull
          changes = MPI::sum(contact->release_worst(scale), state.communicator);
        if (changes > 0 && converged(norms))
          {
            contact->make_frames(velocity, time_step, frames);
            norms = measure();
          }
        times.contact += timer.wall_time();

        result.record.iterations = iteration;
        result.record.residual   = norms.residual;
        result.record.divergence = norms.divergence;
        // Finding the first contact at all is no change.
        result.record.set_changes += state.step == 0 && iteration == 0 ? 0 : changes;
        if (!std::isfinite(norms.residual + norms.divergence + norms.constraint))
          {
            failure = "the iteration ran into numbers that are not finite";
            break;
          }
        if (changes == 0 && converged(norms))
          {
            if (state.step == 0 && passes < first_step_passes &&
                friction->refresh_lagged_rates(points))
              {
                ++passes;
                continue;
              }
            result.converged = true;
            break;
          }
        last_change = changes > 0 ? iteration : last_change;
        if (iteration == most_changing * scene.flow.most_iterations ||
            iteration - last_change == scene.flow.most_iterations)
          {
            failure =
                fmt::format("no convergence in {} iterations (residual {:.2g}, divergence {:.2g}, "
                            "allowed {:.2g})",
                            iteration, norms.residual, norms.divergence, scene.flow.tolerance);
            break;
          }

        // A limit cycle of the dual variables: start them again.
        residuals.push_back(std::max(norms.residual, norms.divergence));
        stalled = changes > 0 || residuals.size() == 1 ? 0 : stalled + 1;
        if (scene.flow.newton() && stalled > 4 &&
            residuals.back() > 0.7 * residuals[residuals.size() - 5])
          {
            stalled = 0;
            for (FlowPoint &point : points)
              std::fill_n(point.stress, 4, 0.);
            friction->reset_dual();
            friction->evaluate(*contact, position, velocity, points, time_step, true);
          }

        timer.restart();
        assemble(norms);
        times.assembly += timer.wall_time();
        if (!solve_increment())
          {
            failure = "the matrix is not positive definite";
            break;
          }
        timer.restart();
        recover();
        times.assembly += timer.wall_time();
        move_dual = true;
      }

    // A mesh that fails before its first residual has no conditions yet to tell from.
    if (!result.converged && !is_new && !held_axially())
      failure =
          "nothing holds the workpiece along z: no tool touches it from both sides, and there is "
          "neither a symmetry line nor a boundary with an axial velocity (" +
          failure + ")";
    times.factor = system->factor_seconds - factor_before;
    times.solve  = system->solve_seconds - solve_before;
    times.total  = total.wall_time();
    if (result.converged)
      finish(result);
    result.failure      = failure;
    result.record.times = times;
    return result;
  }


  bool FlowSolver::converged(const Norms &norms) const
  {
    const double tolerance = scene.flow.tolerance;
    return norms.residual <= tolerance && norms.divergence <= tolerance &&
           norms.constraint <= tolerance;
  }


  bool FlowSolver::nothing_drives() const
  {
    return scene.boundaries.empty() && !scene.body_force;
  }


  void FlowSolver::start_anew()
  {
    velocity = 0;
    for (auto &coefficients : pressure)
      coefficients.fill(0);
    for (FlowPoint &point : points)
      std::fill_n(point.stress, 4, 0.);
    contact->clear();
    friction->reset_dual();
  }


  bool FlowSolver::held_axially() const
  {
    unsigned int n = 0;
    for (const NodeFrame &frame : frames)
      for (unsigned int i = 0; i < 2; ++i)
        n += frame.fixed[i] && std::abs(frame.axis[i][1]) > 0.02;
    return MPI::sum(n, state.communicator) > 0;
  }


  FlowSolver::Norms FlowSolver::measure() const
  {
    // Forces that nothing else balances, over the sum of the magnitudes of the cells' forces.
    const Field &forces = balance();
    double       force = 0, reference = 0, constraint = 0;
    for (unsigned int node = 0; node < state.tables.n_owned_nodes; ++node)
      {
        const Vector2 r({ forces.local_element(2 * node), forces.local_element(2 * node + 1) });
        reference += scale.local_element(2 * node) * scale.local_element(2 * node) +
                     scale.local_element(2 * node + 1) * scale.local_element(2 * node + 1);
        const int f = frame_of_node[node];
        if (f < 0)
          force += r.norm_square();
        else
          for (unsigned int i = 0; i < 2; ++i)
            if (!frames[f].fixed[i])
              force += (r * frames[f].axis[i]) * (r * frames[f].axis[i]);
      }
    for (const NodeFrame &frame : frames)
      for (unsigned int i = 0; i < 2; ++i)
        if (frame.fixed[i])
          constraint = std::max(constraint, std::abs(frame.increment[i]));

    force      = MPI::sum(force, state.communicator);
    reference  = MPI::sum(reference, state.communicator);
    constraint = MPI::max(constraint, state.communicator);
    // Floors, for a workpiece at rest (a tool that has not arrived) or in rigid motion.
    const double size        = scene.size;
    const double least_force = at_rest * reference_stress * size * size;
    const double least_rate = at_rest * scene.characteristic_rate * std::sqrt(state.initial_volume);
    return { std::sqrt(force) / std::max(std::sqrt(reference), least_force),
             std::sqrt(divergence_square) / std::max(std::sqrt(rate_square), least_rate),
             std::max(0., constraint - tolerance::round_off * size / time_step) /
                 scene.characteristic_speed };
  }


  bool FlowSolver::solve_increment()
  {
    if (!system->solve(increment))
      return false;
    for (const NodeFrame &frame : frames)
      if (frame.node < state.tables.n_owned_nodes)
        {
          const Vector2 dv = increment.local_element(2 * frame.node) * frame.axis[0] +
                             increment.local_element(2 * frame.node + 1) * frame.axis[1];
          increment.local_element(2 * frame.node)     = dv[0];
          increment.local_element(2 * frame.node + 1) = dv[1];
        }
    if (any_hanging)
      {
        increment.zero_out_ghost_values();
        state.hanging_nodes.distribute(increment);
      }
    increment.update_ghost_values();
    return true;
  }
} // namespace axiforge::solvers
