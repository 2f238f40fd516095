// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include <deal.II/base/mpi.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/meshing/remesh.h>
#include <axiforge/process/accuracy.h>
#include <axiforge/process/end_condition.h>
#include <axiforge/process/step.h>
#include <axiforge/state/fill.h>
#include <axiforge/state/gauges.h>
#include <axiforge/state/pockets.h>

namespace axiforge::process
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// A step is at most so many times as long as the one before.
    constexpr double largest_growth = 1.5;

    /// A step that goes beyond the end of the operation is cut so many times at most.
    constexpr unsigned int most_cuts = 12;

    /// Share of the powers of a step that may be missing from their balance.
    constexpr double largest_imbalance = 1e-3;

    /// Share of the plastic power that goes into the few points whose strain rate is not to decide
    /// on the step: corners and ends of contact, whose rate grows with every division of the cells.
    constexpr double concentrated_power = 0.01;

    /// Powers below this share of yield stress times area times speed are those of a body at rest.
    constexpr double least_power = 1e-6;

    /// Share of the time until the die is full that a step may take.
    constexpr double share_of_filling = 0.5;

    /// With a target accuracy a step may be so many times as long as the usual one.
    constexpr double largest_driven = 5;

    /// Time in which the nodes of some cell move against each other by its own size [s].
    double shortest_distortion_time(const State &state)
    {
      double largest_rate = 0;
      for (const auto &nodes : state.tables.cells)
        {
          const auto value = [&](const Field &field, const unsigned int a) {
            return Vector2(
                { field.local_element(2 * nodes[a]), field.local_element(2 * nodes[a] + 1) });
          };
          const unsigned int edges[4][2] = { { 0, 1 }, { 2, 3 }, { 0, 2 }, { 1, 3 } };
          for (const auto &edge : edges)
            {
              const double length =
                  (value(state.position, edge[1]) - value(state.position, edge[0])).norm();
              const double speed =
                  (value(state.velocity, edge[1]) - value(state.velocity, edge[0])).norm();
              largest_rate = std::max(largest_rate, speed / length);
            }
        }
      largest_rate = MPI::max(largest_rate, state.communicator);
      return largest_rate > 0 ? 1 / largest_rate : std::numeric_limits<double>::infinity();
    }


    /// The effective strain rate that decides on the step [1/s]: of what the cells remember, the
    /// one that is exceeded in a share concentrated_power of the plastic power only; to 1/16 of a
    /// power of two.
    double governing_rate(const State &state)
    {
      double largest = 0;
      for (const CellHistory &cell : state.cell_history)
        largest =
            std::max(largest, *std::max_element(cell.strain_rate.begin(), cell.strain_rate.end()));
      largest = MPI::max(largest, state.communicator);
      if (!(largest > 0))
        return 0;
      constexpr unsigned int n_bins = 256, per_octave = 16;
      std::vector<double>    power(n_bins, 0.), sum(n_bins);
      for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
        {
          const CellHistory          &history = state.cell_history[cell];
          const std::array<double, 9> volume  = volumes_of_points(state, cell);
          for (unsigned int q = 0; q < 9; ++q)
            if (const double rate = history.strain_rate[q]; rate > 0)
              power[std::min(n_bins - 1., per_octave * std::log2(largest / rate))] +=
                  volume[q] * rate * history.flow_stress[q];
        }
      MPI::sum(power, state.communicator, sum);
      const double above  = concentrated_power * std::accumulate(sum.begin(), sum.end(), 0.);
      double       beyond = 0;
      unsigned int bin    = 0;
      while (bin + 1 < n_bins && (beyond += sum[bin]) < above)
        ++bin;
      return largest * std::exp2(-static_cast<double>(bin) / per_octave);
    }


    /// Whether some friction does not vanish with the pressure.
    bool may_adhere(const scene::Scene &scene)
    {
      return std::any_of(scene.tools.begin(), scene.tools.end(),
                         [](const scene::Tool &tool) { return tool.friction.cap(0, 1) > 0; });
    }


    /// Speed [mm/s] that decides the reduction: of the fastest tool now, or that of the scene.
    double fastest(const scene::Scene &scene, const double time)
    {
      double speed = 0;
      for (const scene::Tool &tool : scene.tools)
        speed = std::max(speed, tool.motion.velocity(time).norm());
      return speed > 0 ? speed : scene.characteristic_speed;
    }


    /// Length of a step by the scene's own word or by the reduction, without regard to strains and
    /// motions [s].
    double plain_step(const scene::Scene &scene, const State &state)
    {
      const scene::TimeParameters &limits = scene.time;
      if (limits.stroke_per_step > 0)
        {
          const double speed = scene.tools[scene.driving_tool].motion.velocity(state.time).norm();
          return speed > 0 ? limits.stroke_per_step / speed : scene.end_time() - state.time;
        }
      if (limits.time_step > 0)
        return limits.time_step;
      // What a target accuracy allows may be longer than the usual step, but not without limit.
      const double factor          = scene.accuracy.driven() && state.step > 0 ? largest_driven : 1;
      const auto [lowest, highest] = vertical_extent(state);
      return factor * limits.largest_reduction * (highest - lowest) / fastest(scene, state.time);
    }


    /// Share of a step at whose end its forces and powers hold.
    double share_of_forces(const scene::Scene &scene)
    {
      return scene.time.scheme() == scene::TimeScheme::midpoint ? 0.5 : 0.;
    }


    /**
     * Forces of the tools at the end of a step [N], by the line through where they hold in this
     * step and the one before: an error of second order. At most twice the slope before that
     * counts, and none of the other sign, so that a saw-tooth or a jump (nodes that are caught, a
     * new mesh, a kink of the motion) is not carried on. The first step knows no slope.
     */
    void set_end_forces(const scene::Scene &scene,
                        const double        time_step,
                        const StepRecord   &last,
                        StepRecord         &record)
    {
      const double left  = 1 - share_of_forces(scene),
                   apart = left * last.time_step + (1 - left) * time_step;
      for (unsigned int i = 0; i < record.tools.size(); ++i)
        {
          ToolRecord &tool  = record.tools[i];
          double      slope = 0;
          if (last.step > 0)
            {
              const ToolRecord &before = last.tools[i];
              slope = tool.force_slope = (tool.force - before.force) / apart;
              if (last.step > 1)
                slope =
                    slope * before.force_slope > 0
                        ? std::copysign(std::min(std::abs(slope), 2 * std::abs(before.force_slope)),
                                        slope)
                        : 0;
            }
          tool.end_force = tool.force + slope * left * time_step;
          if (tool.end_force * tool.force <= 0)
            tool.end_force = tool.force; // a tool that has let go, or hardly touches
        }
      if (scene.driving_tool != no_tool)
        record.end_force = record.tools[scene.driving_tool].end_force;
    }


    /// What is wrong with the powers of a solved step, empty if nothing is: they are the test that
    /// no iteration makes of itself. With a loose tolerance of the solver they close as loosely.
    std::string fault_of_powers(const scene::Scene &scene, const StepRecord &record)
    {
      const double put_in = std::abs(record.power_tools) + std::abs(record.power_boundaries);
      const double all = put_in + std::abs(record.power_plastic) + std::abs(record.power_friction);
      const double at_rest = least_power * scene.characteristic_speed * scene.size * scene.size *
                             scene.material.flow_stress(0, scene.characteristic_rate).value;
      if (!(all > at_rest))
        return "";
      const double allowed = all * std::max(largest_imbalance, 10 * scene.flow.tolerance);
      const auto   told    = [&](const std::string &what, const double power) {
        return fmt::format("{}: {:.4g} mW, where tools and boundaries put in {:.4g} mW", what,
                                power, record.power_tools + record.power_boundaries);
      };
      if (record.power_plastic < -allowed)
        return told("plastic work gives power instead of taking it", record.power_plastic);
      if (record.power_friction < -allowed)
        return told("friction gives power instead of taking it", record.power_friction);
      if (std::abs(record.power_residual) > allowed)
        return told("the powers do not balance", record.power_residual);
      return "";
    }


    /// The way out of a step that fails, by its reason.
    std::string advice_on(const scene::Scene &scene, const std::string &failure)
    {
      const auto says = [&](const char *words) { return failure.find(words) != std::string::npos; };
      if (says("turn over") || says("turns over"))
        return std::string("The mesh is used up there: ") +
               (scene.remeshing.enabled
                    ? "take smaller cells (\"Remeshing/Element size\")"
                    : "start again with a finer or a graded mesh, \"Remeshing/Enabled = true\"") +
               ", less friction or a more rate-sensitive material; a closed die that is full can't "
               "be closed further.";
      if (says("power"))
        return "The friction law does not hold there (take \"shear\" in place of \"tangential "
               "forces\"), or the solver's tolerance is too loose: lower \"Flow "
               "solver/Tolerance\", take shorter steps or a finer mesh.";
      return "If the iterations do not converge, raise \"Flow solver/Most iterations\" or \"Flow "
             "solver/Regularisation\", or take shorter steps; a closed die that is full can't be "
             "closed further.";
    }


    void accept(State &state, solvers::FlowResult &result, const double time_step)
    {
      state.move_nodes(result.velocity, time_step);
      for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
        for (unsigned int q = 0; q < 9; ++q)
          state.strain.local_element(state.tables.first_strain_dof[cell] + q) +=
              time_step * result.cell_history[cell].strain_rate[q];
      state.velocity.swap(result.velocity);
      state.cell_history.swap(result.cell_history);
      state.contacts.swap(result.contacts);
      if (!result.edge_friction.empty())
        state.edge_friction.swap(result.edge_friction);
      state.earlier_time_step = state.last_time_step;
      state.last_time_step    = time_step;
      state.time += time_step;
      ++state.step;
    }
  } // namespace


  double choose_step_size(const scene::Scene &scene, const State &state, const StepRecord &last)
  {
    const scene::TimeParameters &limits = scene.time;
    double                       end    = scene.end_time();
    for (const scene::Tool &tool : scene.tools)
      for (const double kink : tool.motion.kinks())
        if (kink > state.time * (1 + 1e-12) + 1e-300)
          end = std::min(end, kink);
    const double left  = end - state.time;
    const bool   given = limits.time_step > 0 || limits.stroke_per_step > 0;

    double step = plain_step(scene, state);
    if (!given && state.step > 0)
      {
        if (const double rate = governing_rate(state); rate > 0)
          step = std::min(step, limits.largest_strain_increment / rate);
        step = std::min(step, limits.largest_motion * shortest_distortion_time(state));
        step = std::min(step, share_of_filling * last.time_to_fill);
      }
    if (state.step > 0)
      step = std::min(step, step_for_target(scene, last));
    const double shortest = limits.smallest_step * plain_step(scene, state);
    if (state.remeshing.count > 0 && state.remeshing.last_attempt == state.step)
      step =
          std::max(step, shortest); // velocities carried to a new mesh may be rugged: it is tried
    if (step < shortest)
      throw StepError(
          fmt::format(
              "The run can't go on at time {:.6g} s, stroke {:.6g} mm, step {}: the flow has "
              "become so "
              "uneven that a step would have to be {:.3g} s short, less than \"Time "
              "stepping/Smallest "
              "step\" = {} of the usual one. The mesh is used up: {}.",
              state.time, scene.stroke(state.time), state.step + 1, step, limits.smallest_step,
              scene.remeshing.enabled
                  ? "take smaller cells (\"Remeshing/Element size\") or an earlier new mesh "
                    "(\"Remeshing/Smallest Jacobian\")"
                  : "start again with a finer or a graded mesh, or with \"Remeshing/Enabled = "
                    "true\""),
          "the flow has become uneven");
    // What is left is shared out evenly, so that the last step is no splinter.
    return left / std::max(1., std::ceil(left / step - 1e-6));
  }


  StepRecord advance(const scene::Scene  &scene,
                     State               &state,
                     solvers::FlowSolver &solver,
                     const double         wanted,
                     const StepRecord    &last,
                     const unsigned int   most_repeats,
                     const bool           keep_sound)
  {
    // After steps that had to be shortened the length comes back by and by.
    double time_step =
        last.time_step > 0 ? std::min(wanted, largest_growth * last.time_step) : wanted;
    unsigned int repeats = 0, iterations = 0, cuts = 0;
    bool         adheres = false;
    StepTimes    times;
    const double shortest = std::min(wanted, scene.time.smallest_step * plain_step(scene, state));
    for (;;)
      {
        solvers::FlowResult result = solver.solve(time_step, adheres);
        iterations += result.record.iterations;
        if (optional_features && result.converged && scene.accuracy.estimated)
          result.record.errors.time = time_error(scene, state, solver, result, time_step);
        times.add(result.record.times);
        if (result.converged)
          if (const std::string fault = fault_of_powers(scene, result.record); !fault.empty())
            {
              result.converged = false;
              result.failure   = fault;
            }
        if (result.converged)
          {
            // Try the step on a copy of the position: a cell that turns over takes it back.
            const Phase phase("geometry after the step");
            const Field before = state.position;
            state.move_nodes(result.velocity, time_step);
            const auto take_back = [&] {
              state.position = before;
              state.position.update_ghost_values();
            };
            Measures           size;
            double             fill = 0;
            meshing::Soundness moved{ 1, 0 };
            try
              {
                size = measure(state, &before);
                if (keep_sound)
                  moved = meshing::soundness(scene, state, state.time + time_step);
                const double radius = scene.process.fill_radius;
                if (radius > 0)
                  fill = fill_fraction(scene, state, radius, state.time + time_step);
              }
            catch (...)
              {
                take_back();
                throw;
              }
            take_back();
            if (size.smallest_jacobian <= 0)
              result.failure = fmt::format("a cell near r = {:.4g} mm, z = {:.4g} mm turns over",
                                           size.worst_place[0], size.worst_place[1]);
            else if (keep_sound && !moved.lost_since({ 0, 0 }).empty()) // nothing can be lost else
              result.failure = moved.lost_since(meshing::soundness(scene, state, state.time));
            if (result.failure.empty())
              {
                StepRecord record = result.record;
                record.step       = state.step + 1;
                record.height     = size.highest - size.lowest;
                record.fill       = fill;
                set_end_forces(scene, time_step, last, record);
                if (const double passed = passed_end(scene, record);
                    passed > end_tolerance && time_step > 2 * shortest && cuts++ < most_cuts)
                  {
                    // Beyond the end of the operation: the secant's rule from the step before.
                    // Where the force jumps over its limit the shortest step has to do.
                    const double before_it = state.step > 0 ? passed_end(scene, last) : -1;
                    time_step =
                        std::max(shortest, time_step * std::clamp(-before_it / (passed - before_it),
                                                                  0.05, 0.95));
                    continue;
                  }
                // The tools go straight from start to end of a step.
                const double share   = share_of_forces(scene);
                record.time_middle   = state.time + share * time_step;
                record.stroke_middle = (1 - share) * scene.stroke(state.time) +
                                       share * scene.stroke(state.time + time_step);
                accept(state, result, time_step);
                record.time                     = state.time;
                record.time_step                = time_step;
                record.stroke                   = scene.stroke(state.time);
                record.volume                   = size.volume;
                record.relative_volume_change   = size.volume / state.initial_volume - 1;
                record.largest_radius           = size.largest_radius;
                record.smallest_jacobian        = size.smallest_jacobian;
                record.smallest_vertex_jacobian = size.smallest_vertex_jacobian;
                record.largest_strain           = largest_strain(state);
                record.gauges                   = read_gauges(scene, state);
                if (optional_features && scene.driving_tool != no_tool && scene.tools.size() > 1)
                  record.time_to_fill = find_pockets(scene, state).time_to_fill();
                record.cells      = state.tables.n_global_cells;
                record.unknowns   = state.n_unknowns();
                record.repeats    = repeats;
                record.iterations = iterations;
                record.times      = times;
                return record;
              }
          }
        ++repeats;
        // Friction that comes and goes with a contact may leave no solution without any tension.
        adheres = !adheres && may_adhere(scene);
        if (adheres)
          continue;
        time_step /= 2;
        if (time_step < shortest || repeats > most_repeats)
          throw StepError(
              fmt::format(
                  "The run can't go on at time {:.6g} s, stroke {:.6g} mm, step {}: {}. The "
                  "step was repeated {} times, down to {:.3g} s. {}",
                  state.time, scene.stroke(state.time), state.step + 1, result.failure, repeats,
                  2 * time_step, advice_on(scene, result.failure)),
              result.failure);
      }
  }
} // namespace axiforge::process
