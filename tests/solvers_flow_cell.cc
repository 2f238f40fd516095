// SPDX-License-Identifier: GPL-2.0-or-later
// The arithmetic of a group of cells: lanes do not know each other, derivatives are those of the
// values, condensation and recovery solve the whole system.
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <gtest/gtest.h>

#include <axiforge/solvers/flow_cell.h>

using namespace axiforge::solvers;

namespace
{
  constexpr double sigma = 100, smallest_rate = 0.05;

  using Matrix = Eigen::Matrix<double, n_dofs, n_dofs>;
  using Vector = Eigen::Matrix<double, n_dofs, 1>;

  /// Four distorted cells off the axis in a flow that is neither uniform nor free of divergence.
  struct Group
  {
    GroupDofs       x, v;
    GroupGeometry   geometry;
    PointGroup      points;
    GroupDivergence divergence;

    Group()
    {
      const double node[n_nodes][2] = { { 0, 0 },   { 1, 0 },   { 0, 1 },   { 1, 1 },    { 0, 0.5 },
                                        { 1, 0.5 }, { 0.5, 0 }, { 0.5, 1 }, { 0.5, 0.5 } };
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        for (unsigned int a = 0; a < n_nodes; ++a)
          {
            const double r = 1 + 0.7 * lane + node[a][0], z = 0.3 * lane + node[a][1];
            x[2 * a][lane]     = r + 0.1 * std::sin(0.7 * z + lane);
            x[2 * a + 1][lane] = z + 0.1 * std::sin(0.5 * r);
            v[2 * a][lane]     = 0.5 * r + 0.1 * std::sin(r + z);
            v[2 * a + 1][lane] = -z + 0.1 * std::cos(r - z);
          }
      evaluate();
    }

    /// A perfectly plastic material with rounded corner, equation (3) of doc/theory.md.
    void evaluate()
    {
      group_geometry(x, geometry);
      group_divergence(geometry, v, divergence);
      Lanes rate[n_points][4];
      group_strain_rates(geometry, v, rate);
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          {
            const double trace  = (rate[q][0][lane] + rate[q][1][lane] + rate[q][2][lane]) / 3;
            double       square = smallest_rate * smallest_rate;
            for (unsigned int c = 0; c < 4; ++c)
              {
                const double e = c < 3 ? rate[q][c][lane] - trace : 0.5 * rate[q][3][lane];
                points.strain_rate[q][c][lane] = e;
                square += 2. / 3 * (c < 3 ? 1 : 2) * e * e;
              }
            points.viscosity[q][lane]   = sigma / (3 * std::sqrt(square));
            points.kappa[q][lane]       = 2. / 3 / square;
            points.flow_stress[q][lane] = sigma;
            for (unsigned int c = 0; c < 4; ++c)
              points.stress[q][c][lane] =
                  2 * points.viscosity[q][lane] * points.strain_rate[q][c][lane];
          }
    }

    Matrix tangent(const unsigned int lane, const double lambda) const
    {
      Lanes K[n_dofs][n_dofs];
      group_tangent(geometry, points, divergence, divergence.gradient, lambda, true, K);
      Matrix matrix;
      for (unsigned int i = 0; i < n_dofs; ++i)
        for (unsigned int j = 0; j <= i; ++j)
          matrix(i, j) = matrix(j, i) = K[i][j][lane];
      return matrix;
    }

    Vector force(const unsigned int lane) const
    {
      GroupDofs f;
      group_internal_force(geometry, points, f);
      Vector result;
      for (unsigned int i = 0; i < n_dofs; ++i)
        result[i] = f[i][lane];
      return result;
    }
  };
} // namespace


TEST(FlowCell, LanesDoNotKnowEachOther)
{
  const Group all;
  for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      Group alone;
      for (unsigned int i = 0; i < n_dofs; ++i)
        for (unsigned int other = 0; other < n_lanes; ++other)
          {
            alone.x[i][other] = all.x[i][lane];
            alone.v[i][other] = all.v[i][lane];
          }
      alone.evaluate();
      const Matrix K = all.tangent(lane, 1e3);
      for (unsigned int other = 0; other < n_lanes; ++other)
        {
          EXPECT_EQ(alone.tangent(other, 1e3), K);
          EXPECT_EQ(alone.force(other), all.force(lane));
        }
    }
}


TEST(FlowCell, OneCellHasTheGeometryOfAGroup)
{
  const Group group;
  for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      CellDofs x, v;
      for (unsigned int i = 0; i < n_dofs; ++i)
        {
          x[i] = group.x[i][lane];
          v[i] = group.v[i][lane];
        }
      CellGeometry geometry;
      cell_geometry(x, geometry);
      Lanes rates[n_points][4];
      group_strain_rates(group.geometry, group.v, rates);
      for (unsigned int q = 0; q < n_points; ++q)
        {
          double rate[4];
          strain_rate(geometry, q, v, rate);
          for (unsigned int c = 0; c < 4; ++c)
            EXPECT_NEAR(rate[c], rates[q][c][lane], 1e-13);
          EXPECT_NEAR(geometry.weight[q], group.geometry.weight[q][lane], 1e-13);
          for (unsigned int i = 0; i < n_pressure; ++i)
            EXPECT_NEAR(geometry.pressure_basis[q][i], group.geometry.pressure_basis[q][i][lane],
                        1e-14);
        }
    }
}


