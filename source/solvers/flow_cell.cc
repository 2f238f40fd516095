// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <axiforge/solvers/flow_cell.h>

// One version per instruction set, chosen when the program starts; the sanitizers can't follow
// that.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__)
#define AXIFORGE_CLONES __attribute__((target_clones("fma", "default")))
#else
#define AXIFORGE_CLONES
#endif

// What is not inlined is compiled for the least instruction set.
#ifdef __GNUC__
#define AXIFORGE_INLINE __attribute__((always_inline)) inline
#else
#define AXIFORGE_INLINE inline
#endif

namespace axiforge::solvers
{
  namespace
  {
    // Positions of the nodes on the 3 x 3 grid of one-dimensional nodes 0, 1/2, 1.
    constexpr unsigned int column[n_nodes] = { 0, 2, 0, 2, 0, 2, 1, 1, 1 };
    constexpr unsigned int row[n_nodes]    = { 0, 0, 2, 2, 1, 1, 0, 2, 1 };

    void quadratic(const double x, double (&value)[3], double (&derivative)[3])
    {
      value[0]      = (1 - x) * (1 - 2 * x);
      value[1]      = 4 * x * (1 - x);
      value[2]      = x * (2 * x - 1);
      derivative[0] = 4 * x - 3;
      derivative[1] = 4 - 8 * x;
      derivative[2] = 4 * x - 1;
    }


    ReferenceCell make_reference_cell()
    {
      ReferenceCell cell;
      const double  gauss[3]  = { 0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15) };
      const double  weight[3] = { 5. / 18, 8. / 18, 5. / 18 };
      for (unsigned int q = 0; q < n_points; ++q)
        {
          cell.point[q][0] = gauss[q % 3];
          cell.point[q][1] = gauss[q / 3];
          cell.weight[q]   = weight[q % 3] * weight[q / 3];
          shape_functions(gauss[q % 3], gauss[q / 3], cell.shape[q], cell.d_xi[q], cell.d_eta[q]);
        }

