// SPDX-License-Identifier: GPL-2.0-or-later
// A conical punch that comes from above: a flat tip z = Z of TipRadius on the axis, a corner rounded with
// CornerRadius, and a cone up to Radius. HalfAngle [degrees] is the angle between the axis and the cone.
// Lengths in mm. With TipRadius = 0 the tip is a ball of CornerRadius.
DefineConstant[
  HalfAngle    = {60, Name "HalfAngle"},
  TipRadius    = {5, Name "TipRadius"},
  CornerRadius = {3, Name "CornerRadius"},
  Radius       = {100, Name "Radius"},
  Z            = {25, Name "Z"}
];

If (HalfAngle <= 0 || HalfAngle >= 90)
  Error("cone_tool.geo: HalfAngle = %g has to lie between 0 and 90 degrees", HalfAngle);
EndIf
If (CornerRadius <= 0 || TipRadius < 0)
  Error("cone_tool.geo: CornerRadius = %g has to be positive, TipRadius = %g not negative",
        CornerRadius, TipRadius);
EndIf

// The arc turns from the tip's direction (1, 0) to that of the cone.
slope = (90 - HalfAngle) * Pi / 180;
arc_end_r = TipRadius + CornerRadius * Sin(slope);
arc_end_z = Z + CornerRadius * (1 - Cos(slope));
If (arc_end_r >= Radius)
  Error("cone_tool.geo: Radius = %g has to be larger than the rounded tip's %g", Radius, arc_end_r);
EndIf

Point(2) = {TipRadius, Z, 0};
Point(3) = {TipRadius, Z + CornerRadius, 0};
Point(4) = {arc_end_r, arc_end_z, 0};
Point(5) = {Radius, arc_end_z + (Radius - arc_end_r) * Tan(slope), 0};
Circle(2) = {2, 3, 4};
Line(3) = {4, 5};
If (TipRadius > 0)
  Point(1) = {0, Z, 0};
  Line(1) = {1, 2};
  Physical Curve("tool") = {1, 2, 3};
Else
  Physical Curve("tool") = {2, 3};
EndIf
