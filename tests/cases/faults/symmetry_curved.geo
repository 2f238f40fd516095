// SPDX-License-Identifier: GPL-2.0-or-later
// The curve named "symmetry" goes round a corner.
InnerRadius = 5;
Include "rectangle.geo";
Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1, 2};
