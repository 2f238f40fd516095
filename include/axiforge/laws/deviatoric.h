// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace axiforge::laws
{
  /// A symmetric axisymmetric tensor as its four components (rr, zz, theta theta, rz); the last one
  /// is the tensor's (half of the engineering shear gamma_rz).
  using Tensor4 = Eigen::Matrix<double, 4, 1>;

  /// The double contraction a:b.
  inline double contract(const Tensor4 &a, const Tensor4 &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2. * a[3] * b[3];
  }

  /// a - tr(a)/3 I.
  inline Tensor4 deviator(const Tensor4 &a)
  {
    const double mean = (a[0] + a[1] + a[2]) / 3.;
    return { a[0] - mean, a[1] - mean, a[2] - mean, a[3] };
  }

  /// sqrt(2/3 e':e') of a deviatoric strain (rate).
  inline double effective_strain(const Tensor4 &e)
  {
    return std::sqrt(2. / 3. * contract(e, e));
  }

  /// von Mises' sqrt(3/2 s:s) of a stress deviator.
  inline double effective_stress(const Tensor4 &s)
  {
    return std::sqrt(3. / 2. * contract(s, s));
  }
} // namespace axiforge::laws
