// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/numbers.h>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <axiforge/laws/deviatoric.h>
#include <axiforge/laws/smm_layer.h>

using namespace axiforge;
using namespace axiforge::laws;

namespace
{
  const double pi = dealii::numbers::PI;

  Material power_law(const double strength, const double exponent)
  {
    MaterialParameters parameters;
    parameters.model         = "power law";
    parameters.strength      = strength;
    parameters.rate_exponent = exponent;
    return Material(parameters, "Material", ".");
  }

  Material perfectly_plastic(const double yield)
  {
    MaterialParameters parameters;
    parameters.yield_stress = yield;
    return Material(parameters, "Material", ".");
  }

  std::array<Vector2, 3> uniform(const double r, const double z)
  {
    return { { Vector2({ r, z }), Vector2({ r, z }), Vector2({ r, z }) } };
  }

  const double length = 3.;

  /// The outer face r = radius of a workpiece, @p length long, that slides along its tool.
  SmmEdge vertical_edge(const double radius, const double slip)
  {
    SmmEdge edge;
    edge.nodes     = { { Point(radius, 0.), Point(radius, length), Point(radius, 0.5 * length) } };
    edge.normals   = uniform(1., 0.);
    edge.slip      = uniform(0., slip);
    edge.weights   = { { 1. / 6., 1. / 6., 4. / 6. } };
    edge.strain    = { { 0., 0., 0. } };
    edge.thickness = 0.4;
    edge.beta      = 0.6;
    return edge;
  }

  /// A curved edge with a slip that is different everywhere.
  SmmEdge general_edge()
  {
    SmmEdge edge;
    edge.nodes   = { { Point(5., 1.), Point(6.5, 2.2), Point(5.7, 1.8) } };
    edge.normals = { { Vector2({ -0.6, 0.8 }), Vector2({ -0.5, 0.75 }),
                       Vector2({ -0.62, 0.76 }) } };
    for (Vector2 &normal : edge.normals)
      normal /= normal.norm();
    edge.slip      = { { Vector2({ 0.7, 0.5 }), Vector2({ -0.3, 0.2 }), Vector2({ 0.1, 0.4 }) } };
    edge.weights   = { { 1. / 6., 1. / 6., 4. / 6. } };
    edge.strain    = { { 0.1, 0.3, 0.2 } };
    edge.thickness = 0.2;
    edge.beta      = 1.7;
    edge.smallest_rate = 1e-2;
    return edge;
  }

  SmmResult evaluate(const SmmEdge &edge, const Material &material, const SmmDual &dual = {})
  {
    SmmResult result;
    smm_layer(edge, material, dual, result, true);
    return result;
  }

  /// Force in z and in r.
  double axial(const SmmResult &result)
  {
    return result.force[1] + result.force[3] + result.force[5];
  }
  double radial(const SmmResult &result)
  {
    return result.force[0] + result.force[2] + result.force[4];
  }

  /// The dual that equals the stress of the present slip: an increment of zero does it.
  SmmDual consistent_dual(const SmmEdge &edge, const Material &material)
  {
    SmmDual dual = {};
    smm_update_dual(edge, material, uniform(0., 0.), dual);
    return dual;
  }

  SmmEdge with_unknown(const SmmEdge &edge, const unsigned int i, const double increment)
  {
    SmmEdge moved = edge;
    moved.slip[i / 2][i % 2] += increment;
    return moved;
  }
} // namespace

TEST(SmmLayer, LinearViscousUniformSlip)
{
  // sigma = 300 epsdot has mu = 100. (7/3) (mu/t) beta v on a plane; on a cylinder of radius R the
  // layer's volume grows with r: (2/t) mu beta v (7/6 + t/(4R)).
  const Material m = power_law(300., 1.);
  for (const SmmElement element : { SmmElement::serendipity, SmmElement::lagrange })
    for (const double radius : { 0.7, 10., 1e9 })
      {
        SmmEdge edge           = vertical_edge(radius, -1.3);
        edge.element           = element;
        const SmmResult result = evaluate(edge, m);
        const double    area   = 2. * pi * radius * length;
        const double    tau    = 2. / 0.4 * 100. * 0.6 * (-1.3) * (7. / 6. + 0.4 / (4. * radius));
        EXPECT_NEAR(axial(result) / area, tau, 1e-12 * std::abs(tau));
        EXPECT_NEAR(radial(result) / area, 0., 1e-12 * std::abs(tau));
        EXPECT_NEAR(result.power, -1.3 * axial(result), 1e-12 * result.power);
      }
  // The plane's value as the books have it.
  EXPECT_NEAR(axial(evaluate(vertical_edge(1e9, 1.), m)) / (2. * pi * 1e9 * length),
              7. / 3. * 100. / 0.4 * 0.6, 1e-6);
}

