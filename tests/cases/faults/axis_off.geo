// SPDX-License-Identifier: GPL-2.0-or-later
InnerRadius = 5;
Include "rectangle.geo";
Physical Surface("workpiece") = {1};
Physical Curve("axis") = {4};
