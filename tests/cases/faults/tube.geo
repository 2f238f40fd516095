// SPDX-License-Identifier: GPL-2.0-or-later
// A short tube, the curve at the inner radius is "inside".
InnerRadius = 5;
Radius      = 10;
Height      = 5;
Include "rectangle.geo";
Physical Surface("workpiece") = {1};
Physical Curve("inside") = {4};
