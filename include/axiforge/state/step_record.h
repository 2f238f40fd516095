// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <axiforge/state/accuracy_record.h>

namespace axiforge
{
  /// What a tool feels and leaves in a step.
  struct ToolRecord
  {
    double force = 0; ///< axial, positive against the motion (or upwards on a tool at rest) [N]
    double radial_force   = 0; ///< integral of the radial traction over the interface [N]
    double contact_radius = 0; ///< largest radius that touches [mm]; 0: no contact
    double neutral_radius =
        std::numeric_limits<double>::quiet_NaN(); ///< where slip changes sign [mm]
    double end_force   = 0; ///< force at the end of the step, extrapolated [N]
    double force_slope = 0; ///< from the step before to this one [N/s]
  };

  /// What a boundary with a prescribed velocity or pressure does.
  struct BoundaryRecord
  {
    double force    = 0; ///< axial, on the workpiece [N]
    double power    = 0; ///< [mW]
    double pressure = 0; ///< mean [MPa]: power over the volume swept per time; of a pressure, over
                         ///< the area
  };

  /// Seconds of the step's phases; wall time of this rank.
  struct StepTimes
  {
    double residual = 0, assembly = 0, factor = 0, solve = 0, contact = 0, total = 0;

    void add(const StepTimes &other)
    {
      residual += other.residual;
      assembly += other.assembly;
      factor += other.factor;
      solve += other.solve;
      contact += other.contact;
      total += other.total;
    }
  };

  /// The figures of one accepted step.
  struct StepRecord
  {
    unsigned int step      = 0;
    double       time      = 0; ///< at the end of the step [s]
    double       time_step = 0; ///< [s]
    double       stroke    = 0; ///< at the end of the step [mm]

    /// Where the forces and powers hold: the middle of the step, with the explicit scheme its
    /// start.
    double time_middle = 0, stroke_middle = 0;

    std::vector<ToolRecord>     tools;
    std::vector<BoundaryRecord> boundaries;
    std::vector<double>         gauges; ///< at the end of the step [mm]; nan: nothing to measure

    double volume = 0, relative_volume_change = 0;

    // Power at the middle of the step [mW]; tools + boundaries + body = plastic + friction + volume
    // + contact + residual
    double power_tools = 0, power_boundaries = 0, power_plastic = 0, power_friction = 0;
    double power_contact  = 0; ///< by nodes that move against the tool: only where nodes are caught
    double power_volume   = 0; ///< of the pressure on the remaining divergence
    double power_residual = 0;

    double largest_strain = 0, largest_strain_rate = 0;
    double smallest_jacobian        = 0; ///< worst of the cells, 1: undistorted, at Gauss points
    double smallest_vertex_jacobian = 0; ///< at vertices: negative where an edge folds on to a tool
    double largest_radius           = 0; ///< of the free and touching surface [mm]
    double height                   = 0; ///< of the workpiece [mm]
    double fill                     = 0; ///< share of the cavity, if it is asked for
    /// Until the die is full [s]; infinite where it is open.
    double time_to_fill = std::numeric_limits<double>::infinity();
    double end_force    = 0; ///< of the driving tool at the end of the step, extrapolated [N]
    double tension      = 0; ///< sum of what nodes pull with in a step that has no other way [N]

    unsigned int cells = 0, unknowns = 0, iterations = 0, set_changes = 0, repeats = 0;
    double       residual = 0, divergence = 0;
    double       condition = 0; ///< of the last matrix, if the scene asks for it
    StepTimes    times;

    /// Of all remeshings so far, see RemeshingRecord.
    unsigned int remeshings            = 0;
    double       remeshing_volume_jump = 0, remeshing_strain_jump = 0;

    ErrorEstimate errors; ///< where the scene asks for them
  };
} // namespace axiforge
