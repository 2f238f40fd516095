// SPDX-License-Identifier: GPL-2.0-or-later
// A punch for the extrusion of cups that comes from above: a nose that rises outwards by NoseAngle [degrees]
// from z = Z on the axis, a corner of CornerRadius, a land of length Land at r = Radius, then a relief: a
// cone of 30 degrees in to Radius - Relief, and the shank up to Z + Shank. Lengths in mm.
DefineConstant[
  Radius       = {16, Name "Radius"},
  NoseAngle    = {3, Name "NoseAngle"},
  CornerRadius = {1.5, Name "CornerRadius"},
  Land         = {2, Name "Land"},
  Relief       = {0.2, Name "Relief"},
  Shank        = {80, Name "Shank"},
  Z            = {30, Name "Z"}
];

If (NoseAngle < 0 || NoseAngle > 45)
  Error("cup_punch.geo: NoseAngle = %g has to lie between 0 and 45 degrees", NoseAngle);
EndIf
If (CornerRadius <= 0 || CornerRadius >= Radius)
  Error("cup_punch.geo: CornerRadius = %g has to lie between 0 and Radius = %g", CornerRadius, Radius);
EndIf
If (Land <= 0 || Relief <= 0 || Relief >= Radius)
  Error("cup_punch.geo: Land = %g and Relief = %g have to be positive, Relief less than the radius", Land, Relief);
EndIf
nose = NoseAngle * Pi / 180;

// The corner turns from the nose's direction to that of the land.
centre_r = Radius - CornerRadius;
begin_r  = centre_r + CornerRadius * Sin(nose);
begin_z  = Z + begin_r * Tan(nose);
centre_z = begin_z + CornerRadius * Cos(nose);
relief_z = centre_z + Land + Relief / Tan(Pi / 6);
If (relief_z >= Z + Shank)
  Error("cup_punch.geo: Shank = %g is too short for the land", Shank);
EndIf

Point(1) = {0, Z, 0};
Point(2) = {begin_r, begin_z, 0};
Point(3) = {centre_r, centre_z, 0};
Point(4) = {Radius, centre_z, 0};
Point(5) = {Radius, centre_z + Land, 0};
Point(6) = {Radius - Relief, relief_z, 0};
Point(7) = {Radius - Relief, Z + Shank, 0};
Line(1) = {1, 2};
Circle(2) = {2, 3, 4};
Line(3) = {4, 5};
Line(4) = {5, 6};
Line(5) = {6, 7};
Physical Curve("tool") = {1, 2, 3, 4, 5};
