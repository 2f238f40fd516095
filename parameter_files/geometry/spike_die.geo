// SPDX-License-Identifier: GPL-2.0-or-later
// An upper die with a central hole for a spike: flat at z = Z from the fillet of the hole to Radius. The hole
// is HoleRadius wide where its wall, drawn on without the fillet, meets the flat face; it narrows
// upwards by Draft [degrees] and is Depth deep, with a flat roof. Lengths in mm.
DefineConstant[
  HoleRadius   = {10, Name "HoleRadius"},
  Draft        = {5, Name "Draft"},
  FilletRadius = {3, Name "FilletRadius"}, // at the entrance of the hole
  Depth        = {45, Name "Depth"},
  RoofRadius   = {2, Name "RoofRadius"}, // between wall and roof
  Radius       = {60, Name "Radius"},
  Z            = {40, Name "Z"}
];

If (Draft < 0 || Draft >= 45)
  Error("spike_die.geo: Draft = %g has to lie between 0 and 45 degrees", Draft);
EndIf
If (FilletRadius <= 0 || RoofRadius <= 0)
  Error("spike_die.geo: FilletRadius = %g and RoofRadius = %g have to be positive", FilletRadius, RoofRadius);
EndIf
draft = Draft * Pi / 180;

// The fillet turns from the face to the wall by 90 degrees less the draft; its centre is above the face.
half = Tan((Pi / 2 - draft) / 2);
face_end  = HoleRadius + FilletRadius * half;
wall_r    = HoleRadius - FilletRadius * half * Sin(draft);
wall_z    = Z + FilletRadius * half * Cos(draft);
// The roof's fillet turns by as much from the wall to the roof.
roof_z    = Z + Depth;
corner_r  = HoleRadius - Depth * Tan(draft);
upper_r   = corner_r + RoofRadius * half * Sin(draft);
upper_z   = roof_z - RoofRadius * half * Cos(draft);
roof_r    = corner_r - RoofRadius * half;
If (face_end >= Radius)
  Error("spike_die.geo: Radius = %g has to be larger than the fillet's end at %g", Radius, face_end);
EndIf
If (upper_z <= wall_z)
  Error("spike_die.geo: Depth = %g leaves no wall between FilletRadius = %g and RoofRadius = %g", Depth, FilletRadius, RoofRadius);
EndIf
If (roof_r <= 0)
  Error("spike_die.geo: HoleRadius = %g closes before Depth = %g with Draft = %g", HoleRadius, Depth, Draft);
EndIf

Point(1) = {Radius, Z, 0};
Point(2) = {face_end, Z, 0};
Point(3) = {face_end, Z + FilletRadius, 0};
Point(4) = {wall_r, wall_z, 0};
Point(5) = {upper_r, upper_z, 0};
Point(6) = {roof_r, roof_z - RoofRadius, 0};
Point(7) = {roof_r, roof_z, 0};
Point(8) = {0, roof_z, 0};
Line(1) = {1, 2};
Circle(2) = {2, 3, 4};
Line(3) = {4, 5};
Circle(4) = {5, 6, 7};
Line(5) = {7, 8};
Physical Curve("tool") = {1, 2, 3, 4, 5};
