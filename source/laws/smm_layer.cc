// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/exceptions.h>
#include <deal.II/base/numbers.h>

#include <axiforge/laws/deviatoric.h>
#include <axiforge/laws/smm_layer.h>

namespace axiforge::laws
{
  namespace
  {
    using Strains = Eigen::Matrix<double, 4, 6>;
    using Vector6 = Eigen::Matrix<double, 6, 1>;

    /// The reference element at one layer point: a node's xi and one eta.
    struct ReferencePoint
    {
      double eta;
      double weight; // of eta; the four of one node sum to 2

      std::array<double, 3> geometry_dxi; // d N_a / d xi of the edge's quadratic functions
      // The element's functions of the edge's three nodes.
      std::array<double, 3> shape;
      std::array<double, 3> shape_dxi;
      std::array<double, 3> shape_deta;
    };

    using ReferencePoints = std::array<ReferencePoint, n_smm_points>;

    ReferencePoints make_reference_points(const SmmElement element)
    {
      const std::array<double, 3> node_xi = { { -1., 1., 0. } };
      const double                gauss   = 1. / std::sqrt(3.);

      ReferencePoints points;
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int q = 0; q < 4; ++q)
          {
            ReferencePoint &p  = points[4 * a + q];
            const double    xi = node_xi[a];
            // The parts [-1, 1/2] and [1/2, 1].
            const double middle = q < 2 ? -0.25 : 0.75;
            const double half   = q < 2 ? 0.75 : 0.25;
            const double eta    = middle + (q % 2 == 0 ? -gauss : gauss) * half;
            p.eta               = eta;
            p.weight            = half;
            p.geometry_dxi      = { { xi - 0.5, xi + 0.5, -2. * xi } };
            if (element == SmmElement::lagrange)
              {
                const std::array<double, 3> along = { { 0.5 * xi * (xi - 1.), 0.5 * xi * (xi + 1.),
                                                        1. - xi * xi } };
                for (unsigned int b = 0; b < 3; ++b)
                  {
                    p.shape[b]      = 0.5 * eta * (eta - 1.) * along[b];
                    p.shape_dxi[b]  = 0.5 * eta * (eta - 1.) * p.geometry_dxi[b];
                    p.shape_deta[b] = (eta - 0.5) * along[b];
                  }
                continue;
              }
            for (unsigned int b = 0; b < 2; ++b)
              {
                const double s  = node_xi[b];
                p.shape[b]      = 0.25 * (1. + s * xi) * (1. - eta) * (s * xi - eta - 1.);
                p.shape_dxi[b]  = 0.25 * (1. - eta) * (2. * xi - s * eta);
                p.shape_deta[b] = 0.25 * (1. + s * xi) * (2. * eta - s * xi);
              }
            p.shape[2]      = 0.5 * (1. - xi * xi) * (1. - eta);
            p.shape_dxi[2]  = -xi * (1. - eta);
            p.shape_deta[2] = -0.5 * (1. - xi * xi);
          }
      return points;
    }

    const ReferencePoints serendipity_points = make_reference_points(SmmElement::serendipity);
    const ReferencePoints lagrange_points    = make_reference_points(SmmElement::lagrange);

    /// One point of the layer: where it is and what moves it.
    struct LayerPoint
    {
      double  volume;      // 2 pi r |det J| times the weights [mm^3]; 0: leave the point out
      Strains deviatoric;  // nodal slip -> deviator of the strain rate [1/mm]
      Tensor4 strain_rate; // the deviator [1/s]
    };

    Tensor4 strain_rate_of(const Strains &operator_, const std::array<Vector2, 3> &nodal)
    {
      Vector6 v;
      for (unsigned int a = 0; a < 3; ++a)
        v.segment<2>(2 * a) << nodal[a][0], nodal[a][1];
      return operator_ * v;
    }

    LayerPoint layer_point(const SmmEdge &edge, const unsigned int index)
    {
      const ReferencePoint &reference =
          (edge.element == SmmElement::lagrange ? lagrange_points : serendipity_points)[index];
      const unsigned int node = index / 4;
      LayerPoint         point;
      point.volume = 0.;
      if (edge.weights[node] == 0. || edge.nodes[node][0] <= 0.)
        return point;

      const double height = 0.5 * (1. + reference.eta) * edge.thickness;
      Vector2      edge_tangent, tangent;
      for (unsigned int a = 0; a < 3; ++a)
        {
          edge_tangent += reference.geometry_dxi[a] * edge.nodes[a];
          tangent += reference.geometry_dxi[a] * (edge.nodes[a] + height * edge.normals[a]);
        }
      const Vector2 across      = 0.5 * edge.thickness * edge.normals[node];
      const double  r           = edge.nodes[node][0] + height * edge.normals[node][0];
      const double  determinant = cross(tangent, across);
      if (r <= 0. || determinant * cross(edge_tangent, across) <= 0.)
        return point;

      point.volume = 2. * dealii::numbers::PI * r * std::abs(determinant) * reference.weight * 2. *
                     edge.weights[node];
      point.deviatoric.setZero();
      for (unsigned int a = 0; a < 3; ++a)
        {
          const double dr =
              (reference.shape_dxi[a] * across[1] - reference.shape_deta[a] * tangent[1]) /
              determinant;
          const double dz =
              (reference.shape_deta[a] * tangent[0] - reference.shape_dxi[a] * across[0]) /
              determinant;
          const Tensor4 of_r(dr, 0., reference.shape[a] / r, 0.5 * dz);
          const Tensor4 of_z(0., dz, 0., 0.5 * dr);
          point.deviatoric.col(2 * a)     = deviator(of_r);
          point.deviatoric.col(2 * a + 1) = deviator(of_z);
        }
      point.strain_rate = strain_rate_of(point.deviatoric, edge.slip);
      return point;
    }