TEST(SmmLayer, SharesOfTheNodesInAUniformTraction)
{
  const Material m    = power_law(300., 1.);
  SmmEdge        edge = vertical_edge(1e9, 1.);
  edge.element        = SmmElement::serendipity;
  SmmResult r         = evaluate(edge, m);
  EXPECT_NEAR(r.force[1] / axial(r), 5. / 14., 1e-8);
  EXPECT_NEAR(r.force[3] / axial(r), 5. / 14., 1e-8);
  EXPECT_NEAR(r.force[5] / axial(r), 4. / 14., 1e-8);
  // If the layer is thin the middle and the ends don't know of each other: under Simpson's shares
  // of a uniform traction their slips are (4/6)/(4/14) : (1/6)/(5/14) = 5 : 1.
  SmmEdge thin   = edge;
  thin.thickness = 1e-6;
  r              = evaluate(thin, m);
  EXPECT_NEAR(r.stiffness(5, 5) / axial(r), 4. / 14., 1e-8);
  EXPECT_NEAR(r.stiffness(5, 1) / axial(r), 0., 1e-8);
  EXPECT_NEAR((r.stiffness(1, 1) + r.stiffness(1, 3)) / axial(r), 5. / 14., 1e-8);

  edge.element = SmmElement::lagrange;
  r            = evaluate(edge, m);
  EXPECT_NEAR(r.force[1] / axial(r), 1. / 6., 1e-8);
  EXPECT_NEAR(r.force[3] / axial(r), 1. / 6., 1e-8);
  EXPECT_NEAR(r.force[5] / axial(r), 4. / 6., 1e-8);
}

TEST(SmmLayer, PerfectlyPlasticUniformSlip)
{
  const Material m = perfectly_plastic(100.);
  const double   k = 100. / std::sqrt(3.);
  for (const SmmElement element : { SmmElement::serendipity, SmmElement::lagrange })
    for (const double slip : { 1e-3, 1., 50. })
      {
        SmmEdge edge       = vertical_edge(1e9, slip);
        edge.element       = element;
        edge.smallest_rate = 1e-12;
        const double area  = 2. * pi * 1e9 * length;
        EXPECT_NEAR(axial(evaluate(edge, m)) / area, 1.25 * 0.6 * k, 1e-8 * k);

        // Neither thickness nor slip matters; on a small radius the layer's volume does: the
        // integral of (1 + eta) |eta - 1/2| is 19/24.
        edge               = vertical_edge(2., slip);
        edge.element       = element;
        edge.smallest_rate = 1e-12;
        edge.thickness     = 1.1;
        EXPECT_NEAR(axial(evaluate(edge, m)) / (2. * pi * 2. * length),
                    0.6 * k * (1.25 + 1.1 / 4. * 19. / 24.), 1e-10 * k);
      }
}

TEST(SmmLayer, FrictionOfTheCellsViscosity)
{
  // mu = 100 given: the same as the linear material, whatever the law says.
  SmmEdge edge             = vertical_edge(10., 2.);
  edge.workpiece_viscosity = true;
  edge.viscosity           = { { 100., 100., 100. } };
  const SmmResult given    = evaluate(edge, perfectly_plastic(1.));
  edge.workpiece_viscosity = false;
  const SmmResult linear   = evaluate(edge, power_law(300., 1.));
  EXPECT_LT((given.force - linear.force).norm(), 1e-12 * linear.force.norm());
  EXPECT_LT((given.stiffness - linear.stiffness).norm(), 1e-12 * linear.stiffness.norm());
}

