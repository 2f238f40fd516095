// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <stdlib.h>

#include <axiforge/base/parameter_file.h>
#include <axiforge/meshing/initial_state.h>
#include <axiforge/meshing/workpiece_mesh.h>
#include <axiforge/scene/scene.h>
#include <axiforge/solvers/flow_solver.h>
#include <axiforge/state/measures.h>
#include <axiforge/state/state.h>

/**
 * What the verification tests of the flow solver share: a scene from entries, as `--set` gives
 * them, its state at the start, changes of the mesh, and error norms against exact solutions.
 */
namespace axiforge::testing_support
{
  /// Entries "Section/Entry = value".
  using Entries = std::vector<std::string>;

  inline Entries operator+(Entries a, const Entries &b)
  {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  }

  inline std::string number(const double x)
  {
    return fmt::format("{:.17g}", x);
  }

  /// A folder that is there as long as the object is.
  class TemporaryFolder
  {
  public:
    TemporaryFolder()
    {
      std::string name = (std::filesystem::temp_directory_path() / "axiforge_test_XXXXXX").string();
      if (!::mkdtemp(name.data()))
        throw std::runtime_error("no temporary folder");
      path = name;
    }
    TemporaryFolder(const TemporaryFolder &) = delete;
    ~TemporaryFolder()
    {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }

    std::string file(const std::string &name, const std::string &text) const
    {
      std::ofstream(path + "/" + name) << text;
      return path + "/" + name;
    }

    std::string path;
  };

  /// A geometry file of parameter_files/geometry.
  inline std::string geometry(const std::string &name)
  {
    return AXIFORGE_PARAMETER_FILES "/geometry/" + name;
  }

  inline Entries workpiece(const std::string &file, const std::string &parameters = "")
  {
    return { "Workpiece/Geometry file = " + file, "Workpiece/Geometry parameters = " + parameters };
  }

  /// A flat platen at height z with velocity v in z; the entries of its friction have no section.
  inline Entries platen(const std::string &name,
                        const double       z,
                        const double       v,
                        const Entries     &friction = {},
                        const double       radius   = 200)
  {
    const std::string section = "Tool " + name;
    Entries           entries = { section + "/Geometry file = " + geometry("platen.geo"),
                                  section + "/Geometry parameters = Z = " + number(z) +
                                      ", Radius = " + number(radius) };
    if (v != 0)
      entries = entries + Entries{ section + "/Motion/Type = constant velocity",
                                   section + "/Motion/Velocity = 0, " + number(v) };
    for (const std::string &entry : friction)
      entries.push_back(section + "/Friction/" + entry);
    return entries;
  }

  inline Entries perfectly_plastic(const double yield_stress)
  {
    return { "Material/Model = perfectly plastic",
             "Material/Yield stress = " + number(yield_stress) };
  }

  /// sigma = C epsdot^n
  inline Entries power_law(const double strength, const double exponent)
  {
    return { "Material/Model = power law", "Material/Strength coefficient = " + number(strength),
             "Material/Rate exponent = " + number(exponent) };
  }

  /// sigma = K (prestrain + strain)^n epsdot^m
  inline Entries
  swift_power(const double strength, const double prestrain, const double n, const double m)
  {
    Entries entries = { "Material/Model = product", "Material/Hardening = swift",
                        "Material/Strength coefficient = " + number(strength),
                        "Material/Prestrain = " + number(prestrain),
                        "Material/Hardening exponent = " + number(n) };
    if (m > 0)
      entries = entries + Entries{ "Material/Rate sensitivity = power",
                                   "Material/Rate exponent = " + number(m) };
    return entries;
  }

  /// A scene and its state at the start, made as the program makes them.
  class FlowProblem
  {
  public:
    using MeshChange = std::function<void(meshing::WorkpieceMesh &)>;

    explicit FlowProblem(const Entries &entries, const MeshChange &change = {})
        : parameters(ParameterFile(folder.file("scene.prm", ""), entries))
        , mesh(read_mesh(parameters, change))
        , scene(parameters, meshing::outline_of(mesh))
        , state(MPI_COMM_WORLD)
    {
      meshing::make_initial_state(mesh, parameters.workpiece.refinement_levels, state);
    }

