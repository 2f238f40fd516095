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

  /**
   * Cells are evaluated in groups, one in each lane of a vector register: the same arithmetic for
   * n_lanes cells at the time of one. The alignment is stated because it would otherwise depend on
   * the instruction set that a file is compiled for.
   */
  constexpr unsigned int n_lanes = 4;
  using Lanes                    = double
      __attribute__((vector_size(n_lanes * sizeof(double)), aligned(n_lanes * sizeof(double))));

  struct OneCell
  {
    using Number = double;
  };

  struct OneGroup
  {
    using Number = Lanes;
  };

  /// Geometry of OneCell or OneGroup at the quadrature points in one configuration.
  template <typename Cells> struct CellGeometryOf
  {
    using Number = typename Cells::Number;
    Number grad_r[n_points][n_nodes];
    Number grad_z[n_points][n_nodes];
    Number shape_over_r[n_points][n_nodes];
    Number radius[n_points];
    Number weight[n_points]; ///< 2 pi r det J w [mm^3]
    Number pressure_basis[n_points][n_pressure];
    Number smallest_jacobian; ///< det J at its smallest Gauss point; not positive: inverted cell
  };
  using CellGeometry  = CellGeometryOf<OneCell>;
  using GroupGeometry = CellGeometryOf<OneGroup>;

  using GroupDofs = Lanes[n_dofs];

  /// @param x node coordinates [mm]
  void cell_geometry(const CellDofs &x, CellGeometry &geometry);
  void group_geometry(const GroupDofs &x, GroupGeometry &geometry);

  /// Strain rate (rr, zz, theta theta, gamma_rz = 2 e_rz) [1/s] at Gauss point q of velocity v
  /// [mm/s].
  void
  strain_rate(const CellGeometry &geometry, unsigned int q, const CellDofs &v, double (&rate)[4]);
  void
  group_strain_rates(const GroupGeometry &geometry, const GroupDofs &v, Lanes (&rate)[n_points][4]);

  /// The quadrature points of a group, as FlowPoint has them.
  struct PointGroup
  {
    Lanes stress[n_points][4], strain_rate[n_points][4];
    Lanes viscosity[n_points], kappa[n_points], flow_stress[n_points];
  };

  /// @param points the n_points points of each cell
  void load_points(const FlowPoint *const (&points)[n_lanes], PointGroup &group);

  /// The divergence operator G [n_pressure x n_dofs] of a group, its mass matrix M of the pressure
  /// basis and the fluxes G v.
  struct GroupDivergence
  {
    Lanes gradient[n_pressure][n_dofs]; ///< G_i = int q_i div N
    Lanes mass[n_pressure][n_pressure];
    Lanes factor[n_pressure][n_pressure]; ///< lower Cholesky factor of the mass matrix
    Lanes flux[n_pressure];
  };

  void
  group_divergence(const GroupGeometry &geometry, const GroupDofs &v, GroupDivergence &divergence);

  /// y = M^-1 x with the factor; x and y may be the same.
  void solve_mass(const GroupDivergence &divergence,
                  const Lanes (&x)[n_pressure],
                  Lanes (&y)[n_pressure]);

  /// int B^T s [N], s = 2 mu e of each point.
  void
  group_internal_force(const GroupGeometry &geometry, const PointGroup &points, GroupDofs &force);

  /// Adds G^T p [N] of a pressure p, or J^T p.
  void add_pressure_force(const Lanes (&gradient)[n_pressure][n_dofs],
                          const Lanes (&pressure)[n_pressure],
                          GroupDofs &force);

  /**
   * Adds lag d(G v)/dx, what the fluxes G v of the cells change by when their nodes move by lag
   * times a change of the velocity, at rest of the pressure basis; equation (14a) of doc/theory.md.
   * @param v node velocities [mm/s]
   * @param lag theta dt [s]
   */
  void add_flux_of_motion(const GroupGeometry &geometry,
                          const GroupDofs     &v,
                          double               lag,
                          Lanes (&flux_gradient)[n_pressure][n_dofs]);

  /**
   * Tangent of the primal-dual Newton method, K = int B^T D B + lambda J^T M^-1 J, symmetric
   * [n_dofs x n_dofs]; equation (12) of doc/theory.md.
   * @param flux_gradient J: G, or G with the motion of the cells, equation (14a)
   * @param dual false: D = 2 mu I_dev only (the paper's direct iteration)
   * @param matrix its lower triangle; what is above the diagonal is not set
   */
  void group_tangent(const GroupGeometry   &geometry,
                     const PointGroup      &points,
                     const GroupDivergence &divergence,
                     const Lanes (&flux_gradient)[n_pressure][n_dofs],
                     double lambda,
                     bool   dual,
                     Lanes (&matrix)[n_dofs][n_dofs]);

  /// What gives the condensed unknowns of a group back.
  struct GroupRecovery
  {
    Lanes interior_gain[2][n_outer];         ///< -K_ii^-1 K_io
    Lanes interior_step[2];                  ///< -K_ii^-1 r_i
    Lanes flux_gradient[n_pressure][n_dofs]; ///< J, equation (14a) of doc/theory.md
  };

  /// Eliminates the centre node from a matrix (lower triangle) and the residual, in place; equation
  /// (11) of doc/theory.md.
  void condense_centre(Lanes (&matrix)[n_dofs][n_dofs], GroupDofs &residual, GroupRecovery &kept);

  /// Completes the increment of the velocity by that of the centre node, and gives the increment of
  /// the fluxes J dv.
  void recover_centre(const GroupRecovery &kept, GroupDofs &dv, Lanes (&change)[n_pressure]);
} // namespace axiforge::solvers
