// SPDX-License-Identifier: GPL-2.0-or-later
// The section stands in gmsh's plane y = 0 instead of z = 0.
Point(1) = {0, 0, 0};
Point(2) = {25, 0, 0};
Point(3) = {25, 0, 25};
Point(4) = {0, 0, 25};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = 4;
Transfinite Surface{1};
Physical Surface("workpiece") = {1};
