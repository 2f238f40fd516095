// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include <axiforge/base/geometry_parameters.h>
#include <axiforge/base/gmsh_session.h>
#include <axiforge/tools/profile.h>

namespace axiforge::tools
{
  /**
   * The profile of a tool from a CSV polyline with the columns r_mm, z_mm, a header line being
   * optional. A last point equal to the first closes it. Pieces on the axis r = 0 are left out.
   *
   * Throws InputError with file and line: other than two columns, entries that are not numbers,
   * fewer than two points, a point given twice in a row, r < 0. @p section is that of the tool in
   * the
   * `.prm`, for messages.
   */
  Profile read_profile_csv(const std::string &file, const std::string &section);

  /**
   * The profile of a tool from the curves of a physical group of a `.geo` or `.msh`, or from all
   * curves of a `.step`, `.stp` or `.brep` (which have no groups). An empty group name means all
   * curves, too. Curves on the axis r = 0 are left out: they are the middle of the tool.
   *
   * Straight lines and circular arcs are recognised by their shape, whatever gmsh calls them, and
   * are exact (1e-9 of their size). Ellipses, splines, Bezier curves and NURBS become cubic Hermite
   * pieces through gmsh's own parametrisation, off by at most 1e-6 of the curve's size. A `.msh`
   * has no curves any more: its line elements are taken (a mid node divides a line in two).
   *
   * Throws InputError for a file gmsh can't read, a group that does not exist (with those that do),
   * a point with r < 0, or a curve outside of gmsh's plane z = 0.
   */
  Profile read_profile_gmsh(const std::string    &file,
                            const std::string    &physical_group,
                            const GeometryValues &parameters,
                            const std::string    &section);

  /// The profile the entries of a tool ask for. @p directory is that of the `.prm`.
  Profile read_profile(const GeometryParameters &parameters,
                       const std::string        &section,
                       const std::string        &directory);
} // namespace axiforge::tools
