// SPDX-License-Identifier: GPL-2.0-or-later
InnerRadius = 1e-3;
Include "rectangle.geo";
Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
