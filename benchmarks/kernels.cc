// SPDX-License-Identifier: GPL-2.0-or-later
// Time of the kernels that a step consists of, with Google Benchmark; benchmarks/kernels.py makes
// the table.
#include <deal.II/base/parameter_handler.h>

#include <benchmark/benchmark.h>

#include <axiforge/base/blas.h>
#include <axiforge/laws/material.h>
#include <axiforge/laws/smm_layer.h>
#include <axiforge/solvers/flow_cell.h>
#include <axiforge/tools/profile.h>

extern "C" void dgemm_(const char *,
                       const char *,
                       const int *,
                       const int *,
                       const int *,
                       const double *,
                       const double *,
                       const int *,
                       const double *,
                       const int *,
                       const double *,
                       double *,
                       const int *);

using namespace axiforge;

namespace
{
  laws::Material material(const std::string &entries)
  {
    laws::MaterialParameters parameters;
    dealii::ParameterHandler prm;
    parameters.declare(prm);
    prm.parse_input_from_string(entries);
    return laws::Material(parameters, "Material", ".");
  }


  // Groups of cells: a few hundred cells with different curved shapes, so that nothing is the same
  // twice running. Times are those of a group, n_lanes cells.

  constexpr unsigned int n_groups = 64;
  constexpr double       penalty  = 1e8;

  struct Group
  {
    solvers::GroupDofs       x, v;
    solvers::GroupGeometry   geometry;
    solvers::GroupDivergence divergence;
    solvers::PointGroup      points;
  };

  std::vector<Group> make_groups()
  {
    using namespace solvers;
    constexpr double node[n_nodes][2] = { { 0, 0 },  { 1, 0 },  { 0, 1 },  { 1, 1 },  { 0, .5 },
                                          { 1, .5 }, { .5, 0 }, { .5, 1 }, { .5, .5 } };
    std::vector<Group> groups(n_groups);
    for (unsigned int g = 0; g < n_groups; ++g)
      {
        Group &group = groups[g];
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          for (unsigned int a = 0; a < n_nodes; ++a)
            {
              const unsigned int cell = n_lanes * g + lane;
              const double       r = 1 + cell % 16 + node[a][0], z = cell / 16 + node[a][1];
              group.x[2 * a][lane]     = r + 0.1 * std::sin(0.7 * z);
              group.x[2 * a + 1][lane] = z + 0.1 * std::sin(0.5 * r);
              group.v[2 * a][lane]     = 0.5 * r + 0.05 * std::sin(r + z);
              group.v[2 * a + 1][lane] = -z + 0.05 * std::cos(r - z);
            }
        group_geometry(group.x, group.geometry);
        group_divergence(group.geometry, group.v, group.divergence);
        Lanes rates[n_points][4];
        group_strain_rates(group.geometry, group.v, rates);
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            {
              PointGroup  &p     = group.points;
              const double trace = (rates[q][0][lane] + rates[q][1][lane] + rates[q][2][lane]) / 3;
              double       norm  = 0;
              for (unsigned int c = 0; c < 4; ++c)
                {
                  const double e = c < 3 ? rates[q][c][lane] - trace : 0.5 * rates[q][3][lane];
                  p.strain_rate[q][c][lane] = e;
                  norm += (c < 3 ? 1 : 2) * e * e;
                }
              const double effective    = std::sqrt(2. / 3 * norm);
              p.flow_stress[q][lane]    = 100;
              p.viscosity[q][lane]      = 100 / (3 * effective);
              p.kappa[q][lane]          = 2. / 3 / (effective * effective);
              for (unsigned int c = 0; c < 4; ++c)
                p.stress[q][c][lane] = 2 * p.viscosity[q][lane] * p.strain_rate[q][c][lane];
            }
      }
    return groups;
  }

  const Group &group(const unsigned int g)
  {
    static const std::vector<Group> groups = make_groups();
    return groups[g % n_groups];
  }


  void group_geometry(benchmark::State &state)
  {
    solvers::GroupGeometry geometry;
    unsigned int           g = 0;
    for (auto _ : state)
      {
        solvers::group_geometry(group(g++).x, geometry);
        benchmark::DoNotOptimize(geometry);
      }
  }
  BENCHMARK(group_geometry);


  void group_divergence(benchmark::State &state)
  {
    solvers::GroupDivergence divergence;
    unsigned int             g = 0;
    for (auto _ : state)
      {
        const Group &all = group(g++);
        solvers::group_divergence(all.geometry, all.v, divergence);
        benchmark::DoNotOptimize(divergence);
      }
  }
  BENCHMARK(group_divergence);


  void group_internal_force(benchmark::State &state)
  {
    unsigned int       g = 0;
    solvers::GroupDofs force;
    for (auto _ : state)
      {
        const Group &all = group(g++);
        solvers::group_internal_force(all.geometry, all.points, force);
        benchmark::DoNotOptimize(force);
      }
  }
  BENCHMARK(group_internal_force);


