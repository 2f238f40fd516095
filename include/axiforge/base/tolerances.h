// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

/**
 * What geometric decisions take for round-off, all in one place and all relative to the size of the
 * workpiece (its largest extent at the start): nothing is decided by a comparison with exact zero
 * or by a last digit, which differs from processor to processor. Positions are exact to about 1e-15
 * of the size and are moved by velocities that are solved to "Flow solver/Tolerance".
 */
namespace axiforge::tolerance
{
  /// Places, also of files and of new meshes, that are closer than this are one place; surface that
  /// close to the axis or to a line lies on it.
  constexpr double same_place = 1e-9;

  /// A node that is deeper in a tool than this is caught by it.
  constexpr double caught = 1e-10;

  /// A tool that is brought to the workpiece, or the other way round, stops so far short of it.
  constexpr double touching = 1e-9;

  /// Velocity conditions are met to this over the time step: positions are not exact to more.
  constexpr double round_off = 1e-13;
} // namespace axiforge::tolerance
