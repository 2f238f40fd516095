// SPDX-License-Identifier: GPL-2.0-or-later
#include <filesystem>
#include <fstream>

#include <deal.II/base/parameter_handler.h>

#include <gtest/gtest.h>

#include <axiforge/base/errors.h>
#include <axiforge/base/notes.h>
#include <axiforge/laws/material.h>

using namespace axiforge;
using namespace axiforge::laws;

namespace
{
  // What the user writes, read as the program reads it.
  Material material(const std::string &text, const std::string &directory = ".")
  {
    MaterialParameters       parameters;
    dealii::ParameterHandler prm;
    parameters.declare(prm);
    prm.parse_input_from_string(text);
    return Material(parameters, "Material", directory);
  }

  std::string message(const std::string &text, const std::string &directory = ".")
  {
    try
      {
        material(text, directory);
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    return "no error";
  }

#define EXPECT_IN(part, whole) EXPECT_NE((whole).find(part), std::string::npos) << (whole)

  struct Case
  {
    const char *name;
    const char *text;
  };

  const std::vector<Case> all_models = {
    { "perfectly plastic", "set Yield stress = 100" },
    { "power law",
      "set Model = power law\n set Strength coefficient = 80\n set Rate exponent = 0.2\n"
      "set Reference strain rate = 3" },
    { "linear", "set Model = power law\n set Strength coefficient = 80\n set Rate exponent = 1" },
    { "perzyna", "set Model = perzyna\n set Yield stress = 100\n set Rate exponent = 0.3\n"
                 "set Reference strain rate = 5" },
    { "hollomon",
      "set Model = hollomon\n set Strength coefficient = 500\n set Hardening exponent = 0.2\n"
      "set Smallest strain = 0.01" },
    { "ludwik", "set Model = ludwik\n set Yield stress = 200\n set Strength coefficient = 400\n"
                "set Hardening exponent = 0.3\n set Smallest strain = 0.01" },
    { "swift",
      "set Model = swift\n set Strength coefficient = 600\n set Hardening exponent = 0.25\n"
      "set Prestrain = 0.02" },
    { "voce", "set Model = voce\n set Yield stress = 120\n set Saturation stress = 300\n"
              "set Characteristic strain = 0.2" },
    { "product, power",
      "set Model = product\n set Hardening = swift\n set Rate sensitivity = power\n"
      "set Strength coefficient = 600\n set Hardening exponent = 0.25\n set Prestrain = 0.02\n"
      "set Rate exponent = 0.1\n set Reference strain rate = 2" },
    { "product, cowper-symonds",
      "set Model = product\n set Hardening = ludwik\n set Rate sensitivity = cowper-symonds\n"
      "set Yield stress = 200\n set Strength coefficient = 400\n set Hardening exponent = 1\n"
      "set Rate exponent = 0.2\n set Reference strain rate = 40" },
    { "product, johnson-cook",
      "set Model = product\n set Hardening = voce\n set Rate sensitivity = johnson-cook\n"
      "set Yield stress = 120\n set Saturation stress = 300\n set Characteristic strain = 0.2\n"
      "set Rate coefficient = 0.1\n set Reference strain rate = 10" },
    { "product, nothing", "set Model = product\n set Yield stress = 100" }
  };
} // namespace

TEST(Material, DerivativesAgreeWithNumericalOnes)
{
  for (const Case &c : all_models)
    {
      const Material m = material(c.text);
      for (const double strain : { 1e-3, 0.004, 0.0098, 0.0102, 0.1, 0.7, 3. })
        for (const double rate : { 1e-6, 1e-3, 0.03, 0.2, 1., 7., 300. })
          {
            SCOPED_TRACE(fmt::format("{}, strain {}, rate {}", c.name, strain, rate));
            const FlowStress s  = m.flow_stress(strain, rate);
            const double     de = 1e-5 * strain;
            const double     dr = 1e-5 * rate;
            const double     by_strain =
                (m.flow_stress(strain + de, rate).value - m.flow_stress(strain - de, rate).value) /
                (2. * de);
            const double by_rate =
                (m.flow_stress(strain, rate + dr).value - m.flow_stress(strain, rate - dr).value) /
                (2. * dr);
            EXPECT_NEAR(s.d_strain * strain, by_strain * strain, 1e-7 * s.value);
            EXPECT_NEAR(s.d_strain_rate * rate, by_rate * rate, 1e-7 * s.value);
            EXPECT_GT(s.value, 0.);
            EXPECT_GE(s.d_strain_rate, 0.);
            EXPECT_LE(s.d_strain_rate * rate, s.value * (1. + 1e-14));
          }
    }
}

TEST(Material, StaysFiniteAtStrainZeroAndAtRest)
{
  for (const Case &c : all_models)
    for (const double strain : { 0., -1e-3 })
      for (const double rate : { 0., 1e-300, 1e-12 })
        {
          SCOPED_TRACE(c.name);
          const FlowStress s = material(c.text).flow_stress(strain, rate);
          EXPECT_TRUE(std::isfinite(s.value) && std::isfinite(s.d_strain) &&
                      std::isfinite(s.d_strain_rate));
          EXPECT_GT(s.value, 0.);
          EXPECT_EQ(s.value, material(c.text).flow_stress(0., rate).value);
        }
}

TEST(Material, ValuesByHand)
{
  const auto stress = [](const std::size_t i, const double strain, const double rate) {
    return material(all_models[i].text).flow_stress(strain, rate).value;
  };
  EXPECT_EQ(stress(0, 0.3, 5.), 100.);
  EXPECT_NEAR(stress(1, 0.3, 96.), 160., 1e-11);   // 80 (32)^0.2
  EXPECT_NEAR(stress(2, 0.3, 0.25), 20., 1e-12);   // 80 x 0.25
  EXPECT_NEAR(stress(3, 0.3, 5.), 200., 1e-12);    // twice the yield stress at gamma
  EXPECT_NEAR(stress(4, 1., 5.), 500., 1e-12);     // K at strain 1
  EXPECT_NEAR(stress(5, 1., 5.), 600., 1e-12);     // sigma0 + K
  EXPECT_NEAR(stress(6, 0.98, 5.), 600., 1e-12);   // K at prestrain + strain = 1
  EXPECT_NEAR(stress(6, 0.0425, 5.), 300., 1e-11); // 600 (1/16)^0.25
  EXPECT_NEAR(stress(7, 0.2, 5.), 300. - 180. / std::exp(1.), 1e-11);
  // At the reference rate the stress is the hardening law's; at rest with cowper-symonds.
  EXPECT_NEAR(stress(8, 0.98, 2.), 600., 1e-12);
  EXPECT_NEAR(stress(9, 0.5, 40.), 2. * 400., 1e-12);
  EXPECT_NEAR(stress(10, 0., 10.), 120., 1e-12);
  EXPECT_NEAR(stress(10, 0., 100.), 120. * (1. + 0.1 * std::log(10.)), 1e-11);
}

TEST(Material, SmallestStrainContinuesWithValueAndSlope)
{
  // Ludwik begins at the yield stress itself, Hollomon at K eps_s^n (1 - n).
  EXPECT_EQ(material(all_models[5].text).flow_stress(0., 1.).value, 200.);
  EXPECT_NEAR(material(all_models[4].text).flow_stress(0., 1.).value,
              500. * std::pow(0.01, 0.2) * 0.8, 1e-12);
  for (const std::size_t i : { 4, 5 })
    {
      const Material   m     = material(all_models[i].text);
      const FlowStress below = m.flow_stress(0.01 - 1e-13, 1.);
      const FlowStress above = m.flow_stress(0.01 + 1e-13, 1.);
      EXPECT_NEAR(below.value, above.value, 1e-9);
      EXPECT_NEAR(below.d_strain, above.d_strain, 1e-9 * above.d_strain);
    }
}

TEST(Material, JohnsonCookStaysPositiveAndSmoothFarBelowTheReference)
{
  const Material m = material(all_models[10].text);
  // The factor is 1/2 at 10 exp(-5)/s and goes on with the same slope.
  const double     change = 10. * std::exp(-5.);
  const FlowStress below  = m.flow_stress(0., change * (1. - 1e-12));
  const FlowStress above  = m.flow_stress(0., change * (1. + 1e-12));
  EXPECT_NEAR(above.value, 60., 1e-8);
  EXPECT_NEAR(below.value, above.value, 1e-8);
  EXPECT_NEAR(below.d_strain_rate, above.d_strain_rate, 1e-8 * above.d_strain_rate);
}

TEST(Material, KnowsWhatItDependsOn)
{
  const std::vector<std::pair<bool, bool>> expected = {
    { false, false }, { false, true }, { false, true }, { false, true },
    { true, false },  { true, false }, { true, false }, { true, false },
    { true, true },   { true, true },  { true, true },  { false, false }
  };
  for (std::size_t i = 0; i < all_models.size(); ++i)
    {
      EXPECT_EQ(material(all_models[i].text).depends_on_strain(), expected[i].first) << i;
      EXPECT_EQ(material(all_models[i].text).depends_on_rate(), expected[i].second) << i;
    }
}

TEST(MaterialErrors, NameTheEntryTheRangeAndTheWayOut)
{
  struct Fault
  {
    std::string text, entry, says;
  };
  const std::string        hollomon = "set Model = hollomon\n set Strength coefficient = 5\n";
  const std::string        swift    = "set Model = swift\n set Strength coefficient = 5\n";
  const std::string        voce     = "set Model = voce\n set Yield stress = 5\n";
  const std::string        product  = "set Model = product\n set Yield stress = 5\n";
  const std::vector<Fault> faults   = {
      { "", "Yield stress\" = \"0\"", "is needed" },
      { "set Yield stress = -3", "Yield stress\" = \"-3\"", "must be positive" },
      { "set Model = power law", "Strength coefficient", "is needed" },
      { "set Model = power law\n set Strength coefficient = 5\n set Rate exponent = 1.5",
        "Rate exponent\" = \"1.5\"", "0 to 1" },
      { "set Model = power law\n set Strength coefficient = 5\n set Rate exponent = 0\n set "
          "Reference "
          "strain rate = 0",
        "Reference strain rate", "> 0" },
      { "set Model = perzyna", "Yield stress", "is needed" },
      { "set Model = perzyna\n set Yield stress = 5\n set Rate exponent = -0.1", "Rate exponent",
        "0 to 1" },
      { "set Model = hollomon", "Strength coefficient", "is needed" },
      { hollomon + "set Hardening exponent = 1", "Hardening exponent", "use ludwik or swift" },
      { hollomon + "set Hardening exponent = 0\n set Smallest strain = 0", "Smallest strain",
        "1e-12 to 0.1" },
      { "set Model = ludwik", "Yield stress", "is needed" },
      { "set Model = ludwik\n set Yield stress = 5\n set Strength coefficient = -1",
        "Strength coefficient", "0 or more" },
      { "set Model = ludwik\n set Yield stress = 5\n set Strength coefficient = 0\n set Hardening "
          "exponent = 2",
        "Hardening exponent", "0 to 1" },
      { swift + "set Hardening exponent = 0", "Prestrain", "use hollomon" },
      // Left out, which is not 0.
      { hollomon, "Hardening exponent\" = \"\"", "needed here and not given" },
      { swift, "Hardening exponent", "needed here and not given" },
      { "set Model = ludwik\n set Yield stress = 5", "Strength coefficient\" = \"\"",
        "needed here and not given" },
      { "set Model = perzyna\n set Yield stress = 5", "Rate exponent\" = \"\"",
        "needed here and not given" },
      { "set Model = power law\n set Strength coefficient = 5", "Rate exponent",
        "needed here and not given" },
      { product + "set Rate sensitivity = power", "Rate exponent", "needed here and not given" },
      { product + "set Rate sensitivity = cowper-symonds", "Rate exponent",
        "needed here and not given" },
      { product + "set Rate sensitivity = johnson-cook", "Rate coefficient",
        "needed here and not given" },
      { swift + "set Hardening exponent = -1", "Hardening exponent", "0 to 1" },
      { voce, "Saturation stress", "the law hardens" },
      { voce + "set Saturation stress = 9", "Characteristic strain", "is needed" },
      { product + "set Rate sensitivity = johnson-cook\n set Rate coefficient = 0.6",
        "Rate coefficient", "0 to 0.5" },
      { product +
            "set Rate sensitivity = power\n set Rate exponent = 0\n set Reference strain rate = "
              "-1",
        "Reference strain rate", "must be positive" },
      // Entries of another model.
      { hollomon + "set Yield stress = 100", "Yield stress\" = \"100\"",
        "Model = hollomon, which has Strength coefficient, Hardening exponent, Smallest strain" },
      { "set Yield stress = 5\n set Rate exponent = 0.2", "Rate exponent", "Remove the entry" },
      { "set Yield stress = 5\n set Hardening = swift", "Hardening", "its default none" },
      { "set Yield stress = 5\n set Table file = a.csv", "Table file", "leaving it empty" },
      { product + "set Prestrain = 1", "Prestrain",
        "Model = product, Hardening = none, Rate sensitivity = none" },
      { "set Model = table\n set Yield stress = 5", "Yield stress", "which has Table file" },
      { "set Model = table", "Table file", "needs a file" },
      { "set Model = table\n set Table file = no_such.csv", "Table file", "no_such.csv" }
  };
  for (const Fault &fault : faults)
    {
      const std::string text = message(fault.text);
      EXPECT_IN("Material/" + fault.entry, text);
      EXPECT_IN(fault.says, text);
    }
}

TEST(MaterialErrors, UnknownNamesAreRefusedWithoutAHandlerToo)
{
  MaterialParameters parameters;
  parameters.model = "holomon";
  try
    {
      Material(parameters, "Material", ".");
      FAIL();
    }
  catch (const InputError &error)
    {
      EXPECT_IN("Material/Model\" = \"holomon\"", std::string(error.what()));
      EXPECT_IN("\"voce\"", std::string(error.what()));
      EXPECT_IN("Did you mean \"hollomon\"?", std::string(error.what()));
    }
}

class TableFile : public ::testing::Test
{
protected:
  std::filesystem::path folder;

