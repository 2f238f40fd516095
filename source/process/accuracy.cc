// SPDX-License-Identifier: GPL-2.0-or-later
#include <limits>

#include <deal.II/base/mpi.h>

#include <axiforge/base/features.h>
#include <axiforge/base/phases.h>
#include <axiforge/process/accuracy.h>
#include <axiforge/process/mesh_change.h>
#include <axiforge/state/checkpoint.h>

namespace axiforge::process
{
  namespace MPI = dealii::Utilities::MPI;

  namespace
  {
    /// Difference of the force on halved cells to the whole error: with order p it is 1/(1 - 2^-p)
    /// times the difference, 2 for p = 1 and 1.07 for p = 4. The order is not known.
    constexpr double extrapolation = 5. / 3;

    /// Below this a recovery estimate is rounding, and scales nothing.
    constexpr double least_recovered = 1e-9;

    /// The mesh is adapted until its error is this share of what it may be, so that it lasts.
    constexpr double aim = 0.6;

    /// Cells are joined when the error is below this share of what it may be.
    constexpr double far_below = 0.3;

    /// Adaptations before the first step, at most.
    constexpr unsigned int most_cycles = 20;


    /// What is compared: the force of the driving tool, or the power where none drives.
    double force_of(const scene::Scene &scene, const StepRecord &record)
    {
      if (scene.driving_tool < record.tools.size() && record.tools[scene.driving_tool].force != 0)
        return record.tools[scene.driving_tool].force;
      return record.power_tools + record.power_boundaries;
    }


    Vector2 node_value(const Field &field, const unsigned int node)
    {
      return Vector2({ field.local_element(2 * node), field.local_element(2 * node + 1) });
    }


    /// The fields of the step whose midpoint is in question, and their changes that a step of
    /// vanishing length would not have.
    struct Midpoint
    {
      const Field                    &velocity;
      const std::vector<CellHistory> &history;
      Field                           position, shift;   ///< [mm]
      const std::vector<CellHistory> *earlier = nullptr; ///< null: strains are left alone
      double strain_weight = 0; ///< of the difference of the rates, to a change of the strain [s]
    };


    /// Dissipation at the velocity of the step, and the power of the pressure on the divergence,
    /// when nodes and strains are changed as a Midpoint says.
    double change_of_bulk_power(const scene::Scene &scene,
                                const State        &state,
                                const Midpoint     &midpoint,
                                const double        half_step)
    {
      const double          smallest = scene.flow.regularisation * scene.characteristic_rate;
      double                change   = 0;
      solvers::CellGeometry geometry;
      for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
        {
          const auto        &nodes   = state.tables.cells[cell];
          const CellHistory &history = midpoint.history[cell];
          for (const bool changed : { false, true })
            {
              solvers::CellDofs x, v;
              for (unsigned int a = 0; a < 9; ++a)
                for (unsigned int c = 0; c < 2; ++c)
                  {
                    const unsigned int i = 2 * nodes[a] + c;
                    x[2 * a + c]         = midpoint.position.local_element(i) +
                                   (changed ? midpoint.shift.local_element(i) : 0.);
                    v[2 * a + c] = midpoint.velocity.local_element(i);
                  }
              solvers::cell_geometry(x, geometry);
              for (unsigned int q = 0; q < solvers::n_points; ++q)
                {
                  double rate[4];
                  solvers::strain_rate(geometry, q, v, rate);
                  const double trace  = rate[0] + rate[1] + rate[2];
                  double       square = 0.5 * rate[3] * rate[3];
                  for (unsigned int i = 0; i < 3; ++i)
                    square += (rate[i] - trace / 3) * (rate[i] - trace / 3);
                  square *= 2. / 3;
                  const double regular = std::sqrt(square + smallest * smallest);
                  double       strain =
                      state.strain.local_element(state.tables.first_strain_dof[cell] + q) +
                      half_step * history.strain_rate[q];
                  if (changed && midpoint.earlier)
                    strain += midpoint.strain_weight *
                              (history.strain_rate[q] - (*midpoint.earlier)[cell].strain_rate[q]);
                  const laws::FlowStress sigma = scene.material.flow_stress(strain, regular);
                  const double m = std::clamp(sigma.d_strain_rate * regular / sigma.value, 0., 1.);
                  double       pressure = 0;
                  for (unsigned int i = 0; i < solvers::n_pressure; ++i)
                    pressure += geometry.pressure_basis[q][i] * history.pressure[i];
                  change += (changed ? 1 : -1) * geometry.weight[q] *
                            (sigma.value * square / regular + (1 + m) * pressure * trace);
                }
            }
        }
      return change;
    }


