// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <deal.II/base/parameter_handler.h>

#include <fmt/format.h>

#include <axiforge/base/csv.h>
#include <axiforge/base/errors.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/tools/motion.h>

namespace axiforge::tools
{
  void MotionParameters::declare(dealii::ParameterHandler &prm)
  {
    prm.add_parameter(
        "Type", type,
        "How the tool moves: \"fixed\", \"constant velocity\" (entry Velocity) or "
        "\"table\" (entries Table file and Direction). Default fixed: the usual scene "
        "has one tool that moves, and says so.",
        dealii::Patterns::Selection("fixed|constant velocity|table"));
    prm.add_parameter(
        "Velocity", velocity,
        "For constant velocity: the components \"r, z\" [mm/s], symbol V. A press that "
        "comes down has \"0, -0.5\". A radial component is for tools away from the "
        "axis, which then widen or narrow like a ring of segments.");
    prm.add_parameter(
        "Table file", table_file,
        "For table: a CSV file with a header line and the columns time_s and "
        "velocity_mm_per_s or position_mm, measured along Direction. Times ascend from "
        "0. Between the rows the velocity, or the position, is linear; after the last "
        "row the tool rests. Relative to the folder of this parameter file.");
    prm.add_parameter(
        "Direction", direction,
        "For table: the direction \"r, z\" of positive velocities and positions, of any "
        "length but 0. Default \"0, -1\", downwards.");
  }

  Motion::Motion(const MotionParameters &parameters,
                 const std::string      &section,
                 const std::string      &directory)
  {
    const bool has_velocity = parameters.velocity.norm() > 0;
    if (parameters.type == "fixed")
      {
        if (has_velocity || !parameters.table_file.empty())
          throw InputError::entry(
              section + "/Type", parameters.type,
              fmt::format("a fixed tool has no {}", has_velocity ? "velocity" : "table"),
              "fixed, constant velocity, table",
              has_velocity ? "Set Type = constant velocity, or leave out Velocity"
                           : "Set Type = table, or leave out Table file");
      }
    else if (parameters.type == "constant velocity")
      {
        if (!parameters.table_file.empty())
          throw InputError::entry(section + "/Type", parameters.type, "a table is given as well",
                                  "fixed, constant velocity, table",
                                  "Set Type = table, or leave out Table file");
        direction = parameters.velocity;
      }
    else if (parameters.type == "table")
      {
        if (has_velocity)
          throw InputError::entry(section + "/Type", parameters.type, "a velocity is given as well",
                                  "fixed, constant velocity, table",
                                  "Set Type = constant velocity, or leave out Velocity");
        if (parameters.table_file.empty())
          throw InputError::entry(section + "/Table file", "",
                                  "a motion of type table needs a file",
                                  "a CSV file with the columns time_s and velocity_mm_per_s or "
                                  "position_mm");
        if (!(parameters.direction.norm() > 0))
          throw InputError::entry(
              section + "/Direction",
              fmt::format("{}, {}", parameters.direction[0], parameters.direction[1]),
              "it has no length", "any other vector \"r, z\", as \"0, -1\"");
        direction = parameters.direction / parameters.direction.norm();
        read_table(resolve_path(directory, parameters.table_file), section);
      }
    else
      throw InputError::entry(section + "/Type", parameters.type, "there is no such motion",
                              "fixed, constant velocity, table");
  }

  void Motion::read_table(const std::string &file, const std::string &section)
  {
    const std::string entry = section + "/Table file";
    const CsvTable    table = read_csv(file, entry, 2);

    const int time     = table.find_column("time_s");
    const int velocity = table.find_column("velocity_mm_per_s");
    const int position = table.find_column("position_mm");
    if (table.columns() != 2 || time < 0 || (velocity < 0) == (position < 0))
      throw InputError::entry(
          entry, file,
          fmt::format("the header line names the columns {}", fmt::join(table.header, ", ")),
          "time_s, velocity_mm_per_s or time_s, position_mm");

    const unsigned int n = table.rows.size();
    rows.resize(n);
    for (unsigned int i = 0; i < n; ++i)
      {
        rows[i].time = table.rows[i][time];
        if (i == 0 ? rows[i].time != 0 : rows[i].time <= rows[i - 1].time)
          throw InputError::entry(entry, file,
                                  fmt::format("line {}: time_s = {} does not {}", table.lines[i],
                                              rows[i].time,
                                              i == 0 ? "start at 0" : "come after the time before"),
                                  "times that ascend from 0");
      }

    for (unsigned int i = 0; i < n; ++i)
      if (velocity >= 0)
        {
          const double v          = table.rows[i][velocity];
          rows[i].velocity_before = v;
          rows[i].velocity_after  = i + 1 < n ? v : 0;
          if (i > 0)
            rows[i].travel = rows[i - 1].travel + (rows[i].time - rows[i - 1].time) *
                                                      (rows[i - 1].velocity_after + v) / 2;
        }
      else
        {
          const auto &values = table.rows;
          rows[i].travel     = values[i][position] - values[0][position];
          if (i > 0)
            {
              rows[i].velocity_before =
                  (rows[i].travel - rows[i - 1].travel) / (rows[i].time - rows[i - 1].time);
              rows[i - 1].velocity_after = rows[i].velocity_before;
            }
        }
    if (position >= 0)
      rows[0].velocity_before = rows[0].velocity_after;
  }

  const Motion::Row &Motion::row_at(const double time) const
  {
    const auto after =
        std::upper_bound(rows.begin(), rows.end(), time,
                         [](const double t, const Row &row) { return t < row.time; });
    return after == rows.begin() ? rows.front() : *(after - 1);
  }

  Vector2 Motion::displacement(const double time) const
  {
    if (rows.empty())
      return time * direction;
    const Row   &row = row_at(time);
    const double dt  = std::max(0., time - row.time);
    if (&row == &rows.back())
      return row.travel * direction;
    const Row   &next = *(&row + 1);
    const double acceleration =
        (next.velocity_before - row.velocity_after) / (next.time - row.time);
    return (row.travel + dt * (row.velocity_after + dt * acceleration / 2)) * direction;
  }

  Vector2 Motion::velocity(const double time) const
  {
    if (rows.empty())
      return direction;
    const Row &row = row_at(time);
    if (&row == &rows.back())
      return Vector2();
    const Row   &next = *(&row + 1);
    const double acceleration =
        (next.velocity_before - row.velocity_after) / (next.time - row.time);
    return (row.velocity_after + std::max(0., time - row.time) * acceleration) * direction;
  }

  bool Motion::moves() const
  {
    if (rows.empty())
      return direction.norm() > 0;
    return std::any_of(rows.begin(), rows.end(), [](const Row &row) {
      return row.velocity_before != 0 || row.velocity_after != 0;
    });
  }

  std::vector<double> Motion::kinks() const
  {
    double fastest = 0;
    for (const Row &row : rows)
      fastest = std::max({ fastest, std::abs(row.velocity_before), std::abs(row.velocity_after) });
    std::vector<double> times;
    for (const Row &row : rows)
      if (row.time > 0 && std::abs(row.velocity_after - row.velocity_before) > 1e-9 * fastest)
        times.push_back(row.time);
    return times;
  }

  double Motion::end_time() const
  {
    return rows.empty() ? std::numeric_limits<double>::infinity() : rows.back().time;
  }
} // namespace axiforge::tools
