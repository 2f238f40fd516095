// SPDX-License-Identifier: GPL-2.0-or-later
// The estimated condition number of a matrix whose spectrum is known: second differences with
// diagonal 2, 1/cond = tan^2(pi / (2 (n + 1))); a diagonal scaling of it must not matter.
#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <axiforge/solvers/condition.h>

using namespace axiforge::solvers;

namespace
{
  double estimate(const unsigned int n, const Eigen::VectorXd &scaling)
  {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (unsigned int i = 0; i < n; ++i)
      {
        A(i, i) = 2;
        if (i > 0)
          A(i, i - 1) = A(i - 1, i) = -1;
      }
    A = scaling.asDiagonal() * A * scaling.asDiagonal();
    const Eigen::LLT<Eigen::MatrixXd> factor(A);
    return estimate_condition(
        A.diagonal(), [&](const Eigen::VectorXd &x) -> Eigen::VectorXd { return A * x; },
        [&](const Eigen::VectorXd &b) -> Eigen::VectorXd { return factor.solve(b); });
  }

  double exact(const unsigned int n)
  {
    return 1 / std::pow(std::tan(M_PI / (2 * (n + 1.))), 2);
  }
} // namespace


TEST(Condition, IsExactOnceTheSpectrumIsExhausted)
{
  for (const unsigned int n : { 1, 2, 5, 30 })
    EXPECT_NEAR(estimate(n, Eigen::VectorXd::Ones(n)) / exact(n), 1, 1e-10) << n;
}


TEST(Condition, IsAnEstimateFromBelowAndFreeOfScaling)
{
  const unsigned int n = 400;
  Eigen::VectorXd    scaling(n);
  for (unsigned int i = 0; i < n; ++i)
    scaling[i] = std::pow(10, 4 * std::sin(0.7 * i));
  const double plain = estimate(n, Eigen::VectorXd::Ones(n)), scaled = estimate(n, scaling);
  EXPECT_LE(plain, exact(n) * (1 + 1e-9));
  EXPECT_GT(plain, 0.95 * exact(n));
  EXPECT_NEAR(scaled / plain, 1, 1e-6);
}


int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
