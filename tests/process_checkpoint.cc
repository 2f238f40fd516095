// SPDX-License-Identifier: GPL-2.0-or-later
// A state that was written and read continues bit for bit, also on a mesh with hanging nodes whose
// cells came about in another order; damaged and foreign files are told apart.
#include <deal.II/base/mpi.h>

#include "flow_fixture.h"

#include <axiforge/base/binary_archive.h>
#include <axiforge/base/errors.h>
#include <axiforge/process/checkpointing.h>
#include <axiforge/process/step.h>

using namespace axiforge;
using namespace axiforge::testing_support;

namespace
{
  Entries cylinder(const Entries &friction)
  {
    return Entries{ "Tools = upper", "Process/End time = 1e9",
                    "Time stepping/Largest reduction per step = 0.03" } +
           swift_power(100, 0.2, 0.3, 0.1) +
           workpiece(geometry("cylinder.geo"), "RadialCells = 3, AxialCells = 3") +
           platen("upper", 25, -10, friction);
  }


  /// Steps from a state on, each with the length that the step before it suggests.
  StepRecord
  run_steps(const scene::Scene &scene, State &state, StepRecord record, const unsigned int n)
  {
    solvers::FlowSolver solver(scene, state);
    for (unsigned int step = 0; step < n; ++step)
      record = process::advance(scene, state, solver,
                                process::choose_step_size(scene, state, record), record);
    return record;
  }


  template <typename Function> std::string message_of(const Function &function)
  {
    try
      {
        function();
      }
    catch (const InputError &error)
      {
        return error.what();
      }
    return "no InputError";
  }


  std::string read(const std::string &path)
  {
    std::ifstream      in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }


  void expect_equal(const State &a, const State &b)
  {
    ASSERT_EQ(a.tables.n_nodes, b.tables.n_nodes);
    ASSERT_EQ(a.tables.cells, b.tables.cells);
    unsigned int different = 0;
    for (unsigned int i = 0; i < 2 * a.tables.n_nodes; ++i)
      different += a.position.local_element(i) != b.position.local_element(i) ||
                   a.velocity.local_element(i) != b.velocity.local_element(i);
    EXPECT_EQ(different, 0u) << "unknowns";
    for (unsigned int i = 0; i < a.strain.locally_owned_size(); ++i)
      different += a.strain.local_element(i) != b.strain.local_element(i);
    EXPECT_EQ(different, 0u) << "strains";
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.step, b.step);
  }


  /// The order in which deal.II visits the cells.
  std::vector<std::string> order_of_cells(const State &state)
  {
    std::vector<std::string> order;
    for (const auto &cell : state.triangulation.active_cell_iterators())
      order.push_back(cell->id().to_string());
    return order;
  }


  std::string key(const std::vector<std::string> &entries)
  {
    std::string name;
    for (const char c : entries[0] + (entries.size() > 1 ? entries[1] : ""))
      if (std::isalpha(c))
        name += c;
    return name;
  }
} // namespace


class Continued : public ::testing::TestWithParam<Entries>
{
};


TEST_P(Continued, IsTheSameToTheLastBit)
{
  FlowProblem problem(cylinder(GetParam()));
  // Refined here, then there: the loaded mesh is refined level by level, so deal.II numbers its
  // cells in another order.
  problem.refine([](const Point &x) { return x[0] > 16 && x[1] > 16; });
  problem.refine([](const Point &x) { return x[0] > 20 && x[1] > 20; });
  problem.refine([](const Point &x) { return x[0] < 9 && x[1] < 9; });
  ASSERT_GT(problem.state.hanging_nodes.n_constraints(), 0u);

  const StepRecord  third = run_steps(problem.scene, problem.state, StepRecord(), 3);
  CheckpointExtras  extras{ "the parameters", third, {} };
  const std::string path = problem.folder.path + "/checkpoint.axi";
  extras.results.field_files.emplace_back(0.1, "fields/a.vtu");
  save_checkpoint(problem.state, extras, path);

  State                  loaded(MPI_COMM_WORLD);
  const CheckpointExtras read_back = load_checkpoint(loaded, path);
  EXPECT_EQ(read_back.parameters, "the parameters");
  EXPECT_EQ(read_back.results.field_files, extras.results.field_files);
  EXPECT_EQ(read_back.record.tools.size(), 1u);
  EXPECT_EQ(loaded.boundary_ids, problem.state.boundary_ids);
  expect_equal(problem.state, loaded);
  const int reordered = order_of_cells(problem.state) != order_of_cells(loaded);
  EXPECT_EQ(dealii::Utilities::MPI::max(reordered, MPI_COMM_WORLD), 1) << "too easy for this test";

  const StepRecord uninterrupted = run_steps(problem.scene, problem.state, third, 4);
  const StepRecord resumed       = run_steps(problem.scene, loaded, read_back.record, 4);
  expect_equal(problem.state, loaded);
  EXPECT_EQ(uninterrupted.tools[0].force, resumed.tools[0].force);
  EXPECT_EQ(uninterrupted.power_friction, resumed.power_friction);
  EXPECT_EQ(uninterrupted.time_step, resumed.time_step);
  EXPECT_EQ(uninterrupted.iterations, resumed.iterations);
  EXPECT_EQ(loaded.step, 7u);
}


