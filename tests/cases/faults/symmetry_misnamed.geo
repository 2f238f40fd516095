// SPDX-License-Identifier: GPL-2.0-or-later
Include "rectangle.geo";
Physical Surface("workpiece") = {1};
Physical Curve("Symmetry") = {1};
