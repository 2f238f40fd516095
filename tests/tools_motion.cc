// SPDX-License-Identifier: GPL-2.0-or-later
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <deal.II/base/parameter_handler.h>

#include <gtest/gtest.h>
#include <unistd.h>

#include <axiforge/base/errors.h>
#include <axiforge/tools/motion.h>

using namespace axiforge;
using axiforge::tools::Motion;
using axiforge::tools::MotionParameters;

namespace
{
  class MotionTest : public ::testing::Test
  {
  protected:
    void SetUp() override
    {
      folder = (std::filesystem::temp_directory_path() /
                ("axiforge_motion_" + std::to_string(::getpid())))
                   .string();
      std::filesystem::create_directories(folder);
    }

    void TearDown() override
    {
      std::filesystem::remove_all(folder);
    }

    Motion table(const std::string &text) const
    {
      std::ofstream(folder + "/table.csv") << text;
      MotionParameters parameters;
      parameters.type       = "table";
      parameters.table_file = "table.csv";
      return Motion(parameters, "Tool upper/Motion", folder);
    }

    void expect_fault(const std::string &text, const std::string &part) const
    {
      try
        {
          table(text);
          ADD_FAILURE() << "no InputError for " << text;
        }
      catch (const InputError &error)
        {
          EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
          EXPECT_NE(std::string(error.what()).find("Tool upper/Motion"), std::string::npos);
        }
    }

    std::string folder;
  };
} // namespace

TEST_F(MotionTest, EntriesAreParsed)
{
  MotionParameters         parameters;
  dealii::ParameterHandler prm;
  parameters.declare(prm);
  prm.parse_input_from_string("set Type = constant velocity\nset Velocity = 0.25, -0.5\n");
  const Motion motion(parameters, "Tool upper/Motion", folder);
  EXPECT_DOUBLE_EQ(motion.displacement(4)[0], 1);
  EXPECT_DOUBLE_EQ(motion.displacement(4)[1], -2);
  EXPECT_DOUBLE_EQ(motion.velocity(7)[1], -0.5);
  EXPECT_TRUE(motion.moves());
  EXPECT_TRUE(motion.kinks().empty());
  EXPECT_EQ(motion.end_time(), std::numeric_limits<double>::infinity());
}

TEST_F(MotionTest, FixedToolRests)
{
  const Motion motion(MotionParameters(), "Tool lower/Motion", folder);
  EXPECT_FALSE(motion.moves());
  EXPECT_EQ(motion.displacement(3).norm(), 0);
  EXPECT_EQ(motion.velocity(3).norm(), 0);
}

TEST_F(MotionTest, TableOfVelocities)
{
  // up to 4 mm/s within 2 s (4 mm), down to 2 mm/s within 1 s (3 mm), then a stop
  const Motion motion = table("time_s, velocity_mm_per_s\n0, 0\n2, 4\n3, 2\n");
  EXPECT_DOUBLE_EQ(motion.displacement(1)[1], -1); // t^2
  EXPECT_DOUBLE_EQ(motion.displacement(2)[1], -4);
  EXPECT_DOUBLE_EQ(motion.displacement(2.5)[1], -4 - 1.75);
  EXPECT_DOUBLE_EQ(motion.displacement(3)[1], -7);
  EXPECT_DOUBLE_EQ(motion.displacement(9)[1], -7);
  EXPECT_DOUBLE_EQ(motion.velocity(1)[1], -2);
  EXPECT_DOUBLE_EQ(motion.velocity(2.5)[1], -3);
  EXPECT_EQ(motion.velocity(3)[1], 0);
  EXPECT_EQ(motion.kinks(), std::vector<double>({ 3 }));
  EXPECT_DOUBLE_EQ(motion.end_time(), 3);
  for (double t = 0.05; t < 2.95; t += 0.1) // the velocity is the derivative
    EXPECT_NEAR((motion.displacement(t + 1e-5)[1] - motion.displacement(t - 1e-5)[1]) / 2e-5,
                motion.velocity(t)[1], 1e-4);
}

TEST_F(MotionTest, TableOfPositions)
{
  // columns in the other order, an offset at the start, a rest, and on at the same speed twice
  const Motion motion = table("position_mm, time_s\n10, 0\n12, 1\n12, 3\n15, 4\n18, 5\n");
  EXPECT_DOUBLE_EQ(motion.displacement(0.5)[1], -1);
  EXPECT_DOUBLE_EQ(motion.displacement(2)[1], -2);
  EXPECT_DOUBLE_EQ(motion.displacement(4.5)[1], -6.5);
  EXPECT_DOUBLE_EQ(motion.displacement(8)[1], -8);
  EXPECT_DOUBLE_EQ(motion.velocity(0)[1], -2);
  EXPECT_EQ(motion.velocity(1)[1], 0); // after the jump
  EXPECT_DOUBLE_EQ(motion.velocity(3.5)[1], -3);
  EXPECT_EQ(motion.kinks(), std::vector<double>({ 1, 3, 5 }));
}

TEST_F(MotionTest, DirectionIsNormalised)
{
  std::ofstream(folder + "/table.csv") << "time_s,position_mm\n0,0\n1,10\n";
  MotionParameters parameters;
  parameters.type       = "table";
  parameters.table_file = folder + "/table.csv";
  parameters.direction  = Vector2({ 3, 4 });
  const Motion motion(parameters, "Tool upper/Motion", "");
  EXPECT_DOUBLE_EQ(motion.displacement(1)[0], 6);
  EXPECT_DOUBLE_EQ(motion.displacement(1)[1], 8);

  parameters.direction = Vector2();
  EXPECT_THROW(Motion(parameters, "Tool upper/Motion", ""), InputError);
}

TEST_F(MotionTest, FaultyTables)
{
  expect_fault("time_s,velocity_mm_per_s\n1,0\n2,4\n", "line 2");
  expect_fault("time_s,velocity_mm_per_s\n0,0\n2,4\n2,5\n", "line 4");
  expect_fault("time_s,velocity\n0,0\n2,4\n", "velocity_mm_per_s");
  expect_fault("0,0\n2,4\n", "time_s");
  expect_fault("time_s,velocity_mm_per_s\n0,0\n", "1 row");
  expect_fault("time_s,velocity_mm_per_s\n0,fast\n2,4\n", "fast");
}

TEST_F(MotionTest, ContradictingEntries)
{
  MotionParameters parameters;
  parameters.velocity = Vector2({ 0, -1 });
  EXPECT_THROW(Motion(parameters, "Tool upper/Motion", ""), InputError); // fixed, with a velocity
  parameters.type = "table";
  EXPECT_THROW(Motion(parameters, "Tool upper/Motion", ""), InputError);
  parameters.velocity = Vector2();
  EXPECT_THROW(Motion(parameters, "Tool upper/Motion", ""), InputError); // no file
  parameters.table_file = "none.csv";
  EXPECT_THROW(Motion(parameters, "Tool upper/Motion", folder), InputError);
  parameters.type = "constant velocity";
  EXPECT_THROW(Motion(parameters, "Tool upper/Motion", folder), InputError); // with a table
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
