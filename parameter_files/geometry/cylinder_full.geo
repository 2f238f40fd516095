// SPDX-License-Identifier: GPL-2.0-or-later
// A whole cylinder from z = 0 to z = Height, without a symmetry plane: for two unequal tools. Lengths
// in mm.
//
// Grading > 1 makes the elements finer towards the side and both ends: the longest element is Grading
// times as long as the shortest. 1: all equal.
DefineConstant[
  Radius      = {25, Name "Radius"},
  Height      = {50, Name "Height"},
  RadialCells = {18, Name "RadialCells"},
  AxialCells  = {36, Name "AxialCells"},
  Grading     = {1, Name "Grading"}
];

If (RadialCells < 1 || AxialCells < 1)
  Error("cylinder_full.geo: RadialCells = %g, AxialCells = %g have to be 1 or more", RadialCells, AxialCells);
EndIf

radial_ratio = (RadialCells > 1) ? Grading ^ (1 / (RadialCells - 1)) : 1;

Point(1) = {0, 0, 0};
Point(2) = {Radius, 0, 0};
Point(3) = {Radius, Height, 0};
Point(4) = {0, Height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};

Transfinite Curve{1, 3} = RadialCells + 1 Using Progression 1 / radial_ratio;
If (Grading == 1)
  Transfinite Curve{2, 4} = AxialCells + 1;
Else
  Transfinite Curve{2, 4} = AxialCells + 1 Using Bump 1 / Grading;
EndIf
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};

Physical Surface("workpiece") = {1};
Physical Curve("axis") = {4};
