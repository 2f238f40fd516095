// SPDX-License-Identifier: GPL-2.0-or-later
// Files that appear whole or not at all, and tables that survive a kill at any moment.
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <axiforge/base/atomic_file.h>
#include <axiforge/base/errors.h>

using namespace axiforge;

namespace
{
  class AtomicFileTest : public ::testing::Test
  {
  protected:
    void SetUp() override
    {
      std::string name = ::testing::TempDir() + "axiforge_files_XXXXXX";
      ASSERT_NE(::mkdtemp(name.data()), nullptr);
      folder = name;
      path   = folder + "/table.csv";
    }

    void TearDown() override
    {
      std::filesystem::remove_all(folder);
    }

    std::string content() const
    {
      std::ifstream      in(path, std::ios::binary);
      std::ostringstream text;
      text << in.rdbuf();
      return text.str();
    }

    std::size_t n_files() const
    {
      std::size_t n = 0;
      for ([[maybe_unused]] const auto &file : std::filesystem::directory_iterator(folder))
        ++n;
      return n;
    }

    std::string folder;
    std::string path;
  };

  TEST_F(AtomicFileTest, AppearsOnlyWhenCommitted)
  {
    {
      AtomicFile file(path);
      file.stream() << "new\n" << std::flush;
      EXPECT_FALSE(std::filesystem::exists(path));
      file.commit();
    }
    EXPECT_EQ(content(), "new\n");
    EXPECT_EQ(n_files(), 1u);
  }

  TEST_F(AtomicFileTest, AnAbandonedFileLeavesTheOldOneAndNothingElse)
  {
    write_file_atomically(path, "old\n");
    try
      {
        AtomicFile file(path);
        file.stream() << "half of the n";
        throw std::runtime_error("the writer failed");
      }
    catch (const std::runtime_error &)
      {
      }
    EXPECT_EQ(content(), "old\n");
    EXPECT_EQ(n_files(), 1u);
  }

