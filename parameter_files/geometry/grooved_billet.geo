// SPDX-License-Identifier: GPL-2.0-or-later
// A cylinder with a rectangular groove round its side at mid-height. Lengths in mm. The upper half, or with
// Full = 1 the whole; Height and GrooveHeight are those of the half in both cases.
//
// The cells are those of three blocks: below and above the level of the groove's edge (the core, as wide as the
// groove's bottom), and the flange outside of the core. Whole: the same once more below.
DefineConstant[
  Radius       = {25, Name "Radius"},
  Height       = {25, Name "Height"},       // of the half
  GrooveRadius = {15, Name "GrooveRadius"}, // of its bottom
  GrooveHeight = {2, Name "GrooveHeight"},  // of the half
  CoreCells    = {8, Name "CoreCells"},     // from the axis to the bottom of the groove
  FlangeCells  = {5, Name "FlangeCells"},   // from there to the side
  GrooveCells  = {2, Name "GrooveCells"},   // of the groove's half height
  HeightCells  = {12, Name "HeightCells"},  // from the groove to the end
  Full         = {0, Name "Full"}
];

Macro Half // upwards (sign = 1) or downwards (sign = -1) from the points 1, 2 of the line z = 0
  Point(base + 1) = {0, sign * GrooveHeight, 0};
  Point(base + 2) = {GrooveRadius, sign * GrooveHeight, 0};
  Point(base + 3) = {Radius, sign * GrooveHeight, 0};
  Point(base + 4) = {0, sign * Height, 0};
  Point(base + 5) = {GrooveRadius, sign * Height, 0};
  Point(base + 6) = {Radius, sign * Height, 0};
  Line(base + 1) = {1, base + 1};
  Line(base + 2) = {2, base + 2};
  Line(base + 3) = {base + 1, base + 2};
  Line(base + 4) = {base + 2, base + 3};
  Line(base + 5) = {base + 1, base + 4};
  Line(base + 6) = {base + 2, base + 5};
  Line(base + 7) = {base + 3, base + 6};
  Line(base + 8) = {base + 4, base + 5};
  Line(base + 9) = {base + 5, base + 6};
  Curve Loop(base + 1) = {1, base + 2, -(base + 3), -(base + 1)};
  Curve Loop(base + 2) = {base + 3, base + 6, -(base + 8), -(base + 5)};
  Curve Loop(base + 3) = {base + 4, base + 7, -(base + 9), -(base + 6)};
  Transfinite Curve{base + 1, base + 2} = GrooveCells + 1;
  Transfinite Curve{base + 5, base + 6, base + 7} = HeightCells + 1;
  Transfinite Curve{base + 3, base + 8} = CoreCells + 1;
  Transfinite Curve{base + 4, base + 9} = FlangeCells + 1;
  For k In {1 : 3}
    // The lower half is mirrored: its loops run the other way.
    Plane Surface(base + k) = {sign * (base + k)};
    surfaces[] += {base + k};
  EndFor
  axis[] += {base + 1, base + 5};
Return

Point(1) = {0, 0, 0};
Point(2) = {GrooveRadius, 0, 0};
Line(1) = {1, 2};
Transfinite Curve{1} = CoreCells + 1;
surfaces[] = {};
axis[] = {};
base = 10;
sign = 1;
Call Half;
If (Full)
  base = 30;
  sign = -1;
  Call Half;
EndIf
Transfinite Surface{surfaces[]};
Recombine Surface{surfaces[]};

Physical Surface("workpiece") = surfaces[];
Physical Curve("axis") = axis[];
If (!Full)
  Physical Curve("symmetry") = {1};
EndIf
