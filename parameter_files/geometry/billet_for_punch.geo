// SPDX-License-Identifier: GPL-2.0-or-later
// A whole cylinder (no symmetry plane) with finer cells at the top around PunchRadius. Lengths in mm.
DefineConstant[
  Radius      = {30, Name "Radius"},
  Height      = {40, Name "Height"},
  PunchRadius = {10, Name "PunchRadius"},
  InnerCells  = {14, Name "InnerCells"}, // under the punch
  OuterCells  = {14, Name "OuterCells"},
  AxialCells  = {20, Name "AxialCells"},
  Grading     = {4, Name "Grading"} // longest over shortest cell
];

If (InnerCells < 1 || OuterCells < 1 || AxialCells < 1)
  Error("billet_for_punch.geo: InnerCells = %g, OuterCells = %g, AxialCells = %g have to be 1 or more", InnerCells, OuterCells, AxialCells);
EndIf

If (PunchRadius <= 0 || PunchRadius >= Radius)
  Error("billet_for_punch.geo: PunchRadius = %g has to lie between 0 and Radius = %g", PunchRadius, Radius);
EndIf

inner_ratio = Grading ^ (-0.5 / (InnerCells - 1));
outer_ratio = Grading ^ (1 / (OuterCells - 1));
axial_ratio = Grading ^ (-1 / (AxialCells - 1));

Point(1) = {0, 0, 0};
Point(2) = {PunchRadius, 0, 0};
Point(3) = {Radius, 0, 0};
Point(4) = {Radius, Height, 0};
Point(5) = {PunchRadius, Height, 0};
Point(6) = {0, Height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {5, 4};
Line(5) = {6, 5};
Line(6) = {1, 6};
Line(7) = {2, 5};
Curve Loop(1) = {1, 7, -5, -6};
Plane Surface(1) = {1};
Curve Loop(2) = {2, 3, -4, -7};
Plane Surface(2) = {2};

Transfinite Curve{1, 5} = InnerCells + 1 Using Progression inner_ratio;
Transfinite Curve{2, 4} = OuterCells + 1 Using Progression outer_ratio;
Transfinite Curve{3, 6, 7} = AxialCells + 1 Using Progression axial_ratio;
Transfinite Surface{1, 2};
Recombine Surface{1, 2};

Physical Surface("workpiece") = {1, 2};
Physical Curve("axis") = {6};
