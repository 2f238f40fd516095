// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/scene/scene.h>
#include <axiforge/solvers/contact_set.h>
#include <axiforge/solvers/flow_cell.h>
#include <axiforge/state/state.h>

namespace axiforge::solvers
{
  /**
   * Friction on the boundary edges that touch a tool. Every law acts on the tangential slip of the
   * three nodes of an edge with the nodal (Simpson) weights of the part that touches: 1/6, 4/6, 1/6
   * of a whole edge, 1/4 and 1/4 of a half (corner and middle). A law acts only where contact does.
   */
  class InterfaceFriction
  {
  public:
    InterfaceFriction(const scene::Scene &scene, const State &state);

    /// Forces and tangent of one edge in the slip of its nodes.
    struct Edge
    {
      unsigned int           tool = no_tool; ///< no_tool: nothing to add
      std::array<double, 3>  measure{};      ///< area that the node stands for [mm^2]
      std::array<double, 3>  slip{};         ///< [mm/s]
      std::array<double, 3>  traction{};     ///< [MPa], sign of the slip
      std::array<double, 3>  force{};        ///< [N]
      double                 matrix[3][3];   ///< d force / d slip [N s/mm]
      std::array<Vector2, 3> tangent;
      double                 power = 0; ///< dissipated [mW]
    };

    /**
     * Evaluates all locally owned edges.
     * @param position nodes in the configuration of the evaluation [mm]
     * @param points   of all locally owned cells, nine each
     */
    void evaluate(const ContactSet             &contact,
                  const Field                  &position,
                  const Field                  &velocity,
                  const std::vector<FlowPoint> &points,
                  double                        time_step,
                  bool                          newton);

    /// Moves the stored tractions and layer stresses with a Newton increment of the velocity.
    void update_dual(const Field &increment);

    /// Sets the stored tractions to zero: the next tangent is that of the direct iteration.
    void reset_dual();

    /// Takes the present strain rates for the lagged ones (first step only). False: nothing lags.
    bool refresh_lagged_rates(const std::vector<FlowPoint> &points);

    /// What the next step starts from.
    std::vector<EdgeFriction> history(const std::vector<FlowPoint> &points) const;

    const std::vector<Edge> &edges() const
    {
      return edges_;
    }

    static constexpr unsigned int side_nodes[4][3] = {
      { 0, 2, 4 }, { 1, 3, 5 }, { 0, 1, 6 }, { 2, 3, 7 }
    };

  private:
    void evaluate_traction(unsigned int                 e,
                           const std::array<double, 3> &flow_stress,
                           const ContactSet            &contact,
                           bool                         newton);
    void evaluate_layer(unsigned int                  e,
                        const std::array<double, 3>  &strain,
                        const std::array<double, 3>  &viscosity,
                        const std::array<Vector2, 3> &normals,
                        const std::array<Point, 3>   &nodes,
                        const std::array<double, 3>  &weights,
                        bool                          newton);

    const scene::Scene &scene;
    const State        &state;
    bool                lags;      ///< some law has a cap that depends on the strain rate
    bool                refreshes; ///< one of them acts everywhere, not only where sticking pulls
    std::vector<Edge>   edges_;
    std::vector<EdgeFriction>          stored;
    std::vector<std::array<double, 3>> tangents; ///< primal-dual, per node of an edge [MPa s/mm]
    std::vector<std::array<double, 3>> caps;     ///< [MPa]
    std::vector<laws::SmmEdge>         layers;   ///< of the last evaluation; empty without SMM
  };
} // namespace axiforge::solvers
