// SPDX-License-Identifier: GPL-2.0-or-later
// What a study computes from its runs: orders and limits of sequences that have them exactly,
// curves interpolated on the stroke, the variations that the section asks for, ticks of the plot.
#include <cmath>
#include <functional>

#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/base/errors.h>
#include <axiforge/study/analysis.h>
#include <axiforge/study/plot.h>
#include <axiforge/study/report.h>
#include <axiforge/study/study.h>

using namespace axiforge;
using namespace axiforge::study;
using axiforge::testing_support::TemporaryFolder;

namespace
{
  double a_plus_b_h_p(const double h, const double p)
  {
    return 312.5 - 7.25 * std::pow(h, p);
  }


  /// The history of a run with n steps over a stroke of 10 mm at 2 mm/s: a force that holds at the
  /// middle of a step, a radius that holds at its end.
  History history(const unsigned int                          n,
                  const std::function<double(double stroke)> &force,
                  const std::function<double(double stroke)> &radius)
  {
    History result;
    result.columns = { "stroke_mm",     "time_s",        "stroke_middle_mm",
                       "time_middle_s", "force_upper_N", "largest_radius_mm" };
    for (unsigned int step = 1; step <= n; ++step)
      {
        const double end = 10. * step / n, middle = 10. * (step - 0.5) / n;
        result.rows.push_back({ end, end / 2, middle, middle / 2, force(middle), radius(end) });
      }
    return result;
  }


  Run run_with(const History &history)
  {
    Run run;
    run.history = history;
    run.steps   = history.rows.size();
    return run;
  }