  TEST_F(AtomicFileTest, AKillWhileWritingLeavesTheOldFile)
  {
    write_file_atomically(path, "old\n");
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0)
      {
        AtomicFile file(path);
        file.stream() << std::string(1 << 20, 'x') << std::flush;
        ::kill(::getpid(), SIGKILL);
      }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(content(), "old\n");
    EXPECT_EQ(n_files(), 1u); // on a file system with O_TMPFILE, as all local ones are
  }

  TEST_F(AtomicFileTest, SaysWhichFileAndWhy)
  {
    try
      {
        write_file_atomically(folder + "/missing/file.txt", "x");
        FAIL() << "no exception";
      }
    catch (const ComputationError &error)
      {
        const std::string text = error.what();
        EXPECT_NE(text.find(folder + "/missing/file.txt"), std::string::npos);
        EXPECT_NE(text.find("No such file or directory"), std::string::npos);
      }
  }

  TEST_F(AtomicFileTest, NumbersReadBackExactly)
  {
    EXPECT_EQ(csv_number(0.1), "0.1");
    EXPECT_EQ(csv_number(5.0), "5");
    EXPECT_EQ(csv_number(-2.5e-7), "-2.5e-07");
    for (const double value : { 1. / 3., 1e300, 4.9e-324, -123456.789012345, 0.1 + 0.2 })
      EXPECT_EQ(std::strtod(csv_number(value).c_str(), nullptr), value);
    EXPECT_EQ(csv_number(std::numeric_limits<double>::quiet_NaN()), "nan");
  }

  TEST_F(AtomicFileTest, TableIsReadableAfterEveryRow)
  {
    CsvFile table = CsvFile::create(path, { "step", "note" });
    EXPECT_EQ(content(), "step,note\n");
    table.write_row(std::vector<double>{ 1, 0.25 });
    EXPECT_EQ(content(), "step,note\n1,0.25\n");
    table.write_row(std::vector<std::string>{ "2", "a \"b\", c" });
    EXPECT_EQ(content(), "step,note\n1,0.25\n2,\"a \"\"b\"\", c\"\n");
    EXPECT_EQ(table.n_rows(), 2u);
    EXPECT_THROW(table.write_row(std::vector<double>{ 1 }), std::exception);
    EXPECT_EQ(table.n_rows(), 2u);
  }

  TEST_F(AtomicFileTest, ANewTableReplacesTheOld)
  {
    CsvFile::create(path, { "a" }).write_row(std::vector<double>{ 1 });
    const CsvFile table = CsvFile::create(path, { "b" });
    EXPECT_EQ(content(), "b\n");
  }

  TEST_F(AtomicFileTest, ResumeCutsAnUnfinishedLineAndRowsBehindTheCheckpoint)
  {
    write_file_atomically(path, "a,b\n1,2\n3,4\n5,");
    {
      CsvFile table = CsvFile::resume(path, { "a", "b" });
      EXPECT_EQ(table.n_rows(), 2u);
      table.write_row(std::vector<double>{ 7, 8 });
      EXPECT_EQ(content(), "a,b\n1,2\n3,4\n7,8\n");
    }
    CsvFile table = CsvFile::resume(path, { "a", "b" }, 1);
    table.write_row(std::vector<double>{ 9, 9 });
    EXPECT_EQ(content(), "a,b\n1,2\n9,9\n");
  }

  TEST_F(AtomicFileTest, ResumeTakesALineBreakInQuotesAsText)
  {
    const std::string text = "a\n\"1\n2\"\n3\n";
    write_file_atomically(path, text);
    EXPECT_EQ(CsvFile::resume(path, { "a" }).n_rows(), 2u);
    EXPECT_EQ(content(), text);
  }

  TEST_F(AtomicFileTest, ResumeRefusesWhatDoesNotFit)
  {
    EXPECT_THROW(CsvFile::resume(path, { "a" }), InputError);
    write_file_atomically(path, "a,b\n1,2\n");
    EXPECT_THROW(CsvFile::resume(path, { "a" }), InputError);
    EXPECT_THROW(CsvFile::resume(path, { "a", "c" }), InputError);
    EXPECT_THROW(CsvFile::resume(path, { "a", "b" }, 2), InputError);
    EXPECT_EQ(content(), "a,b\n1,2\n");
  }

  // A limit on the file's size stands for a full disk: the system takes part of a line, then
  // refuses.
  TEST_F(AtomicFileTest, AFullDiskLeavesWholeRows)
  {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0)
      {
        std::signal(SIGXFSZ, SIG_IGN);
        CsvFile      table = CsvFile::create(path, { "x" });
        const rlimit limit{ 10, 10 }; // bytes: "x\n", "111\n", and 4 of the 6 bytes of the next row
        ::setrlimit(RLIMIT_FSIZE, &limit);
        table.write_row(std::vector<double>{ 111 });
        try
          {
            table.write_row(std::vector<double>{ 22222 });
          }
        catch (const ComputationError &)
          {
            ::_exit(table.n_rows() == 1 ? 0 : 2);
          }
        ::_exit(1);
      }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
    EXPECT_EQ(content(), "x\n111\n");
  }

  TEST_F(AtomicFileTest, AKilledWriterLeavesWholeRows)
  {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0)
      {
        CsvFile table = CsvFile::create(path, { "a", "b" });
        while (true)
          table.write_row(std::vector<double>{ 1.0 / 3.0, 2.0 / 3.0 });
      }
    while (!std::filesystem::exists(path) || std::filesystem::file_size(path) < 20000)
      ::usleep(1000);
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    std::istringstream in(content());
    std::string        line;
    std::getline(in, line);
    EXPECT_EQ(line, "a,b");
    while (std::getline(in, line))
      ASSERT_EQ(line, "0.3333333333333333,0.6666666666666666");
    EXPECT_EQ(content().back(), '\n');
  }
} // namespace

int main(int argc, char **argv)
{
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
