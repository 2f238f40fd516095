// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/state/state.h>

namespace axiforge::solvers
{
  /**
   * Local axes of a boundary node and what is prescribed along them in the next Newton iteration.
   * The increment of velocity is dv = a * axis[0] + b * axis[1].
   */
  struct NodeFrame
  {
    unsigned int           node;
    std::array<Vector2, 2> axis;
    bool                   fixed[2];
    double                 increment[2]; ///< of the fixed components [mm/s]
  };

  /**
   * The primal-dual active set of the contact between the workpiece's boundary nodes and the tools,
   * inside one step. The condition is non-penetration at the END of the step,
   * gap(x_n + dt v, t_{n+1}) >= 0, against the nodal reaction; see doc/theory.md, section 5.
   *
   * All decisions use nodal values that every rank holds alike, so the ranks that share a node
   * agree.
   */
  class ContactSet
  {
  public:
    /**
     * Starts from the contacts of the state.
     * @param adheres nodes bear a tension of up to the shear stress that their friction has without
     * pressure: for steps that have no solution otherwise, because such a node pulls if it is held,
     * and presses if it is not
     */
    ContactSet(const scene::Scene &scene, const State &state, bool adheres = false);

    /// Whether a tool comes nearer, in the step, to surface that it then is in if nothing moves. If
    /// none does, and nothing else drives the workpiece, rest without any force is the solution.
    /// Collective.
    bool presses(double time_step) const;

    /// Whether a tool goes on with less than half of its speed, or back: the velocities and
    /// contacts of the last step are no start for this one then.
    bool any_tool_turns(double time_step) const;

    /// No contact at all.
    void clear();

    /**
     * Finds gaps and normals of the nodes at the end of the step. Nodes that penetrate are caught.
     * @param velocity of the current iterate, with its ghosts [mm/s]
     * @return number of locally owned nodes whose set changed
     */
    unsigned int locate(const Field &velocity, double time_step);

    /**
     * Sets the reactions from the nodal forces that the contact has to supply.
     * @param force residual of the nodes without contact (internal + friction - external), ghosts
     * up to date [N]
     */
    void update_reactions(const Field &force);

    /**
     * Releases nodes that are under tension, before convergence already: by more than the forces
     * are in doubt.
     * @param scale sum of the magnitudes of the cells' forces, layout of the forces [N]
     * @param residual that the forces do not balance by, as a share of the cells' forces
     * @return number of locally owned nodes released
     */
    unsigned int release_pulled(const Field &scale, double residual);

    /**
     * Releases, of the nodes that are still under tension when all else has converged, those that
     * pull most: they were released and caught again in this step. Friction that comes and goes
     * with a node may allow neither state of it. From the second release on in a step such a node
     * touches without friction, and from the third on it is left in the tool, if that is by less
     * than a hundredth of its edges, and caught in the next step. Collective.
     * @return number of locally owned nodes released
     */
    unsigned int release_worst(const Field &scale);

    /**
     * Releases the nodes that the first increment of a step would have to pull back on to their
     * tool: those whose reaction is less than what closing the gap takes that they run into, as
     * where a wall leaves the land of a punch. For the iterate that a step starts from. Collective.
     * @param scale as in release_pulled()
     * @return number of locally owned nodes released
     */
    unsigned int release_departing(const Field &scale);

    /// Axes and prescribed increments of all boundary nodes, for the present set.
    void make_frames(const Field &velocity, double time_step, std::vector<NodeFrame> &frames) const;

    /// How a boundary edge touches: the tool of its middle, and which part of the edge.
    struct EdgeContact
    {
      unsigned int           tool = no_tool; ///< no_tool: the edge does not touch
      std::array<bool, 3>    touches{};
      std::array<Vector2, 3> normal;    ///< of the face that the middle is on
      std::array<double, 3>  weight{};  ///< nodal (Simpson) weights, 1 in all on a whole edge
      std::array<double, 3>  measure{}; ///< area that each node stands for [mm^2]
    };

    /// @param position nodes in the configuration that the areas are taken in [mm]
    EdgeContact edge(unsigned int e, const Field &position) const;

    /// Sets the contact pressure of the nodes from their reactions. Collective.
    void set_pressures(const Field &position);

    /// Area that a node stands for in all its touching edges [mm^2], of the last set_pressures().
    double node_area(const unsigned int node) const
    {
      return area.local_element(2 * node);
    }

    /// What a concave tool adds to the stiffness of a node along its surface [N s/mm]: as the node
    /// slides, the reaction turns back (doc/theory.md, (18a)). 0 at nodes with two conditions.
    double turning_stiffness(unsigned int b, double time_step) const;

    /// Velocity of a tool during the step [mm/s].
    Vector2 tool_velocity(unsigned int tool) const
    {
      return tool_velocities[tool];
    }

    /// Unit tangent of a normal; to the right of a normal that points down.
    static Vector2 tangent(const Vector2 &normal)
    {
      return Vector2({ -normal[1], normal[0] });
    }

    /// Prescribed velocity or pressure condition of a boundary id; no_tool: none.
    unsigned int condition_of(dealii::types::boundary_id id) const;

    std::vector<NodeContact> nodes;   ///< per boundary node of the state's tables
    const bool               adheres; ///< nodes may pull

  private:
    /// Directions closer than this (sine of the angle) are one condition.
    static constexpr double parallel = 0.02;

    /// Half the lengths of the edges at each node, in the first component [mm].
    Field edge_lengths() const;

    /// Tension of a node that counts as none: a share of the cells' forces, and the least [N].
    double allowed_tension(unsigned int b, const Field &scale, double share) const;

    /// Takes a node off what pulls it, or part of its friction. @return whether something pulls it
    bool release(unsigned int b, double allowed);

    /// Takes its friction from a node that was released before in this step and pulls again.
    /// @return whether it has had any to take
    bool relieve(unsigned int b, double allowed);

    /// Tension that a node bears where contacts adhere [N].
    double adhesion(unsigned int b) const;

    /// Ends of profiles that lie on another tool at the end of the step: the profile goes on
    /// straight there, so that nothing slips through the corner that the two make.
    /// @param shift of the tools [mm]
    void find_sealed_ends(const std::vector<Vector2> &shift);

    bool is_sealed(unsigned int tool, const Point &end) const;

    bool in_concave_pair(unsigned int b, unsigned int tool, unsigned int face) const;

    const scene::Scene             &scene;
    const State                    &state;
    std::vector<unsigned int>       n_releases;  ///< of each boundary node in this step
    std::vector<std::vector<Point>> sealed_ends; ///< of each tool, in its own coordinates [mm]
    std::vector<double>             left_in;     ///< how deep a free node may be in a tool [mm]
    std::vector<double>             curvature;   ///< of the first tool at each boundary node [1/mm]
    std::vector<Vector2>            tool_velocities;
    std::vector<unsigned int>       condition; ///< per boundary id
    Field  length;  ///< half the lengths of the edges at each node, in the first component [mm]
    Field  area;    ///< that the nodes stand for [mm^2]
    double way = 0; ///< of the tools in the step [mm]
    double reach;   ///< how far an active node is looked for [mm]
    double catch_distance; ///< gaps below this are round-off [mm]
    double yield_stress;   ///< largest flow stress of the workpiece [MPa]
    double least_tension;  ///< that counts as one [N]
  };
} // namespace axiforge::solvers
