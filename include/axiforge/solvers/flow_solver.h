// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <axiforge/scene/scene.h>
#include <axiforge/solvers/contact_set.h>
#include <axiforge/solvers/flow_cell.h>
#include <axiforge/solvers/interface_friction.h>
#include <axiforge/solvers/linear_system.h>
#include <axiforge/state/state.h>
#include <axiforge/state/step_record.h>

namespace axiforge::solvers
{
  /// The velocity field of a step and all that goes into the state when the step is accepted.
  struct FlowResult
  {
    bool        converged = false;
    std::string failure; ///< why not: one clause, with the place where there is one

    Field                     velocity; ///< with ghosts [mm/s]
    std::vector<CellHistory>  cell_history;
    std::vector<NodeContact>  contacts;
    std::vector<EdgeFriction> edge_friction; ///< empty: no friction law keeps anything

    StepRecord record; ///< without the figures of the end of the step
  };

  /**
   * Solves the flow problem of one time step: velocity and pressure in the configuration at the
   * middle of the step (or its start, for the explicit scheme), with contact at its end.
   * Primal-dual Newton iterations with the pressure condensed cell by cell; doc/theory.md, sections
   * 3 to 6.
   *
   * Reads the state and never writes it. Holds what depends on the mesh alone; make a new one when
   * the mesh changes.
   */
  class FlowSolver
  {
  public:
    FlowSolver(const scene::Scene &scene, const State &state);

    /// Velocity of the step from state.time to state.time + time_step. Collective.
    /// @param adheres contacts may bear some tension, see ContactSet
    FlowResult solve(double time_step, bool adheres = false);

    const LinearSystem &linear_system() const
    {
      return *system;
    }

  private:
    /// The cells that are evaluated side by side. A group with fewer than n_lanes of them has the
    /// last one several times, and only the first n count.
    struct CellGroup
    {
      std::array<unsigned int, n_lanes> cells;
      unsigned int                      n;

      CellGroup(const unsigned int first, const unsigned int n_cells)
          : n(std::min(n_lanes, n_cells - first))
      {
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          cells[lane] = first + std::min(lane, n - 1);
      }

      unsigned int operator[](const unsigned int lane) const
      {
        return cells[lane];
      }
    };

    /// Nodes of a cell that carry a hanging-node constraint, expressed in the system nodes.
    struct HangingCell
    {
      unsigned int        n_system;
      std::vector<double> weights; ///< 8 x n_system
    };

    struct Norms
    {
      double residual, divergence, constraint;
    };

    void make_system();
    void load_cell(const Field &field, unsigned int cell, CellDofs &values) const;
    void load_cells(const Field &field, const CellGroup &cells, GroupDofs &values) const;
    void load_points(const CellGroup &cells, PointGroup &group) const;
    void load_pressures(const CellGroup &cells, Lanes (&values)[n_pressure]) const;
    bool evaluate_cells(bool move_dual);
    void
    evaluate_point(FlowPoint &point, const double (&rate)[4], double strain, bool move_dual) const;
    void  add_external_forces();
    void  add_body_force();
    void  add_boundary_pressure();
    void  add_friction_forces();
    Norms measure() const;
    bool  converged(const Norms &norms) const;
    bool  held_axially() const;

    /// Whether tools alone can move the workpiece.
    bool nothing_drives() const;

    /// A workpiece at rest without stress and contact, as in the first step of all.
    void start_anew();

    /// Nodal forces that contact and kinematic conditions have to balance: internal - external +
    /// friction, with ghosts.
    const Field &balance() const
    {
      return friction->edges().empty() ? internal : unbalanced;
    }

    void index_frames();
    void assemble(const Norms &norms);
    void add_friction_of_cell(unsigned int cell,
                              unsigned int lane,
                              Lanes (&K)[n_dofs][n_dofs],
                              GroupDofs &r) const;
    void
    add_turning_of_cell(unsigned int cell, unsigned int lane, Lanes (&K)[n_dofs][n_dofs]) const;
    void add_to_system(unsigned int cell,
                       unsigned int lane,
                       const Lanes (&K)[n_dofs][n_dofs],
                       const GroupDofs &r);
    void apply_frames(const std::vector<unsigned int> &nodes,
                      std::vector<double>             &matrix,
                      std::vector<double>             &rhs) const;
    bool solve_increment();
    void recover();
    void scatter_force(unsigned int cell, const CellDofs &force, Field &target) const;
    void finish(FlowResult &result);
    void record_tools(StepRecord &record);
    /// Adds what the contact reaches beyond its last nodes to the radii of the tools [mm] and to
    /// their (radius, slip).
    void add_contact_ends(std::vector<double>                             &radius,
                          std::vector<std::vector<std::array<double, 2>>> &slip) const;
    void record_powers(StepRecord &record);
    void record_boundaries(StepRecord &record);

    /// What a boundary condition does, summed over this rank's part of it.
    struct BoundarySums
    {
      double power = 0, force = 0; ///< on the workpiece [mW], [N]
      double load = 0, extent = 0; ///< their quotient is the mean pressure
    };
    BoundarySums sums_of_velocity(unsigned int condition) const;
    BoundarySums sums_of_pressure(unsigned int condition) const;
    void         estimate_solver_errors(StepRecord &record) const;

    const scene::Scene &scene;
    const State        &state;
    double              theta;  ///< 1/2 or 0: where in the step the equations are written
    double              lambda; ///< penalty [MPa s]
    double reference_stress;    ///< flow stress at strain 0 and the characteristic rate [MPa]

    std::unique_ptr<LinearSystem>          system;
    SystemNodes                            system_nodes;
    std::vector<int>                       hanging_cell; ///< per cell: row in hanging, -1 none
    std::vector<HangingCell>               hanging;
    bool                                   any_hanging;
    std::vector<std::vector<unsigned int>> cell_edges; ///< boundary edges of each cell

    // Of the present step:
    double                             time_step;
    std::unique_ptr<ContactSet>        contact;
    std::unique_ptr<InterfaceFriction> friction;
    Field                              velocity, increment, position; ///< position: at theta
    Field                              internal, external, friction_force, unbalanced, scale;
    std::vector<FlowPoint>             points;
    std::vector<std::array<double, n_pressure>> pressure;
    std::vector<GroupDivergence>                divergences; ///< of each group of cells
    std::vector<GroupRecovery>                  recovery;    ///< of each group of cells
    std::vector<double>    cell_matrix, cell_rhs, cell_wide; ///< room for add_to_system
    std::vector<CellDofs>  cell_external; ///< empty: no pressure boundary and no body force
    std::vector<NodeFrame> frames;
    std::vector<int>       frame_of_node;                  ///< row in frames, -1: none
    bool                   is_new = true;                  ///< frame_of_node has not been set
    double                 divergence_square, rate_square; ///< of the last evaluation, all ranks
    std::string            failure;
    StepTimes              times;
  };
} // namespace axiforge::solvers