    /// Divides the cells whose centre is chosen into four; hanging nodes come about.
    void refine(const std::function<bool(const Point &)> &choose)
    {
      meshing::refine_at_start(state, choose);
      solver_.reset();
    }

    /// Moves all nodes: a smooth map gives smoothly curved cells.
    void map_nodes(const std::function<Point(const Point &)> &map)
    {
      for (unsigned int node = 0; node < state.tables.n_nodes; ++node)
        set_node(node, map(state.node_position(node)));
      geometry_changed();
    }

    /// Moves the vertices and puts the other nodes of the cells in the middle of theirs: straight
    /// edges.
    void map_vertices(const std::function<Point(const Point &)> &map)
    {
      std::vector<Point> x(state.tables.n_nodes);
      for (const auto &nodes : state.tables.cells)
        {
          std::array<Point, 4> v;
          for (unsigned int a = 0; a < 4; ++a)
            v[a] = map(state.node_position(nodes[a]));
          constexpr unsigned int sides[4][2] = { { 0, 2 }, { 1, 3 }, { 0, 1 }, { 2, 3 } };
          for (unsigned int a = 0; a < 4; ++a)
            {
              x[nodes[a]]     = v[a];
              x[nodes[4 + a]] = v[sides[a][0]] + 0.5 * (v[sides[a][1]] - v[sides[a][0]]);
            }
          x[nodes[8]] = Point(0.25 * (v[0] + v[1] + v[2] + v[3]));
        }
      for (unsigned int node = 0; node < x.size(); ++node)
        set_node(node, x[node]);
      geometry_changed();
    }

    solvers::FlowSolver &solver()
    {
      if (!solver_)
        solver_ = std::make_unique<solvers::FlowSolver>(scene, state);
      return *solver_;
    }

    /// After the state got another mesh.
    void forget_solver()
    {
      solver_.reset();
    }

    /**
     * The flow in the geometry of the start: for this the scene has the explicit scheme, which
     * writes the equations there. The step is so short that velocities prescribed as functions of
     * the position are those of the start.
     */
    solvers::FlowResult solve_at_start(const double time_step = 1e-9)
    {
      solvers::FlowResult result = solver().solve(time_step);
      EXPECT_TRUE(result.converged) << result.failure;
      return result;
    }

    TemporaryFolder        folder;
    scene::SceneParameters parameters;
    meshing::WorkpieceMesh mesh;
    scene::Scene           scene;
    State                  state;

  private:
    static meshing::WorkpieceMesh read_mesh(const scene::SceneParameters &parameters,
                                            const MeshChange             &change)
    {
      meshing::WorkpieceMesh mesh =
          meshing::read_workpiece(parameters.workpiece, "Workpiece", parameters.directory);
      if (change)
        change(mesh);
      return mesh;
    }

    void set_node(const unsigned int node, const Point &x)
    {
      for (unsigned int c = 0; c < 2; ++c)
        state.position.local_element(2 * node + c) = x[c];
    }

    void geometry_changed()
    {
      state.hanging_nodes.distribute(state.position);
      state.position.update_ghost_values();
      state.setup_tables();
      state.initial_volume = axiforge::measure(state).volume;
      solver_.reset();
    }

    std::unique_ptr<solvers::FlowSolver> solver_;
  };

  /// Value and gradient (by the last index) of a velocity field, and the mean stress.
  struct ExactFlow
  {
    Vector2               velocity;
    std::array<double, 4> gradient; ///< v_r,r v_r,z v_z,r v_z,z
    double                mean_stress = 0;
  };

  /// Norms over the body of revolution, and those of the exact solution.
  struct FlowErrors
  {
    double velocity = 0, gradient = 0, mean_stress = 0;
    double velocity_norm = 0, gradient_norm = 0, mean_stress_norm = 0;

    std::array<double, 3> relative() const
    {
      return { { velocity / velocity_norm, gradient / gradient_norm,
                 mean_stress_norm > 0 ? mean_stress / mean_stress_norm : 0 } };
    }
  };