    /// Friction's power over the areas of the edges, changed likewise.
    double change_of_friction_power(const State                    &state,
                                    const std::vector<NodeContact> &contacts,
                                    const Midpoint                 &midpoint)
    {
      double change = 0;
      for (const BoundaryEdge &edge : state.tables.edges)
        {
          if (!edge.owned || !contacts[edge.boundary_nodes[2]].active())
            continue;
          for (const bool changed : { false, true })
            {
              std::array<Vector2, 3> x;
              for (unsigned int a = 0; a < 3; ++a)
                {
                  x[a] = node_value(midpoint.position, edge.nodes[a]);
                  if (changed)
                    x[a] += node_value(midpoint.shift, edge.nodes[a]);
                }
              const Vector2                chord   = x[1] - x[0];
              const std::array<Vector2, 3> tangent = {
                { 2 * (x[2] - x[0]) - 0.5 * chord, 2 * (x[1] - x[2]) - 0.5 * chord, 0.5 * chord }
              };
              constexpr double weight[3] = { 1. / 6, 1. / 6, 4. / 6 };
              for (unsigned int a = 0; a < 3; ++a)
                if (const NodeContact &node = contacts[edge.boundary_nodes[a]]; node.active())
                  change += (changed ? 1 : -1) * weight[a] * 4 * M_PI * std::abs(x[a][0]) *
                            tangent[a].norm() * std::abs(node.traction * node.slip);
            }
        }
      return change;
    }
  } // namespace


  double measured_space_error(const scene::Scene &scene, const State &state, const double time_step)
  {
    State halved(state.communicator);
    copy_state(state, halved);
    meshing::refine_everywhere(scene, halved);
    solvers::FlowSolver       fine_solver(scene, halved), solver(scene, state);
    const solvers::FlowResult fine = fine_solver.solve(time_step), coarse = solver.solve(time_step);
    if (!fine.converged || !coarse.converged)
      return -1;
    const double exact = force_of(scene, fine.record);
    return exact != 0 ? extrapolation * std::abs(force_of(scene, coarse.record) / exact - 1) : 0;
  }


  double recovered_space_error(const scene::Scene    &scene,
                               const State           &state,
                               dealii::Vector<float> &indicators)
  {
    double relative = 0;
    indicators      = meshing::error_indicators(
             state, scene.flow.regularisation * scene.characteristic_rate, relative);
    return 0.5 * relative * relative;
  }


  double time_error(const scene::Scene        &scene,
                    const State               &state,
                    solvers::FlowSolver       &solver,
                    const solvers::FlowResult &result,
                    const double               time_step)
  {
    const Phase  phase("error estimate");
    const double power = std::abs(result.record.power_tools + result.record.power_boundaries);
    if (power == 0)
      return 0;
    // What was before: the middle of the last step, or the very start.
    solvers::FlowResult start;
    double              apart = 0.5 * (time_step + state.last_time_step);
    if (state.step == 0)
      {
        constexpr double short_step = 1e-3;
        start                       = solver.solve(short_step * time_step);
        if (!start.converged)
          return 0;
        apart = 0.5 * (1 - short_step) * time_step;
      }
    const Field &earlier = state.step == 0 ? start.velocity : state.velocity;

    const bool   midpoint_rule = scene.time.scheme() == scene::TimeScheme::midpoint;
    const double half_step     = 0.5 * time_step;
    Midpoint     midpoint{ result.velocity, result.cell_history, state.position, state.velocity };
    midpoint.earlier = state.step == 0 ? &start.cell_history : &state.cell_history;
    // x_n + dt/2 v lies dt^2/8 a beyond the path of the material; explicit Euler's geometry lies
    // dt/2 v before the middle.
    midpoint.strain_weight = midpoint_rule ? time_step * time_step / (8 * apart) : 0;
    for (unsigned int i = 0; i < 2 * state.tables.n_nodes; ++i)
      {
        const double v = result.velocity.local_element(i);
        midpoint.position.local_element(i) =
            state.position.local_element(i) + (midpoint_rule ? half_step * v : 0.);
        midpoint.shift.local_element(i) =
            midpoint_rule ? midpoint.strain_weight * (v - earlier.local_element(i)) : half_step * v;
      }
    const double change =
        change_of_bulk_power(scene, state, midpoint, midpoint_rule ? half_step : 0) +
        change_of_friction_power(state, result.contacts, midpoint);
    return std::abs(MPI::sum(change, state.communicator)) / power;
  }


  void estimate_errors(const scene::Scene &scene, State &state, StepRecord &record)
  {
    if (!optional_features || !scene.accuracy.estimated)
      return;
    const Phase           phase("error estimate");
    AccuracyRecord       &accuracy = state.accuracy;
    dealii::Vector<float> indicators;
    const double          recovered = recovered_space_error(scene, state, indicators);
    record.errors.space             = accuracy.space_factor * recovered;
    const double left               = scene.end_time() - state.time;
    if ((!accuracy.checked || state.step >= accuracy.last_check + scene.accuracy.check_every) &&
        left > 1e-9 * scene.end_time())
      {
        const double measured =
            measured_space_error(scene, state, std::min(record.time_step, left));
        if (measured >= 0 && recovered > least_recovered)
          {
            accuracy.space_factor = measured / recovered;
            record.errors.space   = measured;
          }
        accuracy.checked    = true;
        accuracy.last_check = state.step;
      }

    const double total   = record.errors.total();
    const auto   include = [&](double ErrorEstimate::*part) {
      accuracy.largest.*part = std::max(accuracy.largest.*part, record.errors.*part);
      accuracy.sum.*part += record.time_step * record.errors.*part;
    };
    for (double ErrorEstimate::*part :
         { &ErrorEstimate::space, &ErrorEstimate::time, &ErrorEstimate::regularisation,
           &ErrorEstimate::nonlinear })
      include(part);
    accuracy.largest_total = std::max(accuracy.largest_total, total);
    accuracy.time += record.time_step;
    ++accuracy.steps;
    accuracy.above += scene.accuracy.driven() && total > scene.accuracy.target;
  }


