// SPDX-License-Identifier: GPL-2.0-or-later
// The upper half of a ring with a rectangular section. Lengths in mm. The defaults are the 6:3:2 ring
// of the friction test, outer diameter : inner diameter : whole height = 36 : 18 : 12 mm.
//
// Grading > 1 makes the elements finer towards the platen and both edges on it. 1: all equal.
DefineConstant[
  InnerRadius = {9, Name "InnerRadius"},
  OuterRadius = {18, Name "OuterRadius"},
  Height      = {6, Name "Height"}, // of the half
  RadialCells = {24, Name "RadialCells"},
  AxialCells  = {16, Name "AxialCells"},
  Grading     = {1, Name "Grading"}
];

If (RadialCells < 1 || AxialCells < 1)
  Error("ring.geo: RadialCells = %g, AxialCells = %g have to be 1 or more", RadialCells, AxialCells);
EndIf

axial_ratio = Grading ^ (1 / Max(AxialCells - 1, 1));

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

If (Grading == 1)
  Transfinite Curve{1, 3} = RadialCells + 1;
Else
  Transfinite Curve{1, 3} = RadialCells + 1 Using Bump 1 / Grading;
EndIf
Transfinite Curve{2, 4} = AxialCells + 1 Using Progression 1 / axial_ratio;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};

Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
