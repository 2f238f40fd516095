// SPDX-License-Identifier: GPL-2.0-or-later
// A whole section, left and right of the axis.
InnerRadius = -25;
Include "rectangle.geo";
Physical Surface("workpiece") = {1};
