// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <deal.II/distributed/tria.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_dgq.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <axiforge/base/geometry.h>
#include <axiforge/laws/smm_layer.h>
#include <axiforge/state/accuracy_record.h>
#include <axiforge/state/remeshing_record.h>

namespace axiforge
{
  /// A field over the locally owned and ghost unknowns of a rank.
  using Field = dealii::LinearAlgebra::distributed::Vector<double>;

  constexpr unsigned int no_tool = static_cast<unsigned int>(-1);

  /// One boundary edge of a locally owned or ghost cell. Nodes: end, end, middle (local numbers).
  struct BoundaryEdge
  {
    unsigned int                cell; ///< row in MeshTables::cells; meaningless on a ghost cell
    bool                        owned;
    unsigned int                side; ///< left, right, bottom, top of the cell
    std::array<unsigned int, 3> nodes;
    std::array<unsigned int, 3> boundary_nodes; ///< the same in MeshTables::boundary_nodes
    dealii::types::boundary_id  id;
  };

  /// A node of the boundary and the kinematic conditions it has for ever.
  struct BoundaryNode
  {
    unsigned int node;        ///< local number
    bool         owned;       ///< by this rank
    bool         on_axis;     ///< v_r = 0
    bool         on_symmetry; ///< velocity along the symmetry line only
    Vector2      symmetry_normal;
    bool         free_surface; ///< may touch tools
    /// Named parts of the boundary that the node belongs to: two where they meet.
    std::array<dealii::types::boundary_id, 2> prescribed = {
      { dealii::numbers::invalid_boundary_id, dealii::numbers::invalid_boundary_id }
    };
    unsigned int axis_neighbour =
        no_tool; ///< boundary node whose contact status an axis node takes
  };

  /**
   * Everything about the mesh that the solvers look up again and again, in local numbers: node k of
   * this rank has the unknowns 2k and 2k + 1 of a Field. Recomputed when the mesh changes.
   */
  struct MeshTables
  {
    std::vector<std::array<unsigned int, 9>>     cells;    ///< nodes of the locally owned cells
    std::vector<dealii::CellId>                  cell_ids; ///< of the same
    std::vector<dealii::types::global_dof_index> first_strain_dof; ///< local index, per cell
    std::vector<BoundaryEdge>                    edges;
    std::vector<BoundaryNode>                    boundary_nodes;
    unsigned int                                 n_nodes; ///< owned and ghost nodes
    unsigned int                                 n_owned_nodes;
    dealii::types::global_dof_index              n_global_cells;
  };

  /// Per cell, what the Newton iteration starts from in the next step.
  struct CellHistory
  {
    std::array<double, 3>                pressure;    ///< coefficients of the P1 mean stress [MPa]
    std::array<std::array<double, 4>, 9> stress;      ///< deviatoric stress at the points [MPa]
    std::array<double, 9>                mean_stress; ///< at the points [MPa]
    std::array<double, 9>                strain_rate; ///< effective [1/s]
    std::array<double, 9>                flow_stress; ///< sigma [MPa]
  };

  /// Contact of one boundary node with at most two tool surfaces.
  struct NodeContact
  {
    unsigned int           tool[2] = { no_tool, no_tool };
    unsigned int           face[2] = { 0, 0 };
    std::array<Vector2, 2> normal;
    std::array<double, 2>  gap      = { { 0, 0 } };
    std::array<double, 2>  reaction = { { 0, 0 } }; ///< nodal force along the normal [N]
    double                 slip     = 0; ///< tangential speed against the first tool [mm/s]
    double                 pressure = 0; ///< contact pressure [MPa]
    double                 traction = 0; ///< friction traction [MPa]
    double                 share    = 1; ///< of the friction law's traction that the node can bear

    bool active() const
    {
      return tool[0] != no_tool;
    }
  };

  /// What friction carries from step to step on the three nodes of a boundary edge.
  struct EdgeFriction
  {
    std::array<double, 3>      traction{};      ///< stored (dual) traction [MPa]
    std::array<double, 3>      strain_rate{};   ///< effective rate of the last step [1/s]
    std::array<double, 3>      earlier_rate{};  ///< of the step before
    std::array<double, 3>      previous_slip{}; ///< slip of the last step [mm/s]
    std::array<bool, 3>        has_previous{};
    std::vector<laws::SmmDual> layer; ///< stored stress of the SMM layer: none or one
  };

  /**
   * The mutable world of a run: mesh, unknowns, fields, history, time. Written by accepting a step,
   * by changing the mesh and by loading a checkpoint; nobody else. A new member that the next steps
   * depend on goes into the checkpoint, too (checkpoint.cc).
   */
  class State
  {
  public:
    explicit State(MPI_Comm communicator);

    State(const State &) = delete;

    MPI_Comm                                        communicator;
    dealii::parallel::distributed::Triangulation<2> triangulation;
    dealii::FESystem<2>                             flow_element;    ///< FE_Q(2) x 2
    dealii::DoFHandler<2>                           flow_dofs;       ///< velocity and position
    dealii::FE_DGQArbitraryNodes<2>                 history_element; ///< nodes are the Gauss points
    dealii::DoFHandler<2>                           history_dofs;
    dealii::AffineConstraints<double>               hanging_nodes;
    MeshTables                                      tables;

    Field position; ///< [mm]
    Field velocity; ///< of the last step (at its middle) [mm/s]
    Field strain;   ///< effective strain at the Gauss points

    std::vector<CellHistory>  cell_history;  ///< per locally owned cell
    std::vector<NodeContact>  contacts;      ///< per boundary node
    std::vector<EdgeFriction> edge_friction; ///< per boundary edge

    std::map<std::string, dealii::types::boundary_id> boundary_ids;

    double       time              = 0; ///< [s]
    unsigned int step              = 0;
    double       last_time_step    = 0; ///< [s]; 0 before the first step
    double       earlier_time_step = 0; ///< of the step before the last
    double       initial_volume    = 0; ///< [mm^3]
    double       size              = 0; ///< largest extent of the workpiece at the start [mm]

    RemeshingRecord remeshing;
    AccuracyRecord  accuracy;

    /// Takes mesh and unknowns away so that another mesh can take their place; time, step, volume,
    /// size and records stay. Collective.
    void clear_mesh();

    /// Distributes the unknowns and sizes the fields, which come out zero. The numbering depends on
    /// the mesh alone, not on the order in which it was refined, so that a checkpoint can be
    /// continued bit for bit.
    void setup_dofs();

    /// Fills the tables that depend on the position field; call once it is known. Nodes of the axis
    /// and of symmetry lines are put exactly on them. Collective.
    void setup_tables();

    /// Moves the nodes for a time [s] with a velocity [mm/s]; those of the axis stay on it exactly.
    /// Collective.
    void move_nodes(const Field &velocity, double time);

    unsigned int n_unknowns() const
    {
      return flow_dofs.n_dofs();
    }

    Point node_position(unsigned int node) const
    {
      return Point(position.local_element(2 * node), position.local_element(2 * node + 1));
    }

  private:
    void put_on_lines();
  };
} // namespace axiforge
