// SPDX-License-Identifier: GPL-2.0-or-later
// The upper half of a cylinder, meshed with RadialCells x AxialCells elements. Lengths in mm.
//
// The rest of the boundary, the end z = Height and the side r = Radius, is plain "surface".
// Grading > 1 makes the elements finer towards the edge of the platen (r = Radius, z = Height): the
// first element of each direction is Grading times as long as the last. 1: all equal.
DefineConstant[
  Radius      = {25, Name "Radius"},
  Height      = {25, Name "Height"},
  RadialCells = {18, Name "RadialCells"},
  AxialCells  = {18, Name "AxialCells"},
  Grading     = {1, Name "Grading"}
];

If (RadialCells < 1 || AxialCells < 1)
  Error("cylinder.geo: RadialCells = %g, AxialCells = %g have to be 1 or more", RadialCells, AxialCells);
EndIf

// ratio of neighbouring elements that gives this ratio of the first to the last
radial_ratio = (RadialCells > 1) ? Grading ^ (1 / (RadialCells - 1)) : 1;
axial_ratio  = (AxialCells > 1) ? Grading ^ (1 / (AxialCells - 1)) : 1;

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
Transfinite Curve{2, 4} = AxialCells + 1 Using Progression 1 / axial_ratio;
Transfinite Surface{1} = {1, 2, 3, 4};
Recombine Surface{1};

Physical Surface("workpiece") = {1};
Physical Curve("symmetry") = {1};
Physical Curve("axis") = {4};
