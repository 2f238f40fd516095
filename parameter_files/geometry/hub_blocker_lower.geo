// SPDX-License-Identifier: GPL-2.0-or-later
// Lower die of the hub's second operation: a round cavity for the lower boss with its bottom at z = 0, a draft and
// rounded corners, in a flat face. Lengths in mm, Draft in degrees.
DefineConstant[
  BossRadius   = {39, Name "BossRadius"},   // of the bottom
  BossDepth    = {38, Name "BossDepth"},
  Draft        = {3, Name "Draft"},
  BottomFillet = {6, Name "BottomFillet"},
  MouthRadius  = {12, Name "MouthRadius"},
  FaceRadius   = {120, Name "FaceRadius"}
];

If (Draft < 0 || Draft > 45)
  Error("hub_blocker_lower.geo: Draft = %g has to lie between 0 and 45 degrees", Draft);
EndIf

Include "rounded_chain.geo";
slope = Tan(Draft * Pi / 180);
chain_r[] = {0, BossRadius, BossRadius + BossDepth * slope, FaceRadius};
chain_z[] = {0, 0, BossDepth, BossDepth};
chain_f[] = {0, BottomFillet, MouthRadius, 0};
Call RoundedChain;
Physical Curve("tool") = chain_curves[];
