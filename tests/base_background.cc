// SPDX-License-Identifier: GPL-2.0-or-later
// Jobs beside the program: in order, one at a time, their errors and their time.
#include <atomic>
#include <chrono>
#include <ctime>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <axiforge/base/background.h>
#include <axiforge/base/phases.h>

using namespace axiforge;

namespace
{
  void burn(const double seconds)
  {
    const std::clock_t begin = std::clock();
    while (static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC < seconds)
      ;
  }

  /// A column (3: wall, 4: CPU) of the row that begins with a name; -1 if there is none.
  double column(const std::string &table, const std::string &name, const unsigned int n)
  {
    std::size_t at = table.find("| " + name);
    if (at == std::string::npos)
      return -1;
    for (unsigned int i = 0; i < n; ++i)
      at = table.find('|', at + 1);
    return std::stod(table.substr(at - 10, 9));
  }
} // namespace


TEST(Background, JobsComeOneAfterAnotherAndAreDoneAtTheEnd)
{
  std::vector<int> order;
  std::atomic<int> at_work(0), most(0);
  {
    Background background;
    for (int i = 0; i < 5; ++i)
      background.start("job", [&, i] {
        most = std::max<int>(most, ++at_work);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        order.push_back(i);
        --at_work;
      });
    // The destructor waits for the last one.
  }
  EXPECT_EQ(order, (std::vector<int>{ 0, 1, 2, 3, 4 }));
  EXPECT_EQ(most, 1);
}


TEST(Background, AnErrorIsThrownOnceAndTheNextJobRuns)
{
  const auto fail = [] { throw std::runtime_error("disk full"); };
  Background background;
  try
    {
      background.start("job", fail); // in place, on a machine with one core
      background.wait();
      FAIL() << "nothing was thrown";
    }
  catch (const std::runtime_error &error)
    {
      EXPECT_STREQ(error.what(), "disk full");
    }
  EXPECT_NO_THROW(background.wait());
  bool done = false;
  background.start("job", [&] { done = true; });
  background.wait();
  EXPECT_TRUE(done);

  if (Background::has_core())
    {
      background.start("job", fail);
      EXPECT_THROW(background.start("job", [] {}), std::runtime_error);
    }
}


TEST(Background, ItsTimeIsInNoPhaseButInTheWhole)
{
  if (!Background::has_core())
    GTEST_SKIP() << "one core: jobs are done in place";
  constexpr double work = 0.2; // s of CPU
  Phase::measure_phases();
  {
    Background background;
    background.start("files", [] { burn(work); });
    {
      const Phase phase("sleep");
      std::this_thread::sleep_for(std::chrono::milliseconds(50)); // while the job runs
    }
    background.wait();
  }
  const std::string table = Phase::table();
  EXPECT_LT(column(table, "  sleep", 4), 0.02) << table;
  EXPECT_NEAR(column(table, "beside: files", 4), work, 0.05) << table;
  EXPECT_GT(column(table, "whole run", 4), 0.9 * work) << table;
}

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
