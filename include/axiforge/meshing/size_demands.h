// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/meshing/outline.h>
#include <axiforge/meshing/size_field.h>

namespace axiforge::meshing
{
  /**
   * The wanted length of edges for a workpiece as it stands, by the entries of the section
   * Remeshing: @p size [mm] at most, less at ends of contact, where tools near the surface are
   * curved, where the workpiece is thin, and where the error indicators of the old mesh are
   * large; doc/theory.md, section 14.
   */
  SizeField make_size_field(const Outline      &outline,
                            const Snapshot     &old,
                            const scene::Scene &scene,
                            double              time,
                            double              size);
} // namespace axiforge::meshing
