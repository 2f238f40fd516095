// SPDX-License-Identifier: GPL-2.0-or-later
// The ring test, 6:3:2, perfectly plastic with constant shear friction: the bore at mid-height
// against the parallel velocity field of Avitzur (Metal Forming: Processes and Analysis, 1968) and
// the exact answer without friction. doc/ring_calibration.md.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  constexpr double bore = 9, outside = 18, half_height = 6; // mm

  /// The ring as the parallel field sees it: a rectangle, of the whole height.
  struct Ring
  {
    double inner = bore, outer = outside, height = 2 * half_height;

    /**
     * s of v_r = V/(2h) (r - s/r): the square of the neutral radius if that lies within the ring,
     * less than the bore's otherwise. It makes the power of the field smallest:
     *
     *   asinh(s/(sqrt3 Ri^2)) - asinh(s/(sqrt3 Ro^2)) = (2m/h) (Ro + Ri - 2 sqrt s)   if sqrt s >=
     * Ri = (2m/h) (Ro - Ri)              otherwise.
     *
     * The left side grows with s, the right one falls.
     */
    double neutral(const double m) const
    {
      const auto excess = [&](const double s) {
        // With n = Ri the first right side becomes the second.
        const double n = std::max(inner, std::sqrt(s));
        return std::asinh(s / (std::sqrt(3) * inner * inner)) -
               std::asinh(s / (std::sqrt(3) * outer * outer)) -
               2 * m / height * (outer + inner - 2 * n);
      };
      double low = 0, high = outer * outer;
      for (unsigned int i = 0; i < 200; ++i)
        {
          const double middle               = 0.5 * (low + high);
          (excess(middle) < 0 ? low : high) = middle;
        }
      return low;
    }

    Ring moved(const Ring &at, const double m, const double dh) const
    {
      const double s = at.neutral(m);
      return { inner + dh / (2 * at.height) * (at.inner - s / at.inner),
               outer + dh / (2 * at.height) * (at.outer - s / at.outer), height - dh };
    }
  };

  /// Change of the inner diameter [%] at 10, 20, ... 50 % reduction.
  std::vector<double> parallel_field(const double m)
  {
    constexpr unsigned int n = 100; // steps per 10 %
    Ring                   ring;
    std::vector<double>    change;
    const double           dh = 2 * half_height * 0.1 / n;
    for (unsigned int i = 1; i <= 5 * n; ++i)
      {
        ring = ring.moved(ring.moved(ring, m, 0.5 * dh), m, dh);
        if (i % n == 0)
          change.push_back(100 * (ring.inner / bore - 1));
      }
    return change;
  }

  /// The same at mid-height by the program; ends at the last reduction given [%].
  std::vector<double> computed(const double m, const unsigned int last)
  {
    FlowProblem problem(
        Entries{ "Tools = upper", "Process/End time = 100", "Time stepping/Time step = 2",
                 "Gauges = bore", "Gauge bore/Measure = inner radius", "Gauge bore/At = 0" } +
        perfectly_plastic(100) +
        workpiece(geometry("ring.geo"), "RadialCells = 12, AxialCells = 6") +
        platen("upper", half_height, -0.01 * half_height,
               m > 0 ? Entries{ "Law = shear", "Factor = " + number(m) } : Entries{}));
    StepRecord          record;
    std::vector<double> change;
    while (problem.state.time < last - 1e-9)
      {
        const double step = process::choose_step_size(problem.scene, problem.state, record);
        record = process::advance(problem.scene, problem.state, problem.solver(), step, record);
        if (std::lround(record.time) % 10 == 0)
          change.push_back(100 * (record.gauges[0] / bore - 1));
      }
    return change;
  }
} // namespace


TEST(RingCalibration, ParallelFieldHasItsKnownValues)
{
  const std::vector<std::pair<double, std::vector<double>>> known = {
    { 0, { 5.41, 11.80, 19.52, 29.10, 41.42 } },
    { 0.1, { 3.32, 6.72, 10.00, 12.67, 13.64 } },
    { 0.2, { 1.15, 1.51, 0.97, -0.80, -4.81 } },
    { 0.3, { -0.53, -1.73, -3.98, -7.94, -14.92 } }
  };
  for (const auto &[m, values] : known)
    {
      const std::vector<double> found = parallel_field(m);
      for (unsigned int i = 0; i < 5; ++i)
        EXPECT_NEAR(found[i], values[i], 0.006) << "m = " << m << ", " << 10 * (i + 1) << " %";
    }
}


/// r^2 h is constant: 100 (1/sqrt(1 - x) - 1). The error is that of steps of 2 %.
TEST(RingCalibration, WithoutFrictionIsExact)
{
  const std::vector<double> found = computed(0, 50);
  ASSERT_EQ(found.size(), 5u);
  for (unsigned int i = 0; i < 5; ++i)
    EXPECT_NEAR(found[i], 100 * (1 / std::sqrt(0.9 - 0.1 * i) - 1), 0.01) << 10 * (i + 1) << " %";
}


/// The bore stays nearly straight with little friction: within 2 % of the initial diameter.
TEST(RingCalibration, AgreesWithTheParallelFieldForLittleFriction)
{
  for (const auto &[m, last] :
       std::vector<std::pair<double, unsigned int>>{ { 0.1, 40 }, { 0.2, 30 } })
    {
      const std::vector<double> field = parallel_field(m), found = computed(m, last);
      ASSERT_EQ(found.size(), last / 10);
      for (unsigned int i = 0; i < found.size(); ++i)
        EXPECT_NEAR(found[i], field[i], 2.) << "m = " << m << ", " << 10 * (i + 1) << " %";
    }
}


int main(int argc, char *argv[])
{
  ::testing::InitGoogleTest(&argc, argv);
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  return RUN_ALL_TESTS();
}
