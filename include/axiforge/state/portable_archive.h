// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <axiforge/base/binary_archive.h>
#include <axiforge/state/portable_state.h>

/// How the parts of a state are written and read, see binary_archive.h.
namespace axiforge
{
  // Every member stands in its function: one that is added and not named does not compile.
  template <typename Archive> void visit(Archive &archive, CellHistory &object)
  {
    auto &[pressure, stress, mean_stress, strain_rate, flow_stress] = object;
    archive(pressure, stress, mean_stress, strain_rate, flow_stress);
  }

  template <typename Archive> void visit(Archive &archive, NodeContact &object)
  {
    auto &[tool, face, normal, gap, reaction, slip, pressure, traction, share] = object;
    archive(tool, face, normal, gap, reaction, slip, pressure, traction, share);
  }

  template <typename Archive> void visit(Archive &archive, EdgeFriction &object)
  {
    auto &[traction, strain_rate, earlier_rate, previous_slip, has_previous, layer] = object;
    archive(traction, strain_rate, earlier_rate, previous_slip, has_previous, layer);
  }

  namespace portable
  {
    template <typename Archive> void visit(Archive &archive, CoarseMesh &object)
    {
      auto &[vertices, cells, lines] = object;
      archive(vertices, cells, lines);
    }

    template <typename Archive> void visit(Archive &archive, Edge &object)
    {
      auto &[side, friction] = object;
      archive(side, friction);
    }

    template <typename Archive> void visit(Archive &archive, Cell &object)
    {
      auto &[id, nodes, strain, history, edges] = object;
      archive(id, nodes, strain, history, edges);
    }

    template <typename Archive> void visit(Archive &archive, BoundaryPart &object)
    {
      auto &[contact, symmetry_normal] = object;
      archive(contact, symmetry_normal);
    }

    template <typename Archive> void visit(Archive &archive, Node &object)
    {
      auto &[position, velocity, boundary] = object;
      archive(position, velocity, boundary);
    }

    template <typename Archive> void visit(Archive &archive, Part &object)
    {
      auto &[nodes, cells] = object;
      archive(nodes, cells);
    }
  } // namespace portable
} // namespace axiforge
