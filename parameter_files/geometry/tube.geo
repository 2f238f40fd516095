// SPDX-License-Identifier: GPL-2.0-or-later
// A piece of a long tube in plane strain: both end planes are symmetry planes. Lengths in mm. For the
// exact solution of the expanding thick cylinder, with conditions on "inner" and "outer".
DefineConstant[
  InnerRadius = {10, Name "InnerRadius"},
  OuterRadius = {20, Name "OuterRadius"},
  Height      = {5, Name "Height"},
  RadialCells = {8, Name "RadialCells"},
  AxialCells  = {4, Name "AxialCells"}
];

If (RadialCells < 1 || AxialCells < 1)
  Error("tube.geo: RadialCells = %g, AxialCells = %g have to be 1 or more", RadialCells, AxialCells);
EndIf

Point(1) = {InnerRadius, 0, 0};
Point(2) = {OuterRadius, 0, 0};
Point(3) = {OuterRadius, Height, 0};
Point(4) = {InnerRadius, Height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};

Transfinite Curve{1, 3} = RadialCells + 1;
Transfinite Curve{2, 4} = AxialCells + 1;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};

Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1, 3};
Physical Curve("inner") = {4};
Physical Curve("outer") = {2};