TEST(SmmLayer, OnlyTheDeviatorResists)
{
  // A plane edge z = 0 pressed into a layer above: e_zz alone, of which the deviator has 4/3 of the
  // power of the same shear rate. A volumetric stiffness would add to that.
  SmmEdge edge     = vertical_edge(1., 0.);
  edge.nodes       = { { Point(2., 0.), Point(6., 0.), Point(4., 0.) } };
  edge.normals     = uniform(0., 1.);
  edge.slip        = uniform(0., 0.5);
  const double mu  = 100.;
  const double tau = 4. / 3. * 7. / 3. * mu / 0.4 * 0.6 * 0.5;
  EXPECT_NEAR(axial(evaluate(edge, power_law(3. * mu, 1.))), tau * pi * (36. - 4.), 1e-9 * tau);

  // No stress has a trace.
  const SmmDual dual = consistent_dual(general_edge(), power_law(80., 0.2));
  for (const auto &s : dual)
    EXPECT_NEAR(s[0] + s[1] + s[2], 0., 1e-12);
}

TEST(SmmLayer, NewtonTangentAgreesWithNumericalDerivativeOfTheForce)
{
  SmmEdge edge = general_edge();
  for (const SmmElement element : { SmmElement::serendipity, SmmElement::lagrange })
    for (const Material &m : { perfectly_plastic(100.), power_law(100., 0.2), power_law(100., 1.) })
      {
        edge.element           = element;
        const SmmResult result = evaluate(edge, m, consistent_dual(edge, m));
        for (unsigned int i = 0; i < 6; ++i)
          {
            const double                      h         = 1e-6;
            const SmmResult                   plus      = evaluate(with_unknown(edge, i, h), m);
            const SmmResult                   minus     = evaluate(with_unknown(edge, i, -h), m);
            const Eigen::Matrix<double, 6, 1> numerical = (plus.force - minus.force) / (2. * h);
            EXPECT_LT((result.stiffness.col(i) - numerical).norm(), 1e-7 * result.stiffness.norm());
          }
      }
}

TEST(SmmLayer, StiffnessIsSymmetricAndPositiveDefinite)
{
  for (const SmmElement element : { SmmElement::serendipity, SmmElement::lagrange })
    for (const double exponent : { 0., 0.2, 1. })
      for (const double stored : { 0., 1., 1e6, -1e6 })
        for (const double eps0 : { 1e-1, 1e-6 })
          {
            const Material m    = power_law(100., exponent);
            SmmEdge        edge = general_edge();
            edge.element        = element;
            edge.smallest_rate  = eps0;
            SmmDual dual        = consistent_dual(edge, m);
            for (unsigned int i = 0; i < n_smm_points; ++i)
              for (unsigned int c = 0; c < 4; ++c)
                dual[i][c] = stored * (dual[i][c] + (c == i % 4 ? 1. : 0.) * (i % 3));
            const SmmResult result = evaluate(edge, m, dual);
            EXPECT_LT((result.stiffness - result.stiffness.transpose()).norm(),
                      1e-14 * result.stiffness.norm());
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(
                result.stiffness);
            EXPECT_GT(eigen.eigenvalues()[0], 0.) << exponent << ' ' << stored << ' ' << eps0;
          }
}

TEST(SmmLayer, PicardStiffnessTimesSlipIsTheForce)
{
  SmmEdge        edge                = general_edge();
  const Material m                   = power_law(100., 0.2);
  edge.picard                        = true;
  const SmmResult             result = evaluate(edge, m, consistent_dual(edge, m));
  Eigen::Matrix<double, 6, 1> slip;
  for (unsigned int i = 0; i < 6; ++i)
    slip[i] = edge.slip[i / 2][i % 2];
  EXPECT_LT((result.stiffness * slip - result.force).norm(), 1e-13 * result.force.norm());
  EXPECT_NEAR(slip.dot(result.force), result.power, 1e-13 * result.power);
  // A stored stress of zero gives the same.
  edge.picard = false;
  EXPECT_LT((evaluate(edge, m).stiffness - result.stiffness).norm(),
            1e-14 * result.stiffness.norm());
}

