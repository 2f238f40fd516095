// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include <axiforge/base/wording.h>
#include <axiforge/process/accuracy.h>
#include <axiforge/process/progress.h>

namespace axiforge::process
{
  namespace
  {
    std::string duration(const double seconds)
    {
      const int whole = static_cast<int>(std::lround(seconds));
      return seconds < 60     ? fmt::format("{:.1f} s", seconds)
             : seconds < 3600 ? fmt::format("{}:{:02} min", whole / 60, whole % 60)
                              : fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
    }
  } // namespace


  Progress::Progress(const scene::Scene &scene, const bool quiet)
      : scene(scene)
      , quiet(quiet)
  {
  }


  void Progress::start(const State &state)
  {
    start_time = state.time;
    start_step = state.step;
    if (quiet)
      return;
    if (state.step > 0)
      std::cout << fmt::format("resumed after step {}, time {:.6g} s\n", state.step, state.time);
    if (!scene.title.empty())
      std::cout << scene.title << '\n';
    std::cout << fmt::format("{} cells, {} unknowns, {}, end at {:.6g} s, stroke {:.6g} mm\n",
                             state.tables.n_global_cells, state.n_unknowns(),
                             counted(scene.tools.size(), "tool"), scene.end_time(),
                             scene.stroke(scene.end_time()))
              << std::flush;
  }


  void Progress::step(const StepRecord &record) const
  {
    if (quiet)
      return;
    std::string forces;
    for (unsigned int i = 0; i < record.tools.size(); ++i)
      forces += fmt::format("  {} {:.6g} N", scene.tools[i].name, record.tools[i].end_force);
    for (unsigned int i = 0; i < record.boundaries.size(); ++i)
      forces +=
          fmt::format("  {} {:.6g} MPa", scene.boundaries[i].name, record.boundaries[i].pressure);
    const double left =
        timer.wall_time() / (record.time - start_time) * (scene.end_time() - record.time);
    std::cout << fmt::format(
                     "step {:4}  t {:.5g} s  stroke {:.5g} mm{}  iterations {}  cells {}{}  left "
                     "{}{}\n",
                     record.step, record.time, record.stroke, forces, record.iterations,
                     record.cells, describe_errors(scene, record), duration(left),
                     record.repeats ? fmt::format("  (repeated {} times)", record.repeats) : "")
              << std::flush;
  }


  void Progress::mesh(const meshing::AdaptReport &report) const
  {
    if (quiet || !report.changed)
      return;
    std::cout << fmt::format(
                     "mesh adapted: {} cells, {}changes of volume {:.1e}, of the strain's "
                     "integral {:.1e}{}{}\n",
                     report.cells,
                     report.estimated_error > 0
                         ? fmt::format("estimated error of the stress {:.2g}, ",
                                       report.estimated_error)
                         : "",
                     report.volume_change, report.strain_change,
                     std::abs(report.missing_volume) > 1e-9
                         ? fmt::format(", {:.1e} of the volume missing", report.missing_volume)
                         : "",
                     report.refused
                         ? fmt::format(", {} families kept for the outline", report.refused)
                         : "")
              << std::flush;
  }


  void Progress::remeshed(const State                 &state,
                          const std::string           &reason,
                          const meshing::RemeshResult &result) const
  {
    if (!quiet)
      std::cout << fmt::format("remeshing after step {} ({}): {}\n", state.step, reason,
                               meshing::describe(result))
                << std::flush;
  }


  void Progress::end(const State       &state,
                     const StepTimes   &sum,
                     const double       analyse,
                     const std::string &folder) const
  {
    if (quiet)
      return;
    const double       total = timer.wall_time();
    const unsigned int steps = state.step - start_step;
    // In whole per cent, so that with the rest (meshes, estimates, files) they make 100.
    long        rest = 100;
    std::string shares;
    for (const auto &[name, seconds] :
         { std::make_pair("cells", sum.assembly + sum.residual),
           std::make_pair("contact and friction", sum.contact),
           std::make_pair("factorisation", sum.factor), std::make_pair("solve", sum.solve) })
      {
        const long share = std::clamp(std::lround(100 * seconds / total), 0l, rest);
        rest -= share;
        shares += fmt::format("{} {} %, ", name, share);
      }
    std::cout << fmt::format(
                     "{} in {} ({:.1f} ms per step): {}all else {} %; analysis of the first "
                     "matrix {:.3f} s\n",
                     counted(steps, "step"), duration(total), 1e3 * total / std::max(1u, steps),
                     shares, rest, analyse)
              << summary_of_errors(scene, state) << "Results: " << folder << '\n'
              << std::flush;
  }


  void Progress::say(const std::string &line) const
  {
    if (!quiet)
      std::cout << line << std::endl;
  }
} // namespace axiforge::process