  void SetUp() override
  {
    std::string name = (std::filesystem::temp_directory_path() / "axiforge_laws_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder = name;
  }

  void TearDown() override
  {
    std::filesystem::remove_all(folder);
  }

  void write(const std::string &text) const
  {
    std::ofstream(folder / "t.csv") << text;
  }

  Material read(const std::string &text) const
  {
    write(text);
    return material("set Model = table\n set Table file = t.csv", folder.string());
  }

  std::string fault(const std::string &text) const
  {
    write(text);
    return message("set Model = table\n set Table file = t.csv", folder.string());
  }

  const std::string example = "# steel\n"
                              "strain, 0.01, 0.1, 1, 20\n"
                              "0,     50, 60, 80, 95\n"
                              "0.05,  80, 88, 99, 120\n"
                              "\n"
                              "0.2,  100, 115, 118, 150\n"
                              "0.5,  110, 125, 140, 165\n"
                              "1.0,  108, 122, 141, 170\n";
};

TEST_F(TableFile, IsExactAtItsNodes)
{
  const Material m            = read(example);
  const double   strain[]     = { 0., 0.05, 0.2, 0.5, 1. };
  const double   rate[]       = { 0.01, 0.1, 1., 20. };
  const double   stress[5][4] = { { 50, 60, 80, 95 },
                                  { 80, 88, 99, 120 },
                                  { 100, 115, 118, 150 },
                                  { 110, 125, 140, 165 },
                                  { 108, 122, 141, 170 } };
  for (unsigned int i = 0; i < 5; ++i)
    for (unsigned int j = 0; j < 4; ++j)
      EXPECT_NEAR(m.flow_stress(strain[i], rate[j]).value, stress[i][j], 1e-11);
  EXPECT_TRUE(m.depends_on_strain());
  EXPECT_TRUE(m.depends_on_rate());
}

TEST_F(TableFile, DerivativesAgreeWithNumericalOnes)
{
  const Material m = read(example);
  for (const double strain : { 0.003, 0.049, 0.051, 0.12, 0.31, 0.49, 0.8 })
    for (const double rate : { 0.012, 0.05, 0.099, 0.101, 0.5, 3., 19. })
      {
        const FlowStress s = m.flow_stress(strain, rate);
        const double     h = 1e-6;
        EXPECT_NEAR(
            s.d_strain,
            (m.flow_stress(strain + h, rate).value - m.flow_stress(strain - h, rate).value) /
                (2. * h),
            1e-5 * s.value)
            << strain << ' ' << rate;
        EXPECT_NEAR(s.d_strain_rate * rate,
                    (m.flow_stress(strain, rate * (1. + h)).value -
                     m.flow_stress(strain, rate * (1. - h)).value) /
                        (2. * h),
                    1e-6 * s.value)
            << strain << ' ' << rate;
      }
}

TEST_F(TableFile, IsContinuouslyDifferentiableAcrossItsNodes)
{
  const Material m = read(example);
  for (const double strain : { 0.05, 0.2 })
    for (const double rate : { 0.1, 1. })
      {
        const double     h = 1e-9;
        const FlowStress a = m.flow_stress(strain - h, rate * (1. - h));
        const FlowStress b = m.flow_stress(strain + h, rate * (1. + h));
        EXPECT_NEAR(a.d_strain, b.d_strain, 1e-3);
        EXPECT_NEAR(a.d_strain_rate * rate, b.d_strain_rate * rate, 1e-4);
      }
}

TEST_F(TableFile, RisesWithTheRateAndDoesNotOvershoot)
{
  const Material m = read(example);
  for (double strain = 0.; strain <= 1.; strain += 0.01)
    {
      double last = 0.;
      for (double rate = 0.005; rate < 40.; rate *= 1.1)
        {
          const FlowStress s = m.flow_stress(strain, rate);
          EXPECT_GE(s.value, last - 1e-12);
          EXPECT_GE(s.d_strain_rate, -1e-12);
          last = s.value;
        }
      EXPECT_LE(last, m.flow_stress(strain, 20.).value);
    }
  // Monotone along the strain up to the maximum at 0.5, and between the neighbours after it.
  for (double strain = 0.; strain < 0.5; strain += 0.005)
    EXPECT_GE(m.flow_stress(strain, 0.1).d_strain, 0.);
  for (double strain = 0.5; strain < 1.; strain += 0.005)
    EXPECT_LE(m.flow_stress(strain, 0.1).value, 125.);
}

TEST_F(TableFile, ReproducesALogarithmicLaw)
{
  // Linear in the strain and in log(rate): the interpolation has to be exact.
  std::string text = "x,0.1,1,10\n";
  for (const double strain : { 0., 0.5, 1. })
    text += fmt::format("{},{},{},{}\n", strain, 90 + 20 * strain, 100 + 20 * strain,
                        110 + 20 * strain);
  const Material m = read(text);
  for (const double strain : { 0.1, 0.6 })
    for (const double rate : { 0.2, 4. })
      EXPECT_NEAR(m.flow_stress(strain, rate).value, 100. + 20. * strain + 10. * std::log10(rate),
                  1e-11);
}

TEST_F(TableFile, KeepsTheValueOfItsEdgeOutside)
{
  const Material   m    = read(example);
  const FlowStress past = m.flow_stress(3., 500.);
  EXPECT_NEAR(past.value, 170., 1e-12);
  EXPECT_EQ(past.d_strain, 0.);
  EXPECT_EQ(past.d_strain_rate, 0.);
  EXPECT_NEAR(m.flow_stress(0., 1e-7).value, 50., 1e-12);
  // Only the direction that leaves the table is constant.
  EXPECT_GT(m.flow_stress(0.1, 500.).d_strain, 0.);
  EXPECT_GT(m.flow_stress(3., 0.5).d_strain_rate, 0.);
}

TEST_F(TableFile, StrainsThatLookLikePerCentAreNoted)
{
  take_notes();
  read("s,1\n0,100\n3,200\n");
  EXPECT_TRUE(take_notes().empty());
  read("s,1\n0,100\n10,150\n50,200\n");
  const std::vector<std::string> notes = take_notes();
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_IN("ends at a strain of 50", notes[0]);
}

TEST_F(TableFile, TellsItsRanges)
{
  const Material m = read(example);
  ASSERT_NE(m.table(), nullptr);
  EXPECT_EQ(m.table()->last_strain(), 1.);
  EXPECT_NEAR(m.table()->lowest_rate(), 0.01, 1e-15);
  EXPECT_NEAR(m.table()->highest_rate(), 20., 1e-12);
  EXPECT_EQ(material("set Yield stress = 5").table(), nullptr);
}

TEST_F(TableFile, OneRateIsEnough)
{
  const Material m = read("0,1\n0,100\n0.5,200\n");
  EXPECT_NEAR(m.flow_stress(0.25, 77.).value, 150., 1e-12);
  EXPECT_NEAR(m.flow_stress(0.25, 77.).d_strain, 200., 1e-11);
  EXPECT_EQ(m.flow_stress(0.25, 77.).d_strain_rate, 0.);
  EXPECT_FALSE(m.depends_on_rate());
  EXPECT_FALSE(read("s,1\n0,100\n0.5,100\n").depends_on_strain());
}

TEST_F(TableFile, FaultsNameFileAndLine)
{
  struct Fault
  {
    std::string text;
    std::string line;
    std::string says;
  };
  const std::vector<Fault> faults = {
    { "", "t.csv", "at least 1 row" },
    { "# nothing\n\n", "t.csv", "at least 1 row" },
    { "strain\n0\n1\n", "first row", "at least one strain rate" },
    { "s,1,2\n", "t.csv", "at least 1 row" },
    { "s,1,2\n0,5,6\n", "end", "at least 2" },
    { "s,1,fast\n0,5,6\n1,6,7\n", "first row", "\"fast\" is not a strain rate" },
    { "s,0,2\n0,5,6\n1,6,7\n", "first row", "strain rate 0 must be positive" },
    { "s,2,1\n0,5,6\n1,6,7\n", "first row", "strain rate 1 does not exceed" },
    { "0,2,1\n0,5,6\n1,6,7\n", "line 1", "strain rate 1 does not exceed" },
    { "s,1,2\n0,5,6\n1,6\n", "line 3", "entries" },
    { "s,1,2\n0,5,6\n1,6,x\n", "line 3", "\"x\"" },
    { "s,1,2\n0,5,6\n1,6,nan\n", "line 3", "\"nan\"" },
    { "s,1,2\n-0.1,5,6\n1,6,7\n", "line 2", "must not be negative" },
    { "s,1,2\n0,5,6\n\n0,6,7\n", "line 4", "strain 0 does not exceed" },
    { "s,1,2\n0,5,6\n1,6,0\n", "line 3", "stress 0 in column 3 must be positive" },
    // Without a row of rates: the first strain would be taken for the corner.
    { "0,80\n0.1,100\n1,150\n", "line 1", "like a row of stresses" },
    { "0.01,80,85\n0.1,100,110\n1,150,160\n", "line 1", "\"strain, 1\"" },
    { "strain,stress\n0,80\n0.1,100\n", "first row", "\"stress\" is not a strain rate" },
    { "s,1,2\n0,2e8,2.1e8\n1,3e8,3.1e8\n", "stresses", "is 310 MPa then" },
    { "strain [%],1,2\n0,5,6\n10,6,7\n", "first row", "Divide them by 100" },
    { "s;1;2\n0,5;5;6\n1;6;7\n", "line 2", "The decimal sign is a point" }
  };
  for (const Fault &f : faults)
    {
      const std::string text = fault(f.text);
      EXPECT_IN("t.csv", text);
      EXPECT_IN(f.line, text);
      EXPECT_IN(f.says, text);
    }
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