TEST(SmmLayer, ForceIsTheDerivativeOfThePowerOverRateExponent)
{
  // For sigma = C epsdot^n and eps0 -> 0 the potential is power/(n + 1).
  const Material m       = power_law(100., 0.5);
  SmmEdge        edge    = general_edge();
  edge.smallest_rate     = 1e-9;
  const SmmResult result = evaluate(edge, m);
  for (unsigned int i = 0; i < 6; ++i)
    {
      const double h = 1e-5;
      EXPECT_NEAR(result.force[i],
                  (evaluate(with_unknown(edge, i, h), m).power -
                   evaluate(with_unknown(edge, i, -h), m).power) /
                      (2. * h * 1.5),
                  1e-7 * result.force.norm());
    }
}

TEST(SmmLayer, StoredStressFollowsTheLinearisation)
{
  // The force of the stored stresses after a step is force + stiffness * step: the balance that the
  // Newton step solved. Read off through the work of the stored stress, with a linear material as
  // the measuring instrument: its force is the integral of B^T G (2 mu e').
  const Material m    = power_law(100., 0.1);
  SmmEdge        edge = general_edge();
  SmmDual        dual = consistent_dual(edge, m);
  for (auto &s : dual)
    for (double &component : s)
      component *= 0.8;
  const std::array<Vector2, 3> step = { { Vector2({ 0.05, -0.02 }), Vector2({ 0.01, 0.03 }),
                                          Vector2({ -0.04, 0.02 }) } };
  Eigen::Matrix<double, 6, 1>  d;
  for (unsigned int i = 0; i < 6; ++i)
    d[i] = step[i / 2][i % 2];
  const SmmResult before  = evaluate(edge, m, dual);
  const double    balance = d.dot(before.force + before.stiffness * d);
  smm_update_dual(edge, m, step, dual);

  // Rates of the step at the points, and the points' volumes, from given unit viscosities.
  SmmEdge unit             = edge;
  unit.workpiece_viscosity = true;
  unit.slip                = step;
  double work              = 0.;
  for (unsigned int node = 0; node < 3; ++node)
    {
      unit.viscosity       = {};
      unit.viscosity[node] = 0.5; // s = e'
      SmmDual rates        = {};
      smm_update_dual(unit, m, uniform(0., 0.), rates);
      for (unsigned int q = 4 * node; q < 4 * node + 4; ++q)
        {
          // The volume of one point, written out independently.
          const double gauss  = (q % 2 == 0 ? -1. : 1.) / std::sqrt(3.);
          const bool   near   = q % 4 < 2;
          const double eta    = near ? -0.25 + 0.75 * gauss : 0.75 + 0.25 * gauss;
          const double weight = near ? 0.75 : 0.25;
          const double xi     = node == 0 ? -1. : node == 1 ? 1. : 0.;
          const double y      = 0.5 * (1. + eta) * edge.thickness;
          const double dn[3]  = { xi - 0.5, xi + 0.5, -2. * xi };
          Vector2      t;
          for (unsigned int a = 0; a < 3; ++a)
            t += dn[a] * (edge.nodes[a] + y * edge.normals[a]);
          const Vector2 n      = edge.normals[node];
          const double  r      = edge.nodes[node][0] + y * n[0];
          const double  volume = 2. * pi * r * 0.5 * edge.thickness *
                                std::abs(t[0] * n[1] - t[1] * n[0]) * weight * 2. *
                                edge.weights[node];
          const Tensor4 s(dual[q].data());
          const Tensor4 e(rates[q].data());
          work += volume * edge.beta * contract(s, e);
        }
    }
  EXPECT_NEAR(work, balance, 1e-12 * std::abs(balance));
}