      const auto lagrange = [&](const unsigned int i, const double x) {
        double value = 1;
        for (unsigned int j = 0; j < 3; ++j)
          if (j != i)
            value *= (x - gauss[j]) / (gauss[i] - gauss[j]);
        return value;
      };
      const double along[3] = { 0, 1, 0.5 };
      for (unsigned int side = 0; side < 4; ++side)
        for (unsigned int node = 0; node < 3; ++node)
          {
            const double xi  = side < 2 ? side : along[node];
            const double eta = side < 2 ? along[node] : side - 2;
            for (unsigned int q = 0; q < n_points; ++q)
              cell.to_side[side][node][q] = lagrange(q % 3, xi) * lagrange(q / 3, eta);
          }
      return cell;
    }
  } // namespace


  void shape_functions(const double xi,
                       const double eta,
                       double (&shape)[n_nodes],
                       double (&d_xi)[n_nodes],
                       double (&d_eta)[n_nodes])
  {
    double u[3], du[3], v[3], dv[3];
    quadratic(xi, u, du);
    quadratic(eta, v, dv);
    for (unsigned int a = 0; a < n_nodes; ++a)
      {
        shape[a] = u[column[a]] * v[row[a]];
        d_xi[a]  = du[column[a]] * v[row[a]];
        d_eta[a] = u[column[a]] * dv[row[a]];
      }
  }


  const ReferenceCell &ReferenceCell::get()
  {
    static const ReferenceCell cell = make_reference_cell();
    return cell;
  }


  namespace
  {
    // By reference throughout: how a vector is passed by value depends on the instruction set.

    template <typename Number> AXIFORGE_INLINE void at_least(Number &x, const Number &least)
    {
      x = x < least ? least : x;
    }

    template <typename Number> AXIFORGE_INLINE void add_magnitude(Number &sum, const Number &x)
    {
      sum += x < 0 ? -x : x;
    }

    AXIFORGE_INLINE void take_root(double &x)
    {
      x = std::sqrt(x);
    }

    AXIFORGE_INLINE void take_root(Lanes &x)
    {
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        x[lane] = std::sqrt(x[lane]);
    }


    template <typename Cells, typename Dofs>
    AXIFORGE_INLINE void make_geometry(const Dofs &x, CellGeometryOf<Cells> &geometry)
    {
      using Number                   = typename Cells::Number;
      const ReferenceCell &reference = ReferenceCell::get();

      // The pressure is linear about the centre of the cell, in units of its size.
      Number                 size{};
      constexpr unsigned int sides[3][2] = { { 0, 1 }, { 0, 2 }, { 1, 3 } };
      for (const auto &side : sides)
        {
          Number length{};
          for (unsigned int c = 0; c < 2; ++c)
            {
              const Number difference = x[2 * side[1] + c] - x[2 * side[0] + c];
              add_magnitude(length, difference);
            }
          at_least(size, length);
        }
      const Number inverse_size = 1. / size;

      for (unsigned int q = 0; q < n_points; ++q)
        {
          const double *N = reference.shape[q], *Nx = reference.d_xi[q], *Ne = reference.d_eta[q];
          Number        radius{}, height{}, r_xi{}, r_eta{}, z_xi{}, z_eta{};
          for (unsigned int a = 0; a < n_nodes; ++a)
            {
              radius += N[a] * x[2 * a];
              height += N[a] * x[2 * a + 1];
              r_xi += Nx[a] * x[2 * a];
              r_eta += Ne[a] * x[2 * a];
              z_xi += Nx[a] * x[2 * a + 1];
              z_eta += Ne[a] * x[2 * a + 1];
            }
          const Number jacobian = r_xi * z_eta - r_eta * z_xi;
          if (q == 0)
            geometry.smallest_jacobian = jacobian;
          else
            geometry.smallest_jacobian =
                jacobian < geometry.smallest_jacobian ? jacobian : geometry.smallest_jacobian;
          const Number inverse = 1. / jacobian, inverse_radius = 1. / radius;
          const Number xi_r = z_eta * inverse, xi_z = -r_eta * inverse;
          const Number eta_r = -z_xi * inverse, eta_z = r_xi * inverse;
          for (unsigned int a = 0; a < n_nodes; ++a)
            {
              geometry.grad_r[q][a]       = Nx[a] * xi_r + Ne[a] * eta_r;
              geometry.grad_z[q][a]       = Nx[a] * xi_z + Ne[a] * eta_z;
              geometry.shape_over_r[q][a] = N[a] * inverse_radius;
            }
          geometry.radius[q]            = radius;
          geometry.weight[q]            = 2 * M_PI * reference.weight[q] * radius * jacobian;
          geometry.pressure_basis[q][0] = 1. - Number{};
          geometry.pressure_basis[q][1] = (radius - x[16]) * inverse_size;
          geometry.pressure_basis[q][2] = (height - x[17]) * inverse_size;
        }
    }


    template <typename Cells, typename Dofs>
    AXIFORGE_INLINE void make_strain_rate(const CellGeometryOf<Cells> &geometry,
                                          const unsigned int           q,
                                          const Dofs                  &v,
                                          typename Cells::Number (&rate)[4])
    {
      using Number = typename Cells::Number;
      Number rr{}, zz{}, tt{}, shear{};
      for (unsigned int a = 0; a < n_nodes; ++a)
        {
          rr += geometry.grad_r[q][a] * v[2 * a];
          tt += geometry.shape_over_r[q][a] * v[2 * a];
          zz += geometry.grad_z[q][a] * v[2 * a + 1];
          shear += geometry.grad_z[q][a] * v[2 * a] + geometry.grad_r[q][a] * v[2 * a + 1];
        }
      rate[0] = rr;
      rate[1] = zz;
      rate[2] = tt;
      rate[3] = shear;
    }


    /// y = L^-1 x with the factor of the mass matrix.
    inline void
    forward(const GroupDivergence &divergence, const Lanes (&x)[n_pressure], Lanes (&y)[n_pressure])
    {
      const auto &L = divergence.factor;
      y[0]          = x[0] / L[0][0];
      y[1]          = (x[1] - L[1][0] * y[0]) / L[1][1];
      y[2]          = (x[2] - L[2][0] * y[0] - L[2][1] * y[1]) / L[2][2];
    }
  } // namespace


  void cell_geometry(const CellDofs &x, CellGeometry &geometry)
  {
    make_geometry(x, geometry);
  }


  AXIFORGE_CLONES
  void group_geometry(const GroupDofs &x, GroupGeometry &geometry)
  {
    make_geometry(x, geometry);
  }


  void strain_rate(const CellGeometry &geometry,
                   const unsigned int  q,
                   const CellDofs     &v,
                   double (&rate)[4])
  {
    make_strain_rate(geometry, q, v, rate);
  }


  AXIFORGE_CLONES
  void
  group_strain_rates(const GroupGeometry &geometry, const GroupDofs &v, Lanes (&rate)[n_points][4])
  {
    for (unsigned int q = 0; q < n_points; ++q)
      make_strain_rate(geometry, q, v, rate[q]);
  }


  void load_points(const FlowPoint *const (&points)[n_lanes], PointGroup &group)
  {
    for (unsigned int lane = 0; lane < n_lanes; ++lane)
      for (unsigned int q = 0; q < n_points; ++q)
        {
          const FlowPoint &point = points[lane][q];
          for (unsigned int c = 0; c < 4; ++c)
            {
              group.stress[q][c][lane]      = point.stress[c];
              group.strain_rate[q][c][lane] = point.strain_rate[c];
            }
          group.viscosity[q][lane]   = point.viscosity;
          group.kappa[q][lane]       = point.kappa;
          group.flow_stress[q][lane] = point.flow_stress;
        }
  }


  AXIFORGE_CLONES
  void
  group_divergence(const GroupGeometry &geometry, const GroupDofs &v, GroupDivergence &divergence)
  {
    Lanes gradient[n_pressure][n_dofs] = {}, mass[n_pressure][n_pressure] = {};
    for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes weight[n_pressure];
        for (unsigned int i = 0; i < n_pressure; ++i)
          {
            weight[i] = geometry.weight[q] * geometry.pressure_basis[q][i];
            for (unsigned int j = 0; j <= i; ++j)
              mass[i][j] += weight[i] * geometry.pressure_basis[q][j];
          }
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            const Lanes radial = geometry.grad_r[q][a] + geometry.shape_over_r[q][a];
            for (unsigned int i = 0; i < n_pressure; ++i)
              {
                gradient[i][2 * a] += weight[i] * radial;
                gradient[i][2 * a + 1] += weight[i] * geometry.grad_z[q][a];
              }
          }
      }
    for (unsigned int i = 0; i < n_pressure; ++i)
      {
        divergence.flux[i] = Lanes{};
        for (unsigned int j = 0; j < n_dofs; ++j)
          {
            divergence.gradient[i][j] = gradient[i][j];
            divergence.flux[i] += gradient[i][j] * v[j];
          }
        for (unsigned int j = 0; j < n_pressure; ++j)
          divergence.mass[i][j] = i >= j ? mass[i][j] : mass[j][i];
      }

    const auto &M = divergence.mass;
    auto       &L = divergence.factor;
    L[0][0]       = M[0][0];
    take_root(L[0][0]);
    L[1][0] = M[1][0] / L[0][0];
    L[2][0] = M[2][0] / L[0][0];
    L[1][1] = M[1][1] - L[1][0] * L[1][0];
    take_root(L[1][1]);
    L[2][1] = (M[2][1] - L[2][0] * L[1][0]) / L[1][1];
    L[2][2] = M[2][2] - L[2][0] * L[2][0] - L[2][1] * L[2][1];
    take_root(L[2][2]);
    L[0][1] = L[0][2] = L[1][2] = Lanes{};
  }


  AXIFORGE_CLONES
  void add_flux_of_motion(const GroupGeometry &geometry,
                          const GroupDofs     &v,
                          const double         lag,
                          Lanes (&flux_gradient)[n_pressure][n_dofs])
  {
    for (unsigned int q = 0; q < n_points; ++q)
      {
        const Lanes *gr = geometry.grad_r[q], *gz = geometry.grad_z[q],
                    *h = geometry.shape_over_r[q];
        Lanes r_r{}, r_z{}, z_r{}, z_z{}, hoop{};
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            r_r += gr[a] * v[2 * a];
            r_z += gz[a] * v[2 * a];
            z_r += gr[a] * v[2 * a + 1];
            z_z += gz[a] * v[2 * a + 1];
            hoop += h[a] * v[2 * a];
          }
        Lanes weight[n_pressure];
        for (unsigned int i = 0; i < n_pressure; ++i)
          weight[i] = lag * geometry.weight[q] * geometry.pressure_basis[q][i];
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            // div v div w - grad v : (grad w)^T for the motions w = (N_a, 0) and (0, N_a)
            const Lanes radial = (z_z + hoop) * gr[a] - z_r * gz[a] + (r_r + z_z) * h[a];
            const Lanes axial  = (r_r + hoop) * gz[a] - r_z * gr[a];
            for (unsigned int i = 0; i < n_pressure; ++i)
              {
                flux_gradient[i][2 * a] += weight[i] * radial;
                flux_gradient[i][2 * a + 1] += weight[i] * axial;
              }
          }
      }
  }


  AXIFORGE_CLONES
  void solve_mass(const GroupDivergence &divergence,
                  const Lanes (&x)[n_pressure],
                  Lanes (&y)[n_pressure])
  {
    const auto &L = divergence.factor;
    forward(divergence, x, y);
    y[2] = y[2] / L[2][2];
    y[1] = (y[1] - L[2][1] * y[2]) / L[1][1];
    y[0] = (y[0] - L[1][0] * y[1] - L[2][0] * y[2]) / L[0][0];
  }


  AXIFORGE_CLONES
  void
  group_internal_force(const GroupGeometry &geometry, const PointGroup &points, GroupDofs &force)
  {
    Lanes sum[n_dofs] = {};
    for (unsigned int q = 0; q < n_points; ++q)
      {
        const Lanes scale = 2 * points.viscosity[q] * geometry.weight[q];
        const Lanes rr    = scale * points.strain_rate[q][0];
        const Lanes zz    = scale * points.strain_rate[q][1];
        const Lanes tt    = scale * points.strain_rate[q][2];
        const Lanes rz    = scale * points.strain_rate[q][3];
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            sum[2 * a] += geometry.grad_r[q][a] * rr + geometry.shape_over_r[q][a] * tt +
                          geometry.grad_z[q][a] * rz;
            sum[2 * a + 1] += geometry.grad_z[q][a] * zz + geometry.grad_r[q][a] * rz;
          }
      }
    for (unsigned int j = 0; j < n_dofs; ++j)
      force[j] = sum[j];
  }


  AXIFORGE_CLONES
  void add_pressure_force(const Lanes (&gradient)[n_pressure][n_dofs],
                          const Lanes (&pressure)[n_pressure],
                          GroupDofs &force)
  {
    for (unsigned int j = 0; j < n_dofs; ++j)
      for (unsigned int i = 0; i < n_pressure; ++i)
        force[j] += gradient[i][j] * pressure[i];
  }


  AXIFORGE_CLONES
  void group_tangent(const GroupGeometry   &geometry,
                     const PointGroup      &points,
                     const GroupDivergence &divergence,
                     const Lanes (&flux_gradient)[n_pressure][n_dofs],
                     const double lambda,
                     const bool   dual,
                     Lanes (&matrix)[n_dofs][n_dofs])
  {
    // lambda J^T M^-1 J as three outer products of the rows of L^-1 J
    const double root = std::sqrt(lambda);
    Lanes        y[n_dofs][n_pressure];
    for (unsigned int j = 0; j < n_dofs; ++j)
      {
        const Lanes column[n_pressure] = { root * flux_gradient[0][j], root * flux_gradient[1][j],
                                           root * flux_gradient[2][j] };
        forward(divergence, column, y[j]);
      }
    for (unsigned int i = 0; i < n_dofs; ++i)
      for (unsigned int j = 0; j <= i; ++j)
        matrix[i][j] = y[i][0] * y[j][0] + y[i][1] * y[j][1] + y[i][2] * y[j][2];

    for (unsigned int q = 0; q < n_points; ++q)
      {
        // The stiffness of the point in the components (rr, zz, theta theta, gamma_rz).
        const Lanes w   = geometry.weight[q];
        const Lanes mu2 = 2 * points.viscosity[q] * w, third = mu2 / 3;
        Lanes       D[4][4] = { { 2 * third, -third, -third, Lanes{} },
                                { -third, 2 * third, -third, Lanes{} },
                                { -third, -third, 2 * third, Lanes{} },
                                { Lanes{}, Lanes{}, Lanes{}, mu2 / 2 } };
        if (dual)
          {
            const Lanes *S = points.stress[q], *e = points.strain_rate[q];
            Lanes        length = 1.5 * (S[0] * S[0] + S[1] * S[1] + S[2] * S[2] + 2 * S[3] * S[3]);
            take_root(length);
            at_least(length, points.flow_stress[q]); // back to the yield surface
            const Lanes half = 0.5 * w * points.kappa[q] * points.flow_stress[q] / length;
            for (unsigned int i = 0; i < 4; ++i)
              for (unsigned int j = 0; j <= i; ++j)
                D[i][j] -= half * (S[i] * e[j] + e[i] * S[j]);
          }

        const Lanes *gr = geometry.grad_r[q], *gz = geometry.grad_z[q],
                    *h = geometry.shape_over_r[q];
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            // D b for the r-column b = (gr, 0, h, gz) and the z-column b = (0, gz, 0, gr) of node a
            const Lanes r0 = D[0][0] * gr[a] + D[2][0] * h[a] + D[3][0] * gz[a];
            const Lanes r1 = D[1][0] * gr[a] + D[2][1] * h[a] + D[3][1] * gz[a];
            const Lanes r2 = D[2][0] * gr[a] + D[2][2] * h[a] + D[3][2] * gz[a];
            const Lanes r3 = D[3][0] * gr[a] + D[3][2] * h[a] + D[3][3] * gz[a];
            const Lanes z0 = D[1][0] * gz[a] + D[3][0] * gr[a];
            const Lanes z1 = D[1][1] * gz[a] + D[3][1] * gr[a];
            const Lanes z2 = D[2][1] * gz[a] + D[3][2] * gr[a];
            const Lanes z3 = D[3][1] * gz[a] + D[3][3] * gr[a];
            for (unsigned int b = 0; b <= a; ++b)
              {
                matrix[2 * a][2 * b] += r0 * gr[b] + r2 * h[b] + r3 * gz[b];
                matrix[2 * a + 1][2 * b] += z0 * gr[b] + z2 * h[b] + z3 * gz[b];
                matrix[2 * a + 1][2 * b + 1] += z1 * gz[b] + z3 * gr[b];
              }
            for (unsigned int b = 0; b < a; ++b)
              matrix[2 * a][2 * b + 1] += r1 * gz[b] + r3 * gr[b];
          }
      }
  }


  AXIFORGE_CLONES
  void condense_centre(Lanes (&matrix)[n_dofs][n_dofs], GroupDofs &residual, GroupRecovery &kept)
  {
    const Lanes k00 = matrix[16][16], k01 = matrix[17][16], k11 = matrix[17][17];
    const Lanes minus_inverse = -1. / (k00 * k11 - k01 * k01);
    auto       &gain          = kept.interior_gain;
    for (unsigned int j = 0; j < n_outer; ++j)
      {
        gain[0][j] = (k11 * matrix[16][j] - k01 * matrix[17][j]) * minus_inverse;
        gain[1][j] = (k00 * matrix[17][j] - k01 * matrix[16][j]) * minus_inverse;
      }
    kept.interior_step[0] = (k11 * residual[16] - k01 * residual[17]) * minus_inverse;
    kept.interior_step[1] = (k00 * residual[17] - k01 * residual[16]) * minus_inverse;
    for (unsigned int i = 0; i < n_outer; ++i)
      {
        residual[i] +=
            matrix[16][i] * kept.interior_step[0] + matrix[17][i] * kept.interior_step[1];
        for (unsigned int j = 0; j <= i; ++j)
          matrix[i][j] += matrix[16][i] * gain[0][j] + matrix[17][i] * gain[1][j];
      }
  }


  AXIFORGE_CLONES
  void recover_centre(const GroupRecovery &kept, GroupDofs &dv, Lanes (&change)[n_pressure])
  {
    for (unsigned int c = 0; c < 2; ++c)
      {
        dv[n_outer + c] = kept.interior_step[c];
        for (unsigned int j = 0; j < n_outer; ++j)
          dv[n_outer + c] += kept.interior_gain[c][j] * dv[j];
      }
    for (unsigned int i = 0; i < n_pressure; ++i)
      {
        change[i] = Lanes{};
        for (unsigned int j = 0; j < n_dofs; ++j)
          change[i] += kept.flux_gradient[i][j] * dv[j];
      }
  }
} // namespace axiforge::solvers