  double step_for_target(const scene::Scene &scene, const StepRecord &last)
  {
    const double allowed = scene::Accuracy::time_share * scene.accuracy.target;
    if (allowed == 0 || last.errors.time == 0)
      return std::numeric_limits<double>::infinity();
    // The error is of second order, explicit Euler's of first.
    const double order = scene.time.scheme() == scene::TimeScheme::midpoint ? 2 : 1;
    return 0.9 * last.time_step * std::pow(allowed / last.errors.time, 1 / order);
  }


  bool mark_for_target(const scene::Scene &scene,
                       const State        &state,
                       const double        space_error,
                       meshing::Marking   &marking)
  {
    const double allowed = scene::Accuracy::space_share * scene.accuracy.target;
    const bool   regular = state.step % scene.refinement.every_steps == 0;
    if (space_error <= allowed && !regular)
      return false;
    if (space_error > allowed)
      {
        marking.refine_fraction  = std::clamp(1 - aim * allowed / space_error, 0.1, 0.3);
        marking.coarsen_fraction = 0.5 * scene.refinement.coarsen_fraction;
      }
    else if (space_error < far_below * allowed)
      marking.coarsen_fraction = scene.refinement.coarsen_fraction;
    else
      return true; // by the geometry alone
    recovered_space_error(scene, state, marking.indicators);
    return true;
  }


  void drive_to_target_at_start(const scene::Scene                   &scene,
                                State                                &state,
                                std::unique_ptr<solvers::FlowSolver> &solver,
                                const double                          time_step)
  {
    const double    allowed  = scene::Accuracy::space_share * scene.accuracy.target;
    AccuracyRecord &accuracy = state.accuracy;
    bool            scaled   = false; // by a measurement on a coarser mesh
    for (unsigned int cycle = 0; cycle < most_cycles; ++cycle)
      {
        solvers::FlowResult result = solver->solve(time_step);
        if (!result.converged)
          return; // the step itself will say why
        take_as_start(state, result);
        meshing::Marking marking;
        const double     recovered = recovered_space_error(scene, state, marking.indicators);
        double           error     = accuracy.space_factor * recovered;
        if (!scaled || error <= allowed)
          {
            const double measured = measured_space_error(scene, state, time_step);
            scaled = accuracy.checked = true;
            if (measured >= 0 && recovered > least_recovered)
              {
                accuracy.space_factor = measured / recovered;
                error                 = measured;
              }
            if (error <= allowed)
              return;
          }
        mark_for_target(scene, state, std::max(error, 1.01 * allowed), marking);
        if (!meshing::adapt(scene, state, marking).changed)
          return;
        accuracy.checked = false;
        solver           = std::make_unique<solvers::FlowSolver>(scene, state);
      }
  }


  std::string describe_errors(const scene::Scene &scene, const StepRecord &record)
  {
    if (!scene.accuracy.estimated)
      return "";
    return fmt::format("  error {:.2g} % (space {:.2g}, time {:.2g})", 100 * record.errors.total(),
                       100 * record.errors.space, 100 * record.errors.time);
  }


  std::string summary_of_errors(const scene::Scene &scene, const State &state)
  {
    const AccuracyRecord &accuracy = state.accuracy;
    if (!scene.accuracy.estimated || accuracy.steps == 0)
      return "";
    std::string text = "Estimated error of the force, mean and largest in %:";
    const auto  add  = [&](const char *name, double ErrorEstimate::*part) {
      text += fmt::format("  {} {:.2g}, {:.2g}", name, 100 * accuracy.sum.*part / accuracy.time,
                            100 * accuracy.largest.*part);
    };
    add("space", &ErrorEstimate::space);
    add("time", &ErrorEstimate::time);
    add("regularisation", &ErrorEstimate::regularisation);
    add("solver", &ErrorEstimate::nonlinear);
    text += fmt::format("  all {:.2g}, {:.2g}", 100 * accuracy.sum.total() / accuracy.time,
                        100 * accuracy.largest_total);
    if (scene.accuracy.driven())
      text += fmt::format("\nTarget {:.3g} %: {}", 100 * scene.accuracy.target,
                          accuracy.above == 0 ? std::string("kept in every step")
                                              : fmt::format("exceeded in {} of {} steps",
                                                            accuracy.above, accuracy.steps));
    return text + '\n';
  }
} // namespace axiforge::process