  void group_flux_of_motion(benchmark::State &state)
  {
    unsigned int   g                                                 = 0;
    solvers::Lanes J[solvers::n_pressure][solvers::n_dofs] = {};
    for (auto _ : state)
      {
        const Group &all = group(g++);
        solvers::add_flux_of_motion(all.geometry, all.v, 1e-3, J);
        benchmark::DoNotOptimize(J);
      }
  }
  BENCHMARK(group_flux_of_motion);


  void group_tangent(benchmark::State &state)
  {
    solvers::Lanes K[solvers::n_dofs][solvers::n_dofs];
    unsigned int   g = 0;
    for (auto _ : state)
      {
        const Group &all = group(g++);
        solvers::group_tangent(all.geometry, all.points, all.divergence, all.divergence.gradient,
                               penalty, true, K);
        benchmark::DoNotOptimize(K);
      }
  }
  BENCHMARK(group_tangent);


  /// The tangent with its centre node condensed, as the flow solver assembles it.
  void group_tangent_condensed(benchmark::State &state)
  {
    solvers::Lanes         K[solvers::n_dofs][solvers::n_dofs];
    solvers::GroupDofs     residual = {};
    solvers::GroupRecovery kept;
    unsigned int           g = 0;
    for (auto _ : state)
      {
        const Group &all = group(g++);
        solvers::group_tangent(all.geometry, all.points, all.divergence, all.divergence.gradient,
                               penalty, true, K);
        solvers::condense_centre(K, residual, kept);
        benchmark::DoNotOptimize(K);
        benchmark::DoNotOptimize(kept);
      }
  }
  BENCHMARK(group_tangent_condensed);


  // Material laws, at strains and rates that change from call to call.

  void material_law(benchmark::State &state, const char *entries)
  {
    const laws::Material law = material(entries);
    unsigned int         i   = 0;
    for (auto _ : state)
      {
        const double strain = 1e-3 * (i % 701), rate = 1e-3 + 1e-4 * (i % 997);
        ++i;
        benchmark::DoNotOptimize(law.flow_stress(strain, rate));
      }
  }
  BENCHMARK_CAPTURE(material_law, perfectly_plastic, "set Yield stress = 100");
  BENCHMARK_CAPTURE(material_law,
                    power_law,
                    "set Model = power law\n set Strength coefficient = 100\n"
                    "set Rate exponent = 0.2");
  BENCHMARK_CAPTURE(material_law,
                    perzyna,
                    "set Model = perzyna\n set Yield stress = 100\n set Rate exponent = 0.2");
  BENCHMARK_CAPTURE(material_law,
                    hollomon,
                    "set Model = hollomon\n set Strength coefficient = 500\n"
                    "set Hardening exponent = 0.2");
  BENCHMARK_CAPTURE(material_law,
                    ludwik,
                    "set Model = ludwik\n set Yield stress = 200\n"
                    "set Strength coefficient = 400\n set Hardening exponent = 0.3");
  BENCHMARK_CAPTURE(material_law,
                    swift,
                    "set Model = swift\n set Strength coefficient = 500\n"
                    "set Hardening exponent = 0.2\n set Prestrain = 0.01");
  BENCHMARK_CAPTURE(material_law,
                    voce,
                    "set Model = voce\n set Yield stress = 200\n set Saturation stress = 400\n"
                    "set Characteristic strain = 0.2");
  BENCHMARK_CAPTURE(material_law,
                    swift_and_power,
                    "set Model = product\n set Hardening = swift\n"
                    "set Strength coefficient = 100\n set Hardening exponent = 0.2\n"
                    "set Prestrain = 0.01\n set Rate sensitivity = power\n"
                    "set Rate exponent = 0.02\n set Reference strain rate = 0.01");
  BENCHMARK_CAPTURE(material_law,
                    voce_and_johnson_cook,
                    "set Model = product\n set Hardening = voce\n set Yield stress = 200\n"
                    "set Saturation stress = 400\n set Characteristic strain = 0.2\n"
                    "set Rate sensitivity = johnson-cook\n set Rate coefficient = 0.02");

  void material_law_table(benchmark::State &state)
  {
    std::vector<double> strains, stresses;
    for (unsigned int i = 0; i < 12; ++i)
      strains.push_back(0.07 * i);
    const std::vector<double> rates = { 1e-3, 1e-2, 1e-1, 1, 10 };
    for (const double strain : strains)
      for (const double rate : rates)
        stresses.push_back(100 * std::pow(0.01 + strain, 0.2) * std::pow(rate, 0.02));
    const laws::FlowStressTable law(strains, rates, stresses);
    unsigned int                i = 0;
    for (auto _ : state)
      {
        const double strain = 1e-3 * (i % 701), rate = 1e-3 + 1e-4 * (i % 997);
        ++i;
        benchmark::DoNotOptimize(law(strain, rate));
      }
  }
  BENCHMARK(material_law_table);


  // Tools.

  tools::Profile oriented(const std::vector<tools::Segment> &segments)
  {
    tools::Profile profile(segments);
    profile.orient({ Point(0, -20), Point(20, -20), Point(20, -9), Point(10, -9), Point(0, -9) });
    return profile;
  }

