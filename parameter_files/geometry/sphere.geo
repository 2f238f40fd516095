// SPDX-License-Identifier: GPL-2.0-or-later
// The upper half of a spherical shell: a quarter of an annulus in the meridian plane. Lengths in mm.
// For the exact solution of the expanding shell, with conditions on "inner" and "outer".
DefineConstant[
  InnerRadius     = {10, Name "InnerRadius"},
  OuterRadius     = {20, Name "OuterRadius"},
  RadialCells     = {8, Name "RadialCells"},
  MeridionalCells = {12, Name "MeridionalCells"}
];

If (RadialCells < 1 || MeridionalCells < 1)
  Error("sphere.geo: RadialCells = %g, MeridionalCells = %g have to be 1 or more", RadialCells, MeridionalCells);
EndIf

Point(1) = {0, 0, 0};
Point(2) = {InnerRadius, 0, 0};
Point(3) = {OuterRadius, 0, 0};
Point(4) = {0, OuterRadius, 0};
Point(5) = {0, InnerRadius, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {5, 4};
Circle(4) = {2, 1, 5};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};

Transfinite Curve{1, 3} = RadialCells + 1;
Transfinite Curve{2, 4} = MeridionalCells + 1;
Transfinite Surface{1} = {2, 3, 4, 5};
Recombine Surface{1};

Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
Physical Curve("axis") = {3};
Physical Curve("inner") = {4};
Physical Curve("outer") = {2};