    /// Stress and the constants of the primal-dual tangent at one point.
    struct PointLaw
    {
      double  viscosity; // mu [MPa s]
      double  kappa;     // s^2
      Tensor4 projected; // S~ [MPa]
    };

    PointLaw point_law(const SmmEdge               &edge,
                       const Material              &material,
                       const unsigned int           node,
                       const Tensor4               &strain_rate,
                       const std::array<double, 4> &stored)
    {
      if (edge.workpiece_viscosity)
        return { edge.viscosity[node], 0., Tensor4::Zero() };

      const double square =
          2. / 3. * contract(strain_rate, strain_rate) + edge.smallest_rate * edge.smallest_rate;
      const double     rate   = std::sqrt(square);
      const FlowStress stress = material.flow_stress(edge.strain[node], rate);
      PointLaw         law{ stress.value / (3. * rate), 0., Tensor4::Zero() };
      if (edge.picard)
        return law;

      const double sensitivity = std::clamp(stress.d_strain_rate * rate / stress.value, 0., 1.);
      law.kappa                = 2. / 3. * (1. - sensitivity) / square;
      law.projected            = Tensor4(stored[0], stored[1], stored[2], stored[3]);
      const double size        = effective_stress(law.projected);
      if (size > stress.value)
        law.projected *= stress.value / size;
      return law;
    }
  } // namespace

  void smm_layer(const SmmEdge  &edge,
                 const Material &material,
                 const SmmDual  &dual,
                 SmmResult      &result,
                 const bool      with_stiffness)
  {
    Assert(edge.smallest_rate > 0., dealii::ExcMessage("The layer needs a smallest strain rate."));
    result.force.setZero();
    result.power = 0.;
    if (with_stiffness)
      result.stiffness.setZero();
    if (edge.beta == 0.)
      return;

    const Eigen::Vector4d metric(1., 1., 1., 2.); // of the double contraction
    for (unsigned int i = 0; i < n_smm_points; ++i)
      {
        const LayerPoint point = layer_point(edge, i);
        if (point.volume == 0.)
          continue;
        const PointLaw law = point_law(edge, material, i / 4, point.strain_rate, dual[i]);

        // B^T G: contracts a stress with the strain rate of each unknown.
        const Eigen::Matrix<double, 6, 4> virtual_strain =
            point.deviatoric.transpose() * metric.asDiagonal();
        const Vector6 of_rate = virtual_strain * point.strain_rate;
        const double  scale   = point.volume * edge.beta;

        result.force += (scale * 2. * law.viscosity) * of_rate;
        result.power += scale * 2. * law.viscosity * contract(point.strain_rate, point.strain_rate);
        if (!with_stiffness)
          continue;

        result.stiffness.noalias() +=
            (scale * 2. * law.viscosity) * (virtual_strain * point.deviatoric);
        if (law.kappa > 0.)
          {
            const Vector6 of_stored = virtual_strain * law.projected;
            result.stiffness.noalias() -=
                (scale * 0.5 * law.kappa) *
                (of_stored * of_rate.transpose() + of_rate * of_stored.transpose());
          }
      }
  }

  void smm_update_dual(const SmmEdge                &edge,
                       const Material               &material,
                       const std::array<Vector2, 3> &slip_increment,
                       SmmDual                      &dual)
  {
    for (unsigned int i = 0; i < n_smm_points; ++i)
      {
        const LayerPoint point = layer_point(edge, i);
        if (point.volume == 0.)
          {
            dual[i] = {};
            continue;
          }
        const Tensor4  increment = strain_rate_of(point.deviatoric, slip_increment);
        const PointLaw law       = point_law(edge, material, i / 4, point.strain_rate, dual[i]);

        const Tensor4 stress = 2. * law.viscosity * (point.strain_rate + increment) -
                               0.5 * law.kappa *
                                   (contract(point.strain_rate, increment) * law.projected +
                                    contract(law.projected, increment) * point.strain_rate);
        for (unsigned int c = 0; c < 4; ++c)
          dual[i][c] = stress[c];
      }
  }
} // namespace axiforge::laws
