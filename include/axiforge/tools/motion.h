// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include <axiforge/base/geometry.h>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge::tools
{
  /// Entries of the subsection Motion of a tool.
  struct MotionParameters
  {
    std::string type = "fixed";
    Vector2     velocity; ///< [mm/s]
    std::string table_file;
    Vector2     direction = Vector2({ 0., -1. });

    /// Declare the entries in the subsection @p prm is in; parsing fills the members.
    void declare(dealii::ParameterHandler &prm);
  };

  /**
   * The translation of a rigid tool as a function of time: none, a constant velocity, or a table of
   * time against velocity or position along a fixed direction. In a table of velocities the
   * velocity is linear between the rows and the displacement is integrated exactly; in a table of
   * positions the position is linear. After the last row the tool rests.
   */
  class Motion
  {
  public:
    /**
     * Check the entries and read the table. @p section is that of the motion in the `.prm`, for
     * messages; @p directory is that of the `.prm`. Throws InputError, with file and line for what
     * is wrong in a table.
     */
    Motion(const MotionParameters &parameters,
           const std::string      &section,
           const std::string      &directory);

    /// Displacement since time 0 [mm].
    Vector2 displacement(double time) const;

    /// Velocity [mm/s], where it jumps the one that comes after.
    Vector2 velocity(double time) const;

    /// Whether the tool ever moves.
    bool moves() const;

    /// Times [s], ascending, at which the velocity jumps: a time step should end there.
    std::vector<double> kinks() const;

    /// End of the table [s], infinity without one.
    double end_time() const;

  private:
    void read_table(const std::string &file, const std::string &section);

    /// Between two rows the velocity is linear.
    struct Row
    {
      double time            = 0; ///< [s]
      double travel          = 0; ///< along the direction since time 0 [mm]
      double velocity_after  = 0; ///< just after this time [mm/s]
      double velocity_before = 0; ///< just before this time [mm/s]
    };

    /// Row that begins the interval of @p time.
    const Row &row_at(double time) const;

    Vector2          direction; ///< unit vector; with a constant velocity that velocity
    std::vector<Row> rows;      ///< empty: constant velocity
  };
} // namespace axiforge::tools