TEST(SmmLayer, ExchangeOfTheEndsPermutesTheResult)
{
  const Material m    = power_law(100., 0.2);
  const SmmEdge  edge = general_edge();
  SmmEdge        back = edge;
  std::swap(back.nodes[0], back.nodes[1]);
  std::swap(back.normals[0], back.normals[1]);
  std::swap(back.slip[0], back.slip[1]);
  std::swap(back.strain[0], back.strain[1]);
  const SmmResult a   = evaluate(edge, m, consistent_dual(edge, m));
  const SmmResult b   = evaluate(back, m, consistent_dual(back, m));
  const int       p[] = { 2, 3, 0, 1, 4, 5 };
  EXPECT_NEAR(a.power, b.power, 1e-13 * a.power);
  for (unsigned int i = 0; i < 6; ++i)
    {
      EXPECT_NEAR(a.force[i], b.force[p[i]], 1e-12 * a.force.norm());
      for (unsigned int j = 0; j < 6; ++j)
        EXPECT_NEAR(a.stiffness(i, j), b.stiffness(p[i], p[j]), 1e-12 * a.stiffness.norm());
    }
}

TEST(SmmLayer, ReflectionInZ)
{
  const Material m      = power_law(100., 0.2);
  const SmmEdge  edge   = general_edge();
  SmmEdge        mirror = edge;
  for (unsigned int a = 0; a < 3; ++a)
    {
      mirror.nodes[a][1] *= -1.;
      mirror.normals[a][1] *= -1.;
      mirror.slip[a][1] *= -1.;
    }
  const SmmResult a = evaluate(edge, m);
  const SmmResult b = evaluate(mirror, m);
  for (unsigned int i = 0; i < 6; ++i)
    EXPECT_NEAR(a.force[i], (i % 2 == 0 ? 1. : -1.) * b.force[i], 1e-12 * a.force.norm());
}

TEST(SmmLayer, BetaAndWeightsScale)
{
  const Material  m    = power_law(100., 0.2);
  SmmEdge         edge = general_edge();
  const SmmResult one  = evaluate(edge, m);
  edge.beta *= 1e4;
  const SmmResult many = evaluate(edge, m);
  EXPECT_LT((many.force - 1e4 * one.force).norm(), 1e-12 * many.force.norm());
  EXPECT_LT((many.stiffness - 1e4 * one.stiffness).norm(), 1e-12 * many.stiffness.norm());
  edge.beta            = 0.;
  const SmmResult none = evaluate(edge, m);
  EXPECT_EQ(none.force.norm() + none.stiffness.norm() + none.power, 0.);

  // The two halves of an edge make the whole of a uniform slip on a straight one.
  SmmEdge whole = vertical_edge(4., 1.);
  SmmEdge half  = whole;
  half.weights  = { { 0.25, 0., 0.25 } };
  EXPECT_NEAR(2. * axial(evaluate(half, m)), axial(evaluate(whole, m)),
              1e-12 * axial(evaluate(whole, m)));
}

TEST(SmmLayer, LeavesOutTheAxisAndFoldedPoints)
{
  const Material m       = power_law(100., 0.2);
  SmmEdge        edge    = vertical_edge(1., 0.);
  edge.nodes             = { { Point(0., 0.), Point(2., 0.), Point(1., 0.) } };
  edge.normals           = uniform(0., 1.);
  edge.slip              = { { Vector2({ 0., 0. }), Vector2({ 1., 0. }), Vector2({ 0.5, 0. }) } };
  const SmmResult result = evaluate(edge, m);
  EXPECT_TRUE(result.force.allFinite());
  EXPECT_TRUE(result.stiffness.allFinite());
  EXPECT_GT(result.power, 0.);

  // A mandrel thinner than the layer: the layer ends at the axis.
  SmmEdge bore   = vertical_edge(0.2, 1.);
  bore.normals   = uniform(-1., 0.);
  bore.thickness = 0.3;
  EXPECT_TRUE(evaluate(bore, m).stiffness.allFinite());
  EXPECT_GT(axial(evaluate(bore, m)), 0.);

  // Normals that meet within the layer.
  SmmEdge fold   = vertical_edge(5., 1.);
  fold.normals   = { { Vector2({ 0.6, 0.8 }), Vector2({ 0.6, -0.8 }), Vector2({ 1., 0. }) } };
  fold.thickness = 5.;
  EXPECT_TRUE(evaluate(fold, m).force.allFinite());
  EXPECT_GT(evaluate(fold, m).power, 0.);
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
