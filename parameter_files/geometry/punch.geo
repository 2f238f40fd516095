// SPDX-License-Identifier: GPL-2.0-or-later
// A flat punch that comes from above: its end face z = Z from the axis to Radius, an edge rounded with
// EdgeRadius (0: sharp), and its side up to Z + Shank. Lengths in mm.
DefineConstant[
  Radius     = {10, Name "Radius"},
  EdgeRadius = {1, Name "EdgeRadius"},
  Z          = {25, Name "Z"},
  Shank     = {50, Name "Shank"}
];

If (EdgeRadius < 0 || EdgeRadius > Radius || EdgeRadius >= Shank)
  Error("punch.geo: EdgeRadius = %g has to lie between 0 and Radius = %g and below Shank = %g",
        EdgeRadius, Radius, Shank);
EndIf

Point(1) = {0, Z, 0};
Point(4) = {Radius, Z + Shank, 0};
If (EdgeRadius > 0)
  Point(2) = {Radius - EdgeRadius, Z, 0};
  Point(3) = {Radius, Z + EdgeRadius, 0};
  Point(5) = {Radius - EdgeRadius, Z + EdgeRadius, 0};
  Circle(2) = {2, 5, 3};
  Line(3) = {3, 4};
  If (EdgeRadius < Radius)
    Line(1) = {1, 2};
    Physical Curve("tool") = {1, 2, 3};
  Else // a hemisphere
    Physical Curve("tool") = {2, 3};
  EndIf
Else
  Point(2) = {Radius, Z, 0};
  Line(1) = {1, 2};
  Line(3) = {2, 4};
  Physical Curve("tool") = {1, 3};
EndIf
