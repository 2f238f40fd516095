// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace dealii
{
  class ParameterHandler;
}

namespace axiforge
{
  /// Entries that say where the geometry of the workpiece or of a tool comes from.
  struct GeometryParameters
  {
    std::string  file;
    std::string  parameters; ///< "Radius = 25, Height = 12.5"
    std::string  physical_group;
    std::string  face;                  ///< of a CAD file: "", its number or "largest". Workpiece
    double       element_size      = 0; ///< [mm], 0: as the file says. Workpiece only
    unsigned int refinement_levels = 0; ///< workpiece only

    /// Declare the entries of the workpiece in the subsection @p prm is in; parsing fills the
    /// members.
    void declare_workpiece(dealii::ParameterHandler &prm);

    /// Declare the entries of a tool's profile in the subsection @p prm is in.
    void declare_profile(dealii::ParameterHandler &prm);
  };

  /**
   * A list of geometry parameters, "Radius = 25, RadialCells = 4", with one of them changed, or
   * added if it isn't there.
   */
  std::string with_geometry_parameter(const std::string &list,
                                      const std::string &name,
                                      const std::string &value);
} // namespace axiforge