  /**
   * Errors in L2 of the velocity, its gradient and (@p with_stress) the mean stress, in the
   * configuration of state.position. The velocity is integrated with 5 x 5 Gauss points, so that
   * no superconvergence at the solver's own points flatters it; the mean stress is there only.
   */
  inline FlowErrors flow_errors(const State                                   &state,
                                const solvers::FlowResult                     &result,
                                const std::function<ExactFlow(const Point &)> &exact,
                                const bool                                     with_stress = true)
  {
    static const double gauss[5]   = { -0.906179845938664, -0.538469310105683, 0, 0.538469310105683,
                                       0.906179845938664 };
    static const double weights[5] = { 0.236926885056189, 0.478628670499366, 0.568888888888889,
                                       0.478628670499366, 0.236926885056189 };
    FlowErrors          sum;
    for (unsigned int cell = 0; cell < state.tables.cells.size(); ++cell)
      {
        const auto &nodes = state.tables.cells[cell];
        const auto  at = [&](const double xi, const double eta, const double weight, auto &&visit) {
          double N[9], Nx[9], Ne[9];
          solvers::shape_functions(xi, eta, N, Nx, Ne);
          Point                 x;
          std::array<double, 4> J{}, slope{};
          Vector2               v;
          for (unsigned int a = 0; a < 9; ++a)
            for (unsigned int c = 0; c < 2; ++c)
              {
                const double X = state.position.local_element(2 * nodes[a] + c);
                const double V = result.velocity.local_element(2 * nodes[a] + c);
                x[c] += N[a] * X;
                v[c] += N[a] * V;
                J[2 * c] += Nx[a] * X;
                J[2 * c + 1] += Ne[a] * X;
                slope[2 * c] += Nx[a] * V;
                slope[2 * c + 1] += Ne[a] * V;
              }
          const double          det = J[0] * J[3] - J[1] * J[2];
          std::array<double, 4> gradient;
          for (unsigned int c = 0; c < 2; ++c)
            {
              gradient[2 * c]     = (slope[2 * c] * J[3] - slope[2 * c + 1] * J[2]) / det;
              gradient[2 * c + 1] = (slope[2 * c + 1] * J[0] - slope[2 * c] * J[1]) / det;
            }
          visit(x, v, gradient, 2 * M_PI * x[0] * det * weight);
        };
        for (unsigned int i = 0; i < 5; ++i)
          for (unsigned int j = 0; j < 5; ++j)
            at(0.5 + 0.5 * gauss[i], 0.5 + 0.5 * gauss[j], 0.25 * weights[i] * weights[j],
               [&](const Point &x, const Vector2 &v, const auto &gradient, const double w) {
                 const ExactFlow flow = exact(x);
                 sum.velocity += w * (v - flow.velocity).norm_square();
                 sum.velocity_norm += w * flow.velocity.norm_square();
                 for (unsigned int k = 0; k < 4; ++k)
                   {
                     sum.gradient += w * std::pow(gradient[k] - flow.gradient[k], 2);
                     sum.gradient_norm += w * std::pow(flow.gradient[k], 2);
                   }
               });
        if (!with_stress)
          continue;
        const solvers::ReferenceCell &reference = solvers::ReferenceCell::get();
        for (unsigned int q = 0; q < 9; ++q)
          at(reference.point[q][0], reference.point[q][1], reference.weight[q],
             [&](const Point &x, const Vector2 &, const auto &, const double w) {
               const double p = exact(x).mean_stress;
               sum.mean_stress += w * std::pow(result.cell_history[cell].mean_stress[q] - p, 2);
               sum.mean_stress_norm += w * p * p;
             });
      }
    for (double *norm : { &sum.velocity, &sum.gradient, &sum.mean_stress, &sum.velocity_norm,
                          &sum.gradient_norm, &sum.mean_stress_norm })
      *norm = std::sqrt(*norm);
    return sum;
  }

  /// Orders from errors of meshes whose size halves from one to the next.
  inline std::vector<double> orders(const std::vector<double> &errors)
  {
    std::vector<double> result;
    for (unsigned int i = 1; i < errors.size(); ++i)
      result.push_back(std::log2(errors[i - 1] / errors[i]));
    return result;
  }

  inline std::string table(const std::vector<double> &values)
  {
    return fmt::format("{:.4g}", fmt::join(values, "  "));
  }
} // namespace axiforge::testing_support
