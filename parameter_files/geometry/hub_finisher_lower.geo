// SPDX-License-Identifier: GPL-2.0-or-later
// Lower die of the hub's third operation: the cavity of the lower boss with its bottom at z = 0, the lower half of
// the flange, half of the flash land and its gutter. Lengths in mm, Draft in degrees.
DefineConstant[
  BossRadius    = {40, Name "BossRadius"},    // of the bottom
  BossDepth     = {40, Name "BossDepth"},     // from the flange's underside
  FlangeRadius  = {75, Name "FlangeRadius"},  // at the flange's underside
  FlashHeight   = {48.5, Name "FlashHeight"}, // z of the land
  LandWidth     = {9, Name "LandWidth"},
  Draft         = {3, Name "Draft"},
  BossFillet    = {5, Name "BossFillet"},     // at the bottom of the boss
  MouthRadius   = {8, Name "MouthRadius"},    // where the boss meets the flange
  FlangeFillet  = {5, Name "FlangeFillet"},   // at the rim of the flange
  LandRadius    = {3, Name "LandRadius"},     // at the entrance of the land
  GutterDepth   = {4, Name "GutterDepth"},
  FaceRadius    = {130, Name "FaceRadius"}
];

If (FlashHeight <= BossDepth)
  Error("hub_finisher_lower.geo: FlashHeight = %g has to be above the flange's underside, BossDepth = %g", FlashHeight, BossDepth);
EndIf

Include "rounded_chain.geo";
slope = Tan(Draft * Pi / 180);
rim   = FlangeRadius + (FlashHeight - BossDepth) * slope;
chain_r[] = {0, BossRadius, BossRadius + BossDepth * slope, FlangeRadius, rim, rim + LandWidth,
             rim + LandWidth + GutterDepth, FaceRadius};
chain_z[] = {0, 0, BossDepth, BossDepth, FlashHeight, FlashHeight, FlashHeight - GutterDepth, FlashHeight - GutterDepth};
chain_f[] = {0, BossFillet, MouthRadius, FlangeFillet, LandRadius, LandRadius, LandRadius, 0};
Call RoundedChain;
Physical Curve("tool") = chain_curves[];
