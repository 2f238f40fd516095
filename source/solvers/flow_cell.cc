// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>

#include <axiforge/solvers/flow_cell.h>

// One version per instruction set, chosen when the program starts; the sanitizers can't follow
// that.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) &&                             \
    !defined(__SANITIZE_ADDRESS__)
#define AXIFORGE_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define AXIFORGE_CLONES
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


  AXIFORGE_CLONES
  void cell_geometry(const CellDofs &x, CellGeometry &geometry)
  {
    const ReferenceCell &reference = ReferenceCell::get();
    double               r[n_nodes], z[n_nodes];
    for (unsigned int a = 0; a < n_nodes; ++a)
      {
        r[a] = x[2 * a];
        z[a] = x[2 * a + 1];
      }

    // The pressure is linear about the centre of the cell, in units of its size.
    const double size = std::max({ std::abs(r[1] - r[0]) + std::abs(z[1] - z[0]),
                                   std::abs(r[2] - r[0]) + std::abs(z[2] - z[0]),
                                   std::abs(r[3] - r[1]) + std::abs(z[3] - z[1]) });

    geometry.smallest_jacobian = 1e300;
    for (unsigned int q = 0; q < n_points; ++q)
      {
        const double *N = reference.shape[q], *Nx = reference.d_xi[q], *Ne = reference.d_eta[q];
        double        radius = 0, height = 0, r_xi = 0, r_eta = 0, z_xi = 0, z_eta = 0;
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            radius += N[a] * r[a];
            height += N[a] * z[a];
            r_xi += Nx[a] * r[a];
            r_eta += Ne[a] * r[a];
            z_xi += Nx[a] * z[a];
            z_eta += Ne[a] * z[a];
          }
        const double jacobian      = r_xi * z_eta - r_eta * z_xi;
        geometry.smallest_jacobian = std::min(geometry.smallest_jacobian, jacobian);
        const double inverse = 1 / jacobian, inverse_radius = 1 / radius;
        const double xi_r = z_eta * inverse, xi_z = -r_eta * inverse;
        const double eta_r = -z_xi * inverse, eta_z = r_xi * inverse;
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            geometry.grad_r[q][a]       = Nx[a] * xi_r + Ne[a] * eta_r;
            geometry.grad_z[q][a]       = Nx[a] * xi_z + Ne[a] * eta_z;
            geometry.shape_over_r[q][a] = N[a] * inverse_radius;
          }
        geometry.radius[q]            = radius;
        geometry.weight[q]            = 2 * M_PI * radius * jacobian * reference.weight[q];
        geometry.pressure_basis[q][0] = 1;
        geometry.pressure_basis[q][1] = (radius - r[8]) / size;
        geometry.pressure_basis[q][2] = (height - z[8]) / size;
      }
  }


  void strain_rate(const CellGeometry &geometry,
                   const unsigned int  q,
                   const CellDofs     &v,
                   double (&rate)[4])
  {
    double rr = 0, zz = 0, tt = 0, shear = 0;
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


  void cell_divergence(const CellGeometry &geometry, CellDivergence &divergence)
  {
    for (unsigned int i = 0; i < n_pressure; ++i)
      {
        for (unsigned int j = 0; j < n_dofs; ++j)
          divergence.gradient[i][j] = 0;
        for (unsigned int j = 0; j < n_pressure; ++j)
          divergence.mass[i][j] = 0;
      }
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int i = 0; i < n_pressure; ++i)
        {
          const double weight = geometry.weight[q] * geometry.pressure_basis[q][i];
          for (unsigned int a = 0; a < n_nodes; ++a)
            {
              divergence.gradient[i][2 * a] +=
                  weight * (geometry.grad_r[q][a] + geometry.shape_over_r[q][a]);
              divergence.gradient[i][2 * a + 1] += weight * geometry.grad_z[q][a];
            }
          for (unsigned int j = 0; j < n_pressure; ++j)
            divergence.mass[i][j] += weight * geometry.pressure_basis[q][j];
        }

    const auto &M = divergence.mass;
    auto       &L = divergence.factor;
    L[0][0]       = std::sqrt(M[0][0]);
    L[1][0]       = M[1][0] / L[0][0];
    L[2][0]       = M[2][0] / L[0][0];
    L[1][1]       = std::sqrt(M[1][1] - L[1][0] * L[1][0]);
    L[2][1]       = (M[2][1] - L[2][0] * L[1][0]) / L[1][1];
    L[2][2]       = std::sqrt(M[2][2] - L[2][0] * L[2][0] - L[2][1] * L[2][1]);
    L[0][1] = L[0][2] = L[1][2] = 0;
  }


  void add_flux_of_motion(const CellGeometry &geometry,
                          const CellDofs     &v,
                          const double        lag,
                          double (&flux_gradient)[n_pressure][n_dofs])
  {
    for (unsigned int q = 0; q < n_points; ++q)
      {
        const double *gr = geometry.grad_r[q], *gz = geometry.grad_z[q],
                     *h = geometry.shape_over_r[q];
        double r_r = 0, r_z = 0, z_r = 0, z_z = 0, hoop = 0;
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            r_r += gr[a] * v[2 * a];
            r_z += gz[a] * v[2 * a];
            z_r += gr[a] * v[2 * a + 1];
            z_z += gz[a] * v[2 * a + 1];
            hoop += h[a] * v[2 * a];
          }
        const double trace = r_r + z_z + hoop;
        for (unsigned int i = 0; i < n_pressure; ++i)
          {
            const double weight = lag * geometry.weight[q] * geometry.pressure_basis[q][i];
            for (unsigned int a = 0; a < n_nodes; ++a)
              {
                flux_gradient[i][2 * a] += weight * ((trace - r_r) * gr[a] - z_r * gz[a] + (trace - hoop) * h[a]);
                flux_gradient[i][2 * a + 1] += weight * ((trace - z_z) * gz[a] - r_z * gr[a]);
              }
          }
      }
  }


  void solve_mass(const CellDivergence &divergence,
                  const double (&x)[n_pressure],
                  double (&y)[n_pressure])
  {
    const auto  &L  = divergence.factor;
    const double a0 = x[0] / L[0][0];
    const double a1 = (x[1] - L[1][0] * a0) / L[1][1];
    const double a2 = (x[2] - L[2][0] * a0 - L[2][1] * a1) / L[2][2];
    y[2]            = a2 / L[2][2];
    y[1]            = (a1 - L[2][1] * y[2]) / L[1][1];
    y[0]            = (a0 - L[1][0] * y[1] - L[2][0] * y[2]) / L[0][0];
  }


  void add_internal_force(const CellGeometry &geometry, const FlowPoint *points, CellDofs &force)
  {
    for (unsigned int q = 0; q < n_points; ++q)
      {
        const double scale = 2 * points[q].viscosity * geometry.weight[q];
        const double rr    = scale * points[q].strain_rate[0];
        const double zz    = scale * points[q].strain_rate[1];
        const double tt    = scale * points[q].strain_rate[2];
        const double rz    = scale * points[q].strain_rate[3];
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            force[2 * a] += geometry.grad_r[q][a] * rr + geometry.shape_over_r[q][a] * tt +
                            geometry.grad_z[q][a] * rz;
            force[2 * a + 1] += geometry.grad_z[q][a] * zz + geometry.grad_r[q][a] * rz;
          }
      }
  }


  AXIFORGE_CLONES
  void cell_tangent(const CellGeometry   &geometry,
                    const FlowPoint      *points,
                    const CellDivergence &divergence,
                    const double (&flux_gradient)[n_pressure][n_dofs],
                    const double          lambda,
                    const bool            dual,
                    double (&matrix)[n_dofs][n_dofs])
  {
    double rr[n_nodes][n_nodes] = {}, rz[n_nodes][n_nodes] = {}, zz[n_nodes][n_nodes] = {};

    for (unsigned int q = 0; q < n_points; ++q)
      {
        const FlowPoint &point = points[q];
        const double     w     = geometry.weight[q];
        const double     mu2   = 2 * point.viscosity * w;
        // The stiffness of the point in the components (rr, zz, theta theta, gamma_rz).
        double D[4][4] = { { mu2 * 2 / 3, -mu2 / 3, -mu2 / 3, 0 },
                           { -mu2 / 3, mu2 * 2 / 3, -mu2 / 3, 0 },
                           { -mu2 / 3, -mu2 / 3, mu2 * 2 / 3, 0 },
                           { 0, 0, 0, mu2 / 2 } };
        if (dual && point.kappa != 0)
          {
            const double *S = point.stress, *e = point.strain_rate;
            const double  length =
                std::sqrt(1.5 * (S[0] * S[0] + S[1] * S[1] + S[2] * S[2] + 2 * S[3] * S[3]));
            const double scale = length > point.flow_stress ? point.flow_stress / length
                                                            : 1; // back to the yield surface
            const double half  = 0.5 * w * point.kappa * scale;
            for (unsigned int i = 0; i < 4; ++i)
              for (unsigned int j = 0; j < 4; ++j)
                D[i][j] -= half * (S[i] * e[j] + e[i] * S[j]);
          }

        const double *gr = geometry.grad_r[q], *gz = geometry.grad_z[q],
                     *h = geometry.shape_over_r[q];
        double r0[n_nodes], r1[n_nodes], r2[n_nodes], r3[n_nodes], z1[n_nodes], z3[n_nodes];
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            // D b for the r-column b = (gr, 0, h, gz) and the z-column b = (0, gz, 0, gr) of node a
            r0[a] = D[0][0] * gr[a] + D[0][2] * h[a] + D[0][3] * gz[a];
            r1[a] = D[1][0] * gr[a] + D[1][2] * h[a] + D[1][3] * gz[a];
            r2[a] = D[2][0] * gr[a] + D[2][2] * h[a] + D[2][3] * gz[a];
            r3[a] = D[3][0] * gr[a] + D[3][2] * h[a] + D[3][3] * gz[a];
            z1[a] = D[1][1] * gz[a] + D[1][3] * gr[a];
            z3[a] = D[3][1] * gz[a] + D[3][3] * gr[a];
          }
        for (unsigned int a = 0; a < n_nodes; ++a)
          for (unsigned int b = 0; b < n_nodes; ++b)
            {
              rr[a][b] += r0[a] * gr[b] + r2[a] * h[b] + r3[a] * gz[b];
              rz[a][b] += r1[a] * gz[b] + r3[a] * gr[b];
              zz[a][b] += z1[a] * gz[b] + z3[a] * gr[b];
            }
      }

    for (unsigned int a = 0; a < n_nodes; ++a)
      for (unsigned int b = 0; b < n_nodes; ++b)
        {
          matrix[2 * a][2 * b]         = rr[a][b];
          matrix[2 * a][2 * b + 1]     = rz[a][b];
          matrix[2 * b + 1][2 * a]     = rz[a][b];
          matrix[2 * a + 1][2 * b + 1] = zz[a][b];
        }

    // lambda J^T M^-1 J as three outer products of the rows of L^-1 J
    const auto  &L    = divergence.factor;
    const auto  &J    = flux_gradient;
    const double root = std::sqrt(lambda);
    double       y[n_pressure][n_dofs];
    for (unsigned int j = 0; j < n_dofs; ++j)
      {
        y[0][j] = root * J[0][j] / L[0][0];
        y[1][j] = (root * J[1][j] - L[1][0] * y[0][j]) / L[1][1];
        y[2][j] = (root * J[2][j] - L[2][0] * y[0][j] - L[2][1] * y[1][j]) / L[2][2];
      }
    for (unsigned int i = 0; i < n_dofs; ++i)
      for (unsigned int j = 0; j < n_dofs; ++j)
        matrix[i][j] += y[0][i] * y[0][j] + y[1][i] * y[1][j] + y[2][i] * y[2][j];
  }
} // namespace axiforge::solvers