  /// z = 0
  tools::Profile platen()
  {
    return oriented({ tools::Segment::line(Point(0, 0), Point(200, 0)) });
  }

  /// A flat end, a fillet, a cone of 45 degrees, a fillet and a flat rim.
  tools::Profile cone()
  {
    const double c = 2 * std::sqrt(0.5); // of the fillets' radius of 2 mm
    const Point  a(8 + c, 2 - c), b(a[0] + 8, a[1] + 8), centre(b[0] + c, b[1] - c);
    const Point  rim(centre[0], centre[1] + 2);
    return oriented({ tools::Segment::line(Point(0, 0), Point(8, 0)),
                      tools::Segment::arc(Point(8, 0), a, Point(8, 2), true),
                      tools::Segment::line(a, b), tools::Segment::arc(b, rim, centre, false),
                      tools::Segment::line(rim, Point(200, rim[1])) });
  }

  /// Points all along the outline up to r = 40 mm, @p distance below it: near ones touch, far ones
  /// are beyond the reach of the search.
  void closest_point(benchmark::State &state, const tools::Profile &profile, const double distance)
  {
    std::vector<Point> points;
    for (const auto &chain : profile.sample(1e-3))
      for (std::size_t k = 0; k + 1 < chain.size(); ++k)
        for (unsigned int i = 0; i < 64; ++i)
          {
            const Point x = chain[k] + (i / 64.) * (chain[k + 1] - chain[k]);
            if (x[0] < 40)
              points.push_back(Point(x[0], x[1] - distance));
          }
    std::array<tools::Contact, 2> contacts;
    std::size_t                   i     = 0;
    constexpr double              reach = 1.25; // 5 % of a workpiece of 25 mm, as in a contact set
    for (auto _ : state)
      {
        benchmark::DoNotOptimize(profile.find(points[i], reach, contacts));
        benchmark::DoNotOptimize(contacts);
        i = i + 1 < points.size() ? i + 1 : 0;
      }
  }
  BENCHMARK_CAPTURE(closest_point, flat_near, platen(), 0.01);
  BENCHMARK_CAPTURE(closest_point, flat_far, platen(), 15);
  BENCHMARK_CAPTURE(closest_point, cone_with_fillets_near, cone(), 0.01);
  BENCHMARK_CAPTURE(closest_point, cone_with_fillets_far, cone(), 15);


  // The SMM friction layer of one edge.

  void smm_element(benchmark::State &state, const laws::SmmElement element, const bool stiffness)
  {
    const laws::Material law = material(
        "set Model = product\n set Hardening = swift\n set Strength coefficient = 100\n"
        "set Hardening exponent = 0.2\n set Prestrain = 0.01\n set Rate sensitivity = power\n"
        "set Rate exponent = 0.02\n set Reference strain rate = 0.01");
    laws::SmmEdge edge;
    edge.nodes = { { Point(5., 1.), Point(6.5, 2.2), Point(5.7, 1.8) } };
    edge.normals.fill(Vector2({ -0.6, 0.8 }));
    edge.slip      = { { Vector2({ 0.7, 0.5 }), Vector2({ -0.3, 0.2 }), Vector2({ 0.1, 0.4 }) } };
    edge.weights   = { { 1. / 6., 1. / 6., 4. / 6. } };
    edge.strain    = { { 0.1, 0.3, 0.2 } };
    edge.thickness = 0.2;
    edge.beta      = 1;
    edge.smallest_rate = 1e-5;
    edge.element       = element;
    const laws::SmmDual dual{};
    laws::SmmResult     result;
    for (auto _ : state)
      {
        benchmark::DoNotOptimize(edge);
        laws::smm_layer(edge, law, dual, result, stiffness);
        benchmark::DoNotOptimize(result);
      }
  }
  BENCHMARK_CAPTURE(smm_element, lagrange_force, laws::SmmElement::lagrange, false);
  BENCHMARK_CAPTURE(smm_element, lagrange_force_and_stiffness, laws::SmmElement::lagrange, true);
  BENCHMARK_CAPTURE(smm_element,
                    serendipity_force_and_stiffness,
                    laws::SmmElement::serendipity,
                    true);


  /// What the BLAS of the factorisation can do at best: C -= A B^T of n x n matrices.
  void dgemm(benchmark::State &state)
  {
    const int           n = state.range(0);
    std::vector<double> a(n * n, 1.), b(n * n, 0.5), c(n * n, 0.);
    const double        minus = -1, one = 1;
    for (auto _ : state)
      {
        dgemm_("N", "T", &n, &n, &n, &minus, a.data(), &n, b.data(), &n, &one, c.data(), &n);
        benchmark::DoNotOptimize(c.data());
      }
    state.counters["operations"] =
        benchmark::Counter(2. * n * n * n, benchmark::Counter::kIsIterationInvariantRate);
  }
  BENCHMARK(dgemm)->RangeMultiplier(2)->Range(16, 1024);
} // namespace


int main(int argc, char **argv)
{
  axiforge::use_suitable_blas();
  axiforge::use_one_thread();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
    return 1;
  benchmark::RunSpecifiedBenchmarks();
}