TEST(FlowCell, TangentIsTheDerivativeOfTheForce)
{
  const double step = 1e-6;
  for (unsigned int j = 0; j < n_dofs; ++j)
    {
      Group up, down;
      up.v[j] += step;
      down.v[j] -= step;
      up.evaluate();
      down.evaluate();
      const Group here;
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          const Vector difference = (up.force(lane) - down.force(lane)) / (2 * step);
          const Matrix K          = here.tangent(lane, 0);
          EXPECT_LT((difference - K.col(j)).norm(), 1e-7 * K.norm()) << j;
        }
    }
}


TEST(FlowCell, PenaltyIsThatOfTheProjectedDivergence)
{
  // v^T K v grows by lambda (G v)^T M^-1 (G v)
  const Group  group;
  const double lambda = 1e4;
  Lanes        projected[n_pressure];
  solve_mass(group.divergence, group.divergence.flux, projected);
  for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      Vector v;
      for (unsigned int i = 0; i < n_dofs; ++i)
        v[i] = group.v[i][lane];
      double square = 0;
      for (unsigned int i = 0; i < n_pressure; ++i)
        square += group.divergence.flux[i][lane] * projected[i][lane];
      EXPECT_GT(square, 0);
      EXPECT_NEAR(v.dot((group.tangent(lane, lambda) - group.tangent(lane, 0)) * v),
                  lambda * square, 1e-9 * lambda * square);
    }
}


TEST(FlowCell, FluxesChangeWithTheMotionOfTheNodes)
{
  const double lag = 0.3, step = 1e-6;
  const Group  here;
  Lanes        J[n_pressure][n_dofs];
  for (unsigned int i = 0; i < n_pressure; ++i)
    for (unsigned int j = 0; j < n_dofs; ++j)
      J[i][j] = here.divergence.gradient[i][j];
  add_flux_of_motion(here.geometry, here.v, lag, J);

  // Fluxes of the velocity v + dv on nodes at x + lag dv, with the pressure basis held.
  const auto flux = [&](const unsigned int j, const double dv) {
    Group moved;
    moved.v[j] += dv;
    moved.x[j] += lag * dv;
    group_geometry(moved.x, moved.geometry);
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int i = 0; i < n_pressure; ++i)
        moved.geometry.pressure_basis[q][i] = here.geometry.pressure_basis[q][i];
    group_divergence(moved.geometry, moved.v, moved.divergence);
    return moved.divergence;
  };
  for (unsigned int j = 0; j < n_dofs; ++j)
    {
      const GroupDivergence up = flux(j, step), down = flux(j, -step);
      for (unsigned int i = 0; i < n_pressure; ++i)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          EXPECT_NEAR((up.flux[i][lane] - down.flux[i][lane]) / (2 * step), J[i][j][lane], 1e-7)
              << i << " " << j;
    }
}


TEST(FlowCell, CondensationAndRecoverySolveTheWholeSystem)
{
  const Group group;
  Lanes       K[n_dofs][n_dofs];
  group_tangent(group.geometry, group.points, group.divergence, group.divergence.gradient, 1e3,
                true, K);
  // Rigid motion along z is free: hold it by a spring at the outer nodes.
  for (unsigned int i = 0; i < n_outer; ++i)
    K[i][i] += 10;
  Matrix    whole[n_lanes];
  Vector    residual;
  GroupDofs r, dv;
  for (unsigned int i = 0; i < n_dofs; ++i)
    {
      residual[i] = std::sin(1. + i);
      r[i]        = residual[i] - Lanes{};
      for (unsigned int j = 0; j <= i; ++j)
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          whole[lane](i, j) = whole[lane](j, i) = K[i][j][lane];
    }
  GroupRecovery kept;
  for (unsigned int i = 0; i < n_pressure; ++i)
    for (unsigned int j = 0; j < n_dofs; ++j)
      kept.flux_gradient[i][j] = group.divergence.gradient[i][j];
  condense_centre(K, r, kept);

  for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      Eigen::Matrix<double, n_outer, n_outer> condensed;
      Eigen::Matrix<double, n_outer, 1>       rhs;
      for (unsigned int i = 0; i < n_outer; ++i)
        {
          rhs[i] = -r[i][lane];
          for (unsigned int j = 0; j <= i; ++j)
            condensed(i, j) = condensed(j, i) = K[i][j][lane];
        }
      const Eigen::Matrix<double, n_outer, 1> outer = condensed.llt().solve(rhs);
      for (unsigned int i = 0; i < n_outer; ++i)
        dv[i][lane] = outer[i];
    }
  Lanes change[n_pressure];
  recover_centre(kept, dv, change);
  for (unsigned int lane = 0; lane < n_lanes; ++lane)
    {
      const Vector exact = -whole[lane].llt().solve(residual);
      for (unsigned int i = 0; i < n_dofs; ++i)
        EXPECT_NEAR(dv[i][lane], exact[i], 1e-10 * exact.norm());
      for (unsigned int i = 0; i < n_pressure; ++i)
        {
          double flux = 0;
          for (unsigned int j = 0; j < n_dofs; ++j)
            flux += group.divergence.gradient[i][j][lane] * exact[j];
          EXPECT_NEAR(change[i][lane], flux, 1e-9 * exact.norm());
        }
    }
}


int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
