// SPDX-License-Identifier: GPL-2.0-or-later
#include <deal.II/base/numbers.h>
#include <deal.II/base/parameter_handler.h>

#include <gtest/gtest.h>

#include <axiforge/base/errors.h>
#include <axiforge/laws/friction.h>

using namespace axiforge;
using namespace axiforge::laws;

namespace
{
  Friction friction(const std::string &text, const double speed = 2., const double length = 0.5)
  {
    FrictionParameters       parameters;
    dealii::ParameterHandler prm;
    parameters.declare(prm);
    prm.parse_input_from_string(text);
    return Friction(parameters, "Tool upper/Friction", speed, length);
  }

  std::string message(const std::string &text, const double speed = 2., const double length = 0.5)
  {
    try
      {
        friction(text, speed, length);
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    return "no error";
  }

#define EXPECT_IN(part, whole) EXPECT_NE((whole).find(part), std::string::npos) << (whole)

  // Contact under 50 MPa of a material with sigma = 100 MPa, which slid backwards before.
  FrictionPoint at(const double slip, const double pressure = 50.)
  {
    return { slip, pressure, 100., -0.7, true };
  }

  const double k = 100. / std::sqrt(3.);

  const std::vector<std::string> laws_of_slip = {
    "set Law = coulomb\n set Coefficient = 0.2",
    "set Law = coulomb\n set Coefficient = 1",
    "set Law = shear\n set Factor = 0.3\n set Regularisation velocity = 0.1",
    "set Law = arctan\n set Factor = 0.8",
    "set Law = norton\n set Viscosity = 7\n set Exponent = 0.25",
    "set Law = norton\n set Viscosity = 7"
  };
} // namespace

TEST(Friction, IsOddRisesAndItsDerivativeAgreesWithTheNumericalOne)
{
  for (const std::string &text : laws_of_slip)
    {
      const Friction f    = friction(text);
      double         last = -1.;
      for (const double slip : { 0., 1e-5, 1e-3, 2e-3, 0.05, 0.3, 2., 40. })
        {
          SCOPED_TRACE(fmt::format("{}, slip {}", text, slip));
          const FrictionResponse a = f.evaluate(at(slip));
          const FrictionResponse b = f.evaluate(at(-slip));
          EXPECT_EQ(a.traction, -b.traction);
          EXPECT_EQ(a.derivative, b.derivative);
          EXPECT_EQ(a.secant, b.secant);
          EXPECT_NEAR(a.secant * slip, a.traction, 1e-13 * a.traction);
          EXPECT_GE(a.derivative, 0.);
          EXPECT_LE(a.derivative, a.secant * (1. + 1e-14));
          EXPECT_GT(a.traction, last);
          last = a.traction;

          const double h = 1e-6 * std::max(slip, 1e-3);
          const double numerical =
              (f.evaluate(at(slip + h)).traction - f.evaluate(at(slip - h)).traction) / (2. * h);
          EXPECT_NEAR(a.derivative, numerical, 1e-7 * a.secant);
        }
      // At rest the secant is the derivative.
      EXPECT_EQ(f.evaluate(at(0.)).traction, 0.);
      EXPECT_NEAR(f.evaluate(at(0.)).derivative, f.evaluate(at(0.)).secant,
                  1e-14 * f.evaluate(at(0.)).secant);
    }
}

TEST(Friction, ReachesItsLimit)
{
  const double pi = dealii::numbers::PI;
  // Coulomb: mu p while that is below k, then k.
  EXPECT_NEAR(friction(laws_of_slip[0]).evaluate(at(1e3)).traction, 0.2 * 50., 1e-9);
  EXPECT_NEAR(friction(laws_of_slip[1]).evaluate(at(1e3, 80.)).traction, k, 1e-9);
  EXPECT_EQ(friction(laws_of_slip[0]).evaluate(at(3., 0.)).traction, 0.);
  EXPECT_EQ(friction(laws_of_slip[0]).evaluate(at(3., -9.)).traction, 0.);
  EXPECT_NEAR(friction(laws_of_slip[0]).cap(1e9, 100.), k, 1e-12);
  // Shear: 1/sqrt2 of m k at v0 = 0.1.
  EXPECT_NEAR(friction(laws_of_slip[2]).evaluate(at(0.1)).traction, 0.3 * k / std::sqrt(2.), 1e-12);
  EXPECT_NEAR(friction(laws_of_slip[2]).evaluate(at(1e4)).traction, 0.3 * k, 1e-8);
  EXPECT_NEAR(friction(laws_of_slip[2]).cap(0., 100.), 0.3 * k, 1e-12);
  // Arctan: a half of m k at v0 = 1e-3 of the speed 2 mm/s, two thirds at sqrt3 v0.
  EXPECT_NEAR(friction(laws_of_slip[3]).evaluate(at(2e-3)).traction, 0.4 * k, 1e-12);
  EXPECT_NEAR(friction(laws_of_slip[3]).evaluate(at(2e-3 * std::sqrt(3.))).traction,
              0.8 * k * 2. / 3., 1e-12);
  EXPECT_NEAR(friction(laws_of_slip[3]).evaluate(at(2.)).traction, 0.8 * k * (1. - 2. / pi * 1e-3),
              1e-6);
  // Norton: K v^q, exactly so if linear.
  EXPECT_NEAR(friction(laws_of_slip[4]).evaluate(at(16.)).traction, 14., 1e-6);
  EXPECT_EQ(friction(laws_of_slip[5]).evaluate(at(0.3)).traction, 7. * 0.3);
  EXPECT_TRUE(std::isinf(friction(laws_of_slip[5]).cap(1., 1.)));
  EXPECT_EQ(friction("").evaluate(at(1.)).traction, 0.);
  EXPECT_EQ(friction("").cap(1., 1.), 0.);
}

TEST(Friction, TangentialForcesFollowTheLastSlipAlone)
{
  const Friction f = friction(
      "set Law = tangential forces\n set Factor = 0.5\n set Regularisation velocity = 1e-3");
  FrictionPoint point{ 3., 50., 100., -0.7, false };
  EXPECT_EQ(f.evaluate(point).traction, 0.); // the first step is frictionless
  point.has_previous = true;
  EXPECT_NEAR(f.evaluate(point).traction, -0.5 * k, 1e-4);
  EXPECT_EQ(f.evaluate(point).derivative, 0.);
  point.slip = -3.;
  EXPECT_NEAR(f.evaluate(point).traction, -0.5 * k, 1e-4);
  point.previous_slip = 0.; // what didn't slide isn't pushed
  EXPECT_EQ(f.evaluate(point).traction, 0.);
  point.previous_slip = 0.2;
  EXPECT_NEAR(f.evaluate(point).traction, 0.5 * k, 1e-3);
}

TEST(Friction, PrimalDualTangentLiesBetweenPicardAndBeyondNewton)
{
  for (const std::string &text : laws_of_slip)
    for (const double slip : { -3., -1e-3, 1e-4, 0.2 })
      {
        const Friction         f   = friction(text);
        const FrictionResponse r   = f.evaluate(at(slip));
        const double           cap = f.cap(50., 100.);
        EXPECT_NEAR(primal_dual_tangent(r, r.traction, cap), r.derivative, 1e-12 * r.secant);
        EXPECT_EQ(primal_dual_tangent(r, 0., cap), r.secant);
        for (const double stored : { -1e9, -1., 1., 1e9 })
          EXPECT_GE(primal_dual_tangent(r, stored, cap), 0.);
      }
  // Newton's method on T v/sqrt(v^2 + v0^2) = 0.999 T from far away diverges; this one converges.
  const Friction f =
      friction("set Law = shear\n set Factor = 1\n set Regularisation velocity = 1e-3");
  const double cap    = f.cap(0., 100.);
  double       slip   = 1.;
  double       stored = 0.;
  for (unsigned int i = 0; i < 30; ++i)
    {
      const FrictionResponse r       = f.evaluate(at(slip));
      const double           tangent = primal_dual_tangent(r, stored, cap);
      const double           step    = (0.999 * cap - r.traction) / tangent;
      stored                         = r.traction + tangent * step;
      slip += step;
    }
  EXPECT_NEAR(f.evaluate(at(slip)).traction, 0.999 * cap, 1e-10 * cap);
}

TEST(Friction, AutomaticValues)
{
  EXPECT_EQ(friction("set Law = shear\n set Factor = 0.1", 20.).regularisation_velocity(), 0.02);
  EXPECT_EQ(friction(laws_of_slip[2]).regularisation_velocity(), 0.1);
  EXPECT_EQ(friction("set Law = smm\n set Factor = 0.1", 0.).layer_thickness(), 0.5);
  EXPECT_EQ(friction("set Law = smm\n set Factor = 0\n set Layer thickness = 2").layer_thickness(),
            2.);
  EXPECT_EQ(friction("set Law = sticking", 0., 0.).kind(), FrictionKind::sticking);
}

TEST(Friction, SmmFactor)
{
  EXPECT_EQ(friction("set Law = smm\n set Factor = 0").beta(), 0.);
  EXPECT_DOUBLE_EQ(friction("set Law = smm\n set Factor = 0.5").beta(), 1.);
  EXPECT_NEAR(friction("set Law = smm\n set Factor = 0.9999").beta(), 9999., 1e-7);
  EXPECT_FALSE(friction("set Law = smm\n set Factor = 0").workpiece_viscosity());
  EXPECT_TRUE(friction("set Law = smm\n set Factor = 0\n set Layer viscosity = workpiece")
                  .workpiece_viscosity());
  EXPECT_EQ(friction("set Law = smm\n set Factor = 0").layer_element(), SmmElement::lagrange);
  EXPECT_EQ(
      friction("set Law = smm\n set Factor = 0\n set Layer element = serendipity").layer_element(),
      SmmElement::serendipity);
  EXPECT_EQ(friction("set Law = smm\n set Factor = 0.25").factor(), 0.25);
  EXPECT_ANY_THROW(friction("set Law = smm\n set Factor = 0").evaluate(at(1.)));
  // Where it cannot be a condition: the shear yield stress against the slip.
  EXPECT_DOUBLE_EQ(friction("set Law = sticking").cap(0, 90.), 90. / std::sqrt(3.));
}

TEST(FrictionErrors, NameTheEntryTheRangeAndTheWayOut)
{
  struct Fault
  {
    std::string text, entry, says;
  };
  const std::vector<Fault> faults = {
    { "set Law = coulomb\n set Coefficient = -0.1", "Coefficient\" = \"-0.1\"", "0 or more" },
    { "set Law = shear\n set Factor = 1.2", "Factor\" = \"1.2\"", "0 to 1" },
    { "set Law = arctan\n set Factor = -1", "Factor", "0 to 1" },
    { "set Law = tangential forces\n set Factor = 2", "Factor", "0 to 1" },
    { "set Law = smm\n set Factor = 1", "Factor\" = \"1\"", "Law = sticking" },
    { "set Law = smm\n set Factor = -0.2", "Factor", "at least 0 and less than 1" },
    { "set Law = coulomb\n set Coefficient = 12", "Coefficient\" = \"12\"", "12 % is 0.12" },
    { "set Law = shear\n set Factor = 30", "Factor\" = \"30\"", "30 % is 0.3" },
    // Left out, which is not 0.
    { "set Law = coulomb", "Coefficient\" = \"\"", "needed here and not given" },
    { "set Law = shear", "Factor\" = \"\"", "needed here and not given" },
    { "set Law = arctan", "Factor", "needed here and not given" },
    { "set Law = tangential forces", "Factor", "Law = none" },
    { "set Law = smm", "Factor", "needed here and not given" },
    { "set Law = norton\n set Exponent = 0.5", "Viscosity\" = \"\"", "needed here and not given" },
    { "set Law = smm\n set Factor = 0.5\n set Layer thickness = -1", "Layer thickness",
      "0 or more" },
    { "set Law = norton\n set Viscosity = -1", "Viscosity", "0 or more" },
    { "set Law = norton\n set Viscosity = 1\n set Exponent = 0", "Exponent", "Law = shear" },
    { "set Law = norton\n set Viscosity = 1\n set Exponent = 1.5", "Exponent",
      "more than 0, up to 1" },
    { "set Law = shear\n set Factor = 0\n set Regularisation velocity = -1",
      "Regularisation velocity", "0 or more" },
    // Entries of another law.
    { "set Factor = 0.3", "Factor\" = \"0.3\"", "Law = none, which has no further entries" },
    { "set Law = sticking\n set Coefficient = 0.3", "Coefficient", "its default 0" },
    { "set Law = coulomb\n set Factor = 0.3", "Factor", "Coefficient, Regularisation velocity" },
    { "set Law = shear\n set Coefficient = 0.3", "Coefficient", "Factor, Regularisation velocity" },
    { "set Law = shear\n set Layer viscosity = workpiece", "Layer viscosity", "Remove the entry" },
    { "set Law = smm\n set Regularisation velocity = 1", "Regularisation velocity",
      "Layer thickness" }
  };
  for (const Fault &fault : faults)
    {
      const std::string text = message(fault.text);
      EXPECT_IN("Tool upper/Friction/" + fault.entry, text);
      EXPECT_IN(fault.says, text);
    }
  EXPECT_IN("because no tool moves", message("set Law = shear\n set Factor = 0", 0.));
  EXPECT_IN("no length to choose it from", message("set Law = smm\n set Factor = 0", 2., 0.));

  FrictionParameters parameters;
  parameters.law = "coulom";
  try
    {
      Friction(parameters, "Tool upper/Friction", 1., 1.);
      FAIL();
    }
  catch (const InputError &error)
    {
      EXPECT_IN("Did you mean \"coulomb\"?", std::string(error.what()));
    }
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
