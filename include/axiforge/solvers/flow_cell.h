// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>

namespace axiforge::solvers
{
  /**
   * The quadrilateral Q2 cell of the flow formulation: pure arithmetic on arrays, no mesh and no
   * deal.II, so that the compiler can make a version of it for each instruction set.
   *
   * Nodes stand in deal.II's FE_Q(2) order: vertices (0,0) (1,0) (0,1) (1,1), mid-sides left,
   * right, bottom, top, centre. Local unknown 2a + c is component c (r, z) of node a. Stresses and
   * strain rates have the components (rr, zz, theta theta, rz). 3 x 3 Gauss points, r fastest.
   */
  constexpr unsigned int n_nodes    = 9;
  constexpr unsigned int n_dofs     = 18;
  constexpr unsigned int n_points   = 9;
  constexpr unsigned int n_outer    = 16; // without the cell-centre node, which is condensed
  constexpr unsigned int n_pressure = 3;

  using CellDofs = std::array<double, n_dofs>;

  /// Shape functions and reference derivatives at the Gauss points; filled once.
  struct ReferenceCell
  {
    double shape[n_points][n_nodes];
    double d_xi[n_points][n_nodes];
    double d_eta[n_points][n_nodes];
    double weight[n_points];
    double point[n_points][2];

    /// Values of the polynomial through the nine Gauss points at the three nodes (end, end, middle)
    /// of side s (left, right, bottom, top).
    double to_side[4][3][n_points];

    static const ReferenceCell &get();
  };

  /// Shape functions of the cell and their derivatives at reference point (xi, eta) of [0,1]^2.
  void shape_functions(double xi,
                       double eta,
                       double (&shape)[n_nodes],
                       double (&d_xi)[n_nodes],
                       double (&d_eta)[n_nodes]);

  /// What a quadrature point carries between Newton iterations.
  struct FlowPoint
  {
    double stress[4];      ///< stored (dual) deviatoric stress S [MPa]
    double strain_rate[4]; ///< deviatoric strain rate at the last evaluation [1/s]
    double viscosity;      ///< mu = sigma / (3 epsdot_reg) [MPa s]
    double kappa;          ///< (2/3) (1 - m) / epsdot_reg^2, equation (12) of doc/theory.md [s^2]
    double flow_stress;    ///< sigma [MPa]
    double strain;         ///< effective strain in the configuration of the evaluation
    double effective_rate; ///< epsdot, not regularised [1/s]
  };

  /// Geometry of the cell at its quadrature points in one configuration.
  struct CellGeometry
  {
    double grad_r[n_points][n_nodes];
    double grad_z[n_points][n_nodes];
    double shape_over_r[n_points][n_nodes];
    double radius[n_points];
    double weight[n_points]; ///< 2 pi r det J w [mm^3]
    double pressure_basis[n_points][n_pressure];
    double smallest_jacobian; ///< det J at its smallest Gauss point; not positive: inverted cell
  };

  /// @param x node coordinates [mm]
  void cell_geometry(const CellDofs &x, CellGeometry &geometry);

  /// Strain rate (rr, zz, theta theta, gamma_rz = 2 e_rz) [1/s] at Gauss point q of velocity v
  /// [mm/s].
  void
  strain_rate(const CellGeometry &geometry, unsigned int q, const CellDofs &v, double (&rate)[4]);

  /// The divergence operator G [n_pressure x n_dofs] and the mass matrix M of the pressure basis.
  struct CellDivergence
  {
    double gradient[n_pressure][n_dofs]; ///< G_i = int q_i div N
    double mass[n_pressure][n_pressure];
    double factor[n_pressure][n_pressure]; ///< lower Cholesky factor of the mass matrix
  };

  void cell_divergence(const CellGeometry &geometry, CellDivergence &divergence);

  /**
   * Adds lag d(G v)/dx, what the fluxes G v of the cell change by when its nodes move by lag times
   * a change of the velocity, at rest of the pressure basis; equation (14a) of doc/theory.md.
   * @param v node velocities [mm/s]
   * @param lag theta dt [s]
   */
  void add_flux_of_motion(const CellGeometry &geometry,
                          const CellDofs     &v,
                          double              lag,
                          double (&flux_gradient)[n_pressure][n_dofs]);

  /// y = M^-1 x with the factor.
  void solve_mass(const CellDivergence &divergence,
                  const double (&x)[n_pressure],
                  double (&y)[n_pressure]);

  /// Adds int B^T s to the force [N], s = 2 mu e of each point.
  void add_internal_force(const CellGeometry &geometry, const FlowPoint *points, CellDofs &force);

  /**
   * Tangent of the primal-dual Newton method, K = int B^T D B + lambda J^T M^-1 J, full and
   * symmetric [n_dofs x n_dofs]; equation (12) of doc/theory.md.
   * @param flux_gradient J: G, or G with the motion of the cell, equation (14a)
   * @param dual false: D = 2 mu I_dev only (the paper's direct iteration)
   */
  void cell_tangent(const CellGeometry   &geometry,
                    const FlowPoint      *points,
                    const CellDivergence &divergence,
                    const double (&flux_gradient)[n_pressure][n_dofs],
                    double                lambda,
                    bool                  dual,
                    double (&matrix)[n_dofs][n_dofs]);
} // namespace axiforge::solvers