// Layers with stored stresses, and laws that keep the rates of two steps for their lag.
INSTANTIATE_TEST_SUITE_P(Laws,
                         Continued,
                         ::testing::Values(Entries{ "Law = none" },
                                           Entries{ "Law = smm", "Factor = 0.3" },
                                           Entries{ "Law = shear", "Factor = 0.3" },
                                           Entries{ "Law = coulomb", "Coefficient = 0.1" }),
                         [](const auto &info) { return key(info.param); });


TEST(Checkpoint, WrittenAgainIsTheSameFile)
{
  FlowProblem problem(cylinder({ "Law = smm", "Factor = 0.3" }));
  problem.refine([](const Point &x) { return x[0] > 16; });
  const StepRecord  record = run_steps(problem.scene, problem.state, StepRecord(), 2);
  const std::string first = problem.folder.path + "/a.axi", second = problem.folder.path + "/b.axi";
  save_checkpoint(problem.state, { "", record, {} }, first);
  State loaded(MPI_COMM_WORLD);
  save_checkpoint(loaded, load_checkpoint(loaded, first), second);
  EXPECT_EQ(read(first), read(second));
}


TEST(Checkpoint, FaultyFilesAreToldApart)
{
  FlowProblem       problem(cylinder({}));
  const std::string path = problem.folder.path + "/checkpoint.axi";
  save_checkpoint(problem.state, {}, path);
  const std::string whole = read(path);
  const auto        fault = [&](const std::string &text) {
    problem.folder.file("faulty.axi", text);
    State loaded(MPI_COMM_WORLD);
    return message_of([&] { load_checkpoint(loaded, problem.folder.path + "/faulty.axi"); });
  };
  const auto has = [](const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(fault(whole), "no InputError");

  // Any byte behind the head that is different is noticed.
  for (const double share : { 0.01, 0.3, 0.7, 0.999 })
    {
      std::string text = whole;
      text[static_cast<std::size_t>(share * text.size())] ^= 1;
      EXPECT_PRED2(has, fault(text), share < 0.02 ? "faulty.axi" : "checksum") << share;
    }
  EXPECT_PRED2(has, fault(whole.substr(0, whole.size() / 2)), "bytes of content");
  EXPECT_PRED2(has, fault(whole + "x"), "bytes of content");
  EXPECT_PRED2(has, fault(whole.substr(0, 25)), "damaged");
  EXPECT_PRED2(has, fault(""), "no checkpoint of axiforge");
  EXPECT_PRED2(has, fault("<VTKFile>"), "no checkpoint of axiforge");
  std::string version = whole;
  version[24] ^= 2; // behind the magic text of 20 bytes and the mark of the byte order
  EXPECT_PRED2(has, fault(version), "another version of the program");
  State loaded(MPI_COMM_WORLD);
  EXPECT_PRED2(has, message_of([&] { load_checkpoint(loaded, problem.folder.path + "/none.axi"); }),
               "There is no checkpoint");
}


TEST(Checkpoint, PhysicsMustBeTheSameAndTheEndNeedNot)
{
  const auto print = [](const Entries &more) {
    TemporaryFolder folder;
    return scene::SceneParameters(ParameterFile(folder.file("a.prm", ""),
                                                cylinder({ "Law = smm", "Factor = 0.3" }) + more))
        .print();
  };
  const std::string before = print({});
  for (const char *entry : { "Process/End stroke = 12", "Output/Fields = none", "Title = other",
                             "Checkpoint/Every steps = 3", "Flow solver/Most iterations = 99" })
    EXPECT_NO_THROW(process::check_same_scene(before, print({ entry }), {}, "c.axi")) << entry;
  for (const char *entry :
       { "Material/Strength coefficient = 101", "Tool upper/Friction/Factor = 0.7",
         "Tool upper/Motion/Velocity = 0, -11", "Workpiece/Refinement levels = 1" })
    {
      const std::string message =
          message_of([&] { process::check_same_scene(before, print({ entry }), {}, "c.axi"); });
      const std::string name = std::string(entry).substr(0, std::string(entry).find(" ="));
      EXPECT_NE(message.find("\"" + name + "\""), std::string::npos) << message;
    }
}


TEST(BinaryArchive, GivesEveryNumberBack)
{
  std::map<std::string, std::vector<double>> values{
    { "a", { 0.1, -0.0, 1e-310, std::numeric_limits<double>::infinity() } }, { "", {} }
  };
  BinaryWriter writer;
  writer(values);
  std::map<std::string, std::vector<double>> again;
  BinaryReader                               reader(writer.text, "x");
  reader(again);
  EXPECT_EQ(values, again);
  EXPECT_TRUE(std::signbit(again.at("a")[1]));
  EXPECT_TRUE(reader.at_end());
  double more = 0;
  EXPECT_THROW(reader(more), InputError);
}


int main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  ::testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
