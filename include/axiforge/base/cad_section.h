// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <axiforge/base/errors.h>

namespace axiforge
{
  /// Makes the message about what is wrong with a file, from what it is and the way out.
  using FaultOfFile = std::function<InputError(const std::string &, const std::string &)>;

  /**
   * The face of gmsh's present model, read from a CAD file, that is the meridian section, brought
   * into the plane x = r, y = z of gmsh. To be called within GmshSession::run().
   *
   * - @p face "largest" or the number (tag) of a face: that one. Empty: the only face.
   * - Empty and there are solids: they are cut along their meridian. The axis of revolution is the
   *   y, z or x axis of the file, whichever the section's volume of revolution agrees with.
   * - A face in the planes x, z or y, z (r = y) of the file is turned, one beside the plane moved.
   */
  int section_of_cad(const std::string &face, const FaultOfFile &wrong);

  /**
   * The curves of gmsh's present model, read from a CAD file, in the plane x = r, y = z: of solids
   * those of their section, else all. To be called within GmshSession::run().
   */
  std::vector<int> curves_of_cad(const FaultOfFile &wrong);
} // namespace axiforge