  std::string message_of(const std::function<void()> &action)
  {
    try
      {
        action();
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    return "no error";
  }


  /// The plan of a scene with a tool and the section's lines.
  Plan plan_of(const std::string &lines)
  {
    const TemporaryFolder folder;
    const std::string     path =
        folder.file("scene.prm", "set Tools = upper\nsubsection Workpiece\nset Geometry parameters "
                                 "= Radius = 25, RadialCells = 18\nend\nsubsection Study\n" +
                                     lines + "\nend\n");
    return make_plan(scene::SceneParameters(ParameterFile(path)));
  }
} // namespace


TEST(Richardson, FindsOrderAndLimitOfExactSequences)
{
  for (const double p : { 0.5, 1., 2., 3.7, 4. })
    for (const double ratio : { 1.5, 2., 3. })
      {
        SCOPED_TRACE(fmt::format("p {} ratio {}", p, ratio));
        const double     h     = 0.8;
        const Richardson found = extrapolate(a_plus_b_h_p(h, p), a_plus_b_h_p(h / ratio, p),
                                             a_plus_b_h_p(h / ratio / ratio, p), ratio);
        EXPECT_EQ(found.remark, "");
        EXPECT_NEAR(found.order, p, 1e-10);
        EXPECT_NEAR(found.limit, 312.5, 1e-10);
        EXPECT_NEAR(found.error, 7.25 * std::pow(h / ratio / ratio, p), 1e-10);
      }
}


TEST(Richardson, InventsNoOrder)
{
  EXPECT_EQ(extrapolate(1, 2, 1.5, 2).remark, "not monotone");
  EXPECT_EQ(extrapolate(1, 1, 1.5, 2).remark, "not monotone");
  EXPECT_EQ(extrapolate(1, 2, 3, 2).remark, "the differences do not fall");
  EXPECT_EQ(extrapolate(1, 2, 4, 2).remark, "the differences do not fall");
  EXPECT_EQ(extrapolate(1, 2, 2.99, 2).remark, "the differences do not fall"); // p = 0.014
  EXPECT_EQ(extrapolate(3, 2, 2, 2).remark, "no change beyond rounding");
  EXPECT_EQ(extrapolate(1, NAN, 2, 2).remark, "a value is missing");
  for (const Richardson &none : { extrapolate(1, 2, 1.5, 2), extrapolate(1, 2, 4, 2),
                                  extrapolate(3, 2, 2, 2), extrapolate(1, NAN, 2, 2) })
    {
      EXPECT_TRUE(std::isnan(none.order));
      EXPECT_TRUE(std::isnan(none.limit));
      EXPECT_TRUE(std::isnan(none.error));
    }
}


TEST(Richardson, FindsOrderFromDistancesToTheFinest)
{
  for (const double p : { 1., 2., 4. })
    for (const double ratio : { 2., 3. })
      {
        const double f1 = a_plus_b_h_p(1, p), f2 = a_plus_b_h_p(1 / ratio, p),
                     f3        = a_plus_b_h_p(1 / ratio / ratio, p);
        const Richardson found = extrapolate_distances(std::abs(f1 - f3), std::abs(f2 - f3), ratio);
        EXPECT_NEAR(found.order, p, 1e-10);
        EXPECT_NEAR(found.error, std::abs(f3 - 312.5), 1e-10);
      }
  EXPECT_EQ(extrapolate_distances(1, 0.6, 2).remark, "the differences do not fall");
  EXPECT_EQ(extrapolate_distances(0, 0, 2).remark, "no change beyond rounding");
}


TEST(Richardson, OrderOfErrors)
{
  EXPECT_NEAR(order_of_errors(-0.08, 0.01, 2), 3, 1e-12);
  EXPECT_TRUE(std::isnan(order_of_errors(0, 0.01, 2)));
  EXPECT_TRUE(std::isnan(order_of_errors(0.01, 0, 2)));
}


TEST(Curves, AreInterpolatedExactlyUpToCubics)
{
  const auto cubic = [](const double x) { return 3 - 2 * x + 0.5 * x * x - 0.04 * x * x * x; };
  Curve      curve;
  for (const double x : { 0.5, 1.1, 2.7, 3., 4.2, 6.9 })
    {
      curve.place.push_back(x);
      curve.value.push_back(cubic(x));
    }
  for (double x = 0.5; x <= 6.9; x += 0.1)
    EXPECT_NEAR(interpolate(curve, x), cubic(x), 1e-11) << x;
  EXPECT_EQ(interpolate(curve, 2.7), cubic(2.7));

  // Beyond the ends by half a step, through three points.
  const auto parabola = [](const double x) { return 3 - 2 * x + 0.5 * x * x; };
  for (unsigned int i = 0; i < curve.place.size(); ++i)
    curve.value[i] = parabola(curve.place[i]);
  EXPECT_NEAR(interpolate(curve, 0.2), parabola(0.2), 1e-11);
  EXPECT_NEAR(interpolate(curve, 8.2), parabola(8.2), 1e-11);
  EXPECT_TRUE(std::isnan(interpolate(curve, 0.19)));
  EXPECT_TRUE(std::isnan(interpolate(curve, 8.3)));
}


TEST(Curves, StandWhereTheirQuantityHolds)
{
  const auto    line  = [](const double x) { return 5 + x; };
  const History run   = history(5, line, line);
  const Curve   force = curve_of(run, "force_upper_N", false),
              radius  = curve_of(run, "largest_radius_mm", false);
  EXPECT_NEAR(force.place.front(), 1, 1e-12);
  EXPECT_NEAR(force.place.back(), 9, 1e-12);
  EXPECT_NEAR(radius.place.front(), 2, 1e-12);
  EXPECT_NEAR(radius.place.back(), 10, 1e-12);
  EXPECT_NEAR(interpolate(force, 10), 15, 1e-12);
  EXPECT_NEAR(interpolate(radius, 10), 15, 1e-12);
  EXPECT_NEAR(curve_of(run, "largest_radius_mm", true).place.back(), 5, 1e-12); // in seconds
}


TEST(Curves, RmsDifferenceOfKnownCurves)
{
  // Two lines that differ by 0.3 everywhere, given at different places.
  Curve a, b;
  for (double x = 0; x <= 10; x += 1)
    {
      a.place.push_back(x);
      a.value.push_back(2 * x);
    }
  for (double x = 1; x <= 8; x += 0.35)
    {
      b.place.push_back(x);
      b.value.push_back(2 * x + 0.3);
    }
  EXPECT_NEAR(rms_difference(a, b), 0.3, 1e-11);
  EXPECT_NEAR(rms_difference(b, a), 0.3, 1e-11);
  // Against zero: sqrt of the mean of (2 x)^2 over 0..10 is sqrt(400 / 3), by 400 points to 1 %.
  Curve zero = a;
  zero.value.assign(zero.place.size(), 0);
  EXPECT_NEAR(rms_difference(a, zero) / std::sqrt(400. / 3), 1, 0.01);
  for (double &x : b.place)
    x += 100;
  EXPECT_TRUE(std::isnan(rms_difference(a, b)));
}


// A scheme of second order in the step: the value at the end has that order only if the force,
// which holds at the middle of the step, is taken to the end of the stroke.
TEST(Analysis, OrdersInTheStepAreThoseOfTheScheme)
{
  Plan plan;
  plan.ratio      = 2;
  plan.at         = Place::end;
  plan.quantities = { "force_upper_N", "largest_radius_mm" };
  plan.references = { 1000 + 20 * 10 + 100, NAN };
  std::vector<study::Run> runs;
  for (const unsigned int n : { 5, 10, 20, 40 })
    {
      const double h = 10. / n;
      runs.push_back(run_with(history(
          n, [&](const double x) { return 1000 + 20 * x + x * x + 3 * h * h; },
          [&](const double x) { return 25 + 0.5 * x - 0.1 * h * h; })));
    }
  std::vector<Item> items = analyse(plan, runs, false);
  ASSERT_EQ(items.size(), 2u);
  EXPECT_NEAR(items[0].convergence[3].order, 2, 1e-8);
  EXPECT_NEAR(items[0].convergence[3].limit, 1300, 1e-8);
  EXPECT_NEAR(items[0].error[3], 3 * 0.25 * 0.25 / 1300, 1e-10);
  EXPECT_NEAR(items[0].error_order[3], 2, 1e-8);
  EXPECT_NEAR(items[1].convergence[2].order, 2, 1e-8);
  EXPECT_NEAR(items[1].convergence[2].limit, 30, 1e-8);
  EXPECT_TRUE(std::isnan(items[1].error[3]));
  EXPECT_TRUE(std::isnan(items[0].convergence[1].order));

  plan.at         = Place::whole_curve;
  plan.references = { NAN, NAN };
  items           = analyse(plan, runs, false);
  EXPECT_NEAR(items[0].value[2], 3 * (0.5 * 0.5 - 0.25 * 0.25), 1e-8);
  EXPECT_EQ(items[0].value[3], 0);
  EXPECT_NEAR(items[0].convergence[3].error, 3 * 0.25 * 0.25, 1e-8);

  plan.at      = Place::strokes;
  plan.strokes = { 3, 7, 11 };
  items        = analyse(plan, runs, false);
  ASSERT_EQ(items.size(), 6u);
  EXPECT_NEAR(items[1].convergence[3].limit, 1000 + 20 * 7 + 49, 1e-8);
  EXPECT_TRUE(std::isnan(items[2].value[3])); // 11 mm are not reached
}


TEST(Analysis, AFailedRunHasNoValueAtTheEndAndNoOrderCountsIt)
{
  Plan plan;
  plan.ratio      = 2;
  plan.at         = Place::end;
  plan.quantities = { "largest_radius_mm" };
  plan.references = { NAN };
  std::vector<study::Run> runs;
  for (const unsigned int n : { 5, 10, 20, 40, 80 })
    runs.push_back(run_with(history(
        n, [](double) { return 1.; }, [&](double) { return 25 + 1. / n; })));
  runs[1].failure               = "a cell turns over";
  const std::vector<Item> items = analyse(plan, runs, false);
  EXPECT_TRUE(std::isnan(items[0].value[1]));
  EXPECT_TRUE(std::isnan(items[0].difference[2]));
  EXPECT_EQ(items[0].convergence[3].remark, "a value is missing");
  EXPECT_NEAR(items[0].convergence[4].order, 1, 1e-8);
  EXPECT_NEAR(items[0].convergence[4].limit, 25, 1e-8);
  EXPECT_NE(markdown_report("t", plan, runs, items).find("a cell turns over"), std::string::npos);
}


TEST(Plan, GathersTheOverrides)
{
  const Plan one = plan_of("set Entry = refinement\nset Values = 0; 1;2");
  ASSERT_EQ(one.variations.size(), 3u);
  EXPECT_EQ(one.variations[2].overrides,
            std::vector<std::string>{ "Workpiece/Refinement levels = 2" });
  EXPECT_EQ(one.variations[2].number, 2);

  const Plan grid = plan_of("set Entry = Workpiece/Geometry parameters/RadialCells; "
                            "Workpiece/Geometry parameters/AxialCells; Title\nset Values = 4; "
                            "8 | 6 | eight by six");
  ASSERT_EQ(grid.variations.size(), 2u);
  EXPECT_EQ(grid.variations[0].overrides,
            (std::vector<std::string>{
                "Title = 4",
                "Workpiece/Geometry parameters = Radius = 25, RadialCells = 4, AxialCells = 4" }));
  EXPECT_EQ(grid.variations[1].overrides,
            (std::vector<std::string>{
                "Title = eight by six",
                "Workpiece/Geometry parameters = Radius = 25, RadialCells = 8, AxialCells = 6" }));
  EXPECT_TRUE(std::isnan(grid.variations[1].number));

  // A value keeps its commas.
  const Plan commas = plan_of("set Entry = Tool upper/Motion/Velocity\nset Values = 0, -1; 0, -2;");
  ASSERT_EQ(commas.variations.size(), 2u);
  EXPECT_EQ(commas.variations[1].overrides[0], "Tool upper/Motion/Velocity = 0, -2");
}


TEST(Plan, TellsFaults)
{
  const auto fault = [](const std::string &lines) { return message_of([&] { plan_of(lines); }); };
  const std::string good = "set Entry = refinement\nset Values = 0; 1\n";
  EXPECT_EQ(fault(good), "no error");
  EXPECT_NE(fault("set Values = 1").find("the scene has no study"), std::string::npos);
  EXPECT_NE(fault("set Entry = refinement").find("there are no values"), std::string::npos);
  EXPECT_NE(fault("set Entry = refinement\nset Values = 1;;2").find("is empty"), std::string::npos);
  EXPECT_NE(fault("set Entry = a; b; c\nset Values = 1 | 2").find("2 parts for 3 entries"),
            std::string::npos);
  EXPECT_NE(fault("set Entry = Tool lower/Geometry parameters/Z\nset Values = 1")
                .find("no section \"Tool lower\""),
            std::string::npos);
  EXPECT_NE(fault(good + "set At = middle").find("\"middle\" is not a stroke"), std::string::npos);
  EXPECT_NE(fault(good + "set At = all\nset Reference = 1").find("no single value"),
            std::string::npos);
  EXPECT_NE(fault(good + "set At = all\nset Single velocity solve = true").find("no curve"),
            std::string::npos);
  EXPECT_NE(fault(good + "set Reference = much").find("\"much\" is not a number"),
            std::string::npos);
  EXPECT_NE(fault(good + "set Refinement ratio = 0.5").find("a number above 1"), std::string::npos);
}


TEST(Plot, TicksCoverTheAxis)
{
  EXPECT_EQ(linear_ticks(0, 10), (std::vector<double>{ 0, 2, 4, 6, 8, 10 }));
  EXPECT_EQ(log_ticks(0.5, 2000), (std::vector<double>{ 1, 10, 100, 1000 }));
  for (const double low : { -3., 0., 1e-9, 202800. })
    for (const double range : { 1e-3, 0.7, 30., 4e6 })
      {
        const std::vector<double> ticks = linear_ticks(low, low + range);
        EXPECT_GE(ticks.size(), 3u);
        EXPECT_LE(ticks.size(), 8u);
        EXPECT_GE(ticks.front(), low - 1e-6 * range);
        EXPECT_LE(ticks.back(), low + range * (1 + 1e-6));
      }
  for (const double low : { 1e-9, 3., 20000. })
    for (const double factor : { 1.3, 4., 50., 1e7 })
      EXPECT_GE(log_ticks(low, low * factor).size(), 2u) << low << " " << factor;
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
