// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>

#include <Eigen/Core>

#include <axiforge/base/geometry.h>
#include <axiforge/laws/friction.h>
#include <axiforge/laws/material.h>

namespace axiforge::laws
{
  /**
   * One edge of the workpiece that touches a tool, as the friction layer sees it. Arrays over the
   * edge's nodes are in the order first end, other end, middle. Everything is at the middle of the
   * step if that is where the flow problem is solved.
   */
  struct SmmEdge
  {
    std::array<Point, 3>   nodes;   // mm
    std::array<Vector2, 3> normals; // unit, from the workpiece into the tool
    std::array<Vector2, 3> slip;    // velocity of the workpiece minus that of the tool [mm/s]
    /// Part of the edge that belongs to each node: 1/6, 1/6, 4/6 where the whole edge touches
    /// (Simpson), 1/4 at an end and 1/4 in the middle where that half touches, 0 where nothing
    /// does.
    std::array<double, 3> weights   = {};
    std::array<double, 3> strain    = {};  // effective strain, for the material law
    std::array<double, 3> viscosity = {};  // mu with s = 2 mu e' [MPa s], if workpiece_viscosity
    double                thickness = 0.;  // t [mm]
    double                beta      = 0.;  // f'/(1 - f')
    double     smallest_rate       = 1e-6; // eps0 > 0 of epsdot_reg = sqrt(epsdot^2 + eps0^2) [1/s]
    SmmElement element             = SmmElement::lagrange;
    bool       workpiece_viscosity = false; // take `viscosity` instead of the material law
    bool       picard = false; // leave the derivative of the viscosity out of the stiffness
  };

  /// Number of points of the layer: at each of the edge's nodes four through the thickness.
  constexpr unsigned int n_smm_points = 12;

  /// Stored stress deviators (rr, zz, theta theta, rz) [MPa] of the layer's points, without beta.
  /// Zero (the start) makes the stiffness Picard's.
  using SmmDual = std::array<std::array<double, 4>, n_smm_points>;

  /// Unknowns in the order node 0 r, z, node 1 r, z, node 2 r, z.
  struct SmmResult
  {
    Eigen::Matrix<double, 6, 6> stiffness; // d force / d slip, symmetric [N s/mm]
    Eigen::Matrix<double, 6, 1> force;     // derivative of the layer's dissipation potential [N]
    double                      power;     // integral of s:e [mW]
  };

  /**
   * The SMM ("stiffness matrix method") friction layer: a fictitious 8-node serendipity element
   *
   *     x(xi, eta) = sum_a N_a(xi) (x_a + (1 + eta)/2 t n_a),   -1 <= xi, eta <= 1
   *
   * between the edge (eta = -1) and the tool (SmmElement tells of a variant). Its other five nodes
   * move with the tool. Condensing them out, K_PP v_P = f_P - K_PT v_T, is the same as writing the
   * layer in the slip v_P - v_T, of which the three nodes of the edge are all that is left; a tool
   * that moves in r would give the layer a hoop strain rate, which the slip form leaves out on
   * purpose.
   *
   * The stress is beta times the deviator s = 2 mu e', mu = sigma/(3 epsdot_reg), of the material
   * at the layer's own strain rate, or with the given viscosity. There is no volumetric part: it
   * would lock the interface.
   *
   * Quadrature: along xi the nodes with the given weights; through the thickness two Gauss points
   * on either side of eta = 1/2, where the profile -eta (1 - eta)/2 of a uniform slip has its
   * extremum and the shear rate changes its sign. So uniform slip v_s gives (5/4) beta k for a
   * rigid-perfectly plastic layer and (7/3) (mu/t) beta v_s for a linear one, exactly. The volume
   * element is 2 pi r |det J| at the layer's point. Left out are the points of a node on the axis
   * (weight 0 in an axisymmetric edge), and points beyond the axis or where the layer folds because
   * the edge is more curved than 1/t.
   *
   * The stiffness is that of the primal-dual ("stress-velocity") Newton method of Rudi, Shih and
   * Stadler (2020), symmetrised and projected:
   *
   *     ds = 2 mu de' - (kappa/2) (S~ (e':de') + e' (S~:de')),   kappa = (2/3) (1 -
   * m)/epsdot_reg^2,
   *
   * with m = d log(sigma)/d log(epsdot) limited to [0, 1] and S~ the stored stress scaled back to
   * the effective value sigma. It is symmetric positive definite, and Newton's own where S = 2 mu
   * e'.
   *
   * Doesn't allocate. With @p with_stiffness false the stiffness is left as it was.
   */
  void smm_layer(const SmmEdge  &edge,
                 const Material &material,
                 const SmmDual  &dual,
                 SmmResult      &result,
                 bool            with_stiffness);

  /**
   * The stored stresses after a Newton step: S + dS of the linearisation that smm_layer() used.
   *
   * @param edge with the slip before the step
   * @param slip_increment the step [mm/s]
   */
  void smm_update_dual(const SmmEdge                &edge,
                       const Material               &material,
                       const std::array<Vector2, 3> &slip_increment,
                       SmmDual                      &dual);
} // namespace axiforge::laws
