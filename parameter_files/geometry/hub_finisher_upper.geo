// SPDX-License-Identifier: GPL-2.0-or-later
// Upper die of the hub's third operation, drawn Lift above where it ends: a pin for the central hole, the annular cavity of the
// upper boss, the upper half of the flange, half of the flash land and its gutter. Lengths in mm, Draft in
// degrees; the pin becomes thinner downwards, the boss upwards.
DefineConstant[
  Lift          = {65.5, Name "Lift"},
  TipHeight     = {35, Name "TipHeight"},        // z of the end of the pin
  PinRadius     = {21, Name "PinRadius"},        // at its end
  PinCorner     = {7, Name "PinCorner"},
  BossTop       = {95, Name "BossTop"},          // z of the end of the upper boss
  BossRadius    = {45, Name "BossRadius"},       // at the flange
  FlangeTop     = {60, Name "FlangeTop"},        // z of the flange's upper side
  FlangeRadius  = {75, Name "FlangeRadius"},     // at the flange's upper side
  FlashHeight   = {51.5, Name "FlashHeight"},    // z of the land
  LandWidth     = {9, Name "LandWidth"},
  Draft         = {3, Name "Draft"},
  BossFillet    = {4, Name "BossFillet"},        // at the end of the upper boss
  MouthRadius   = {8, Name "MouthRadius"},       // where the boss meets the flange
  FlangeFillet  = {5, Name "FlangeFillet"},      // at the rim of the flange
  LandRadius    = {3, Name "LandRadius"},        // at the entrance of the land
  GutterDepth   = {4, Name "GutterDepth"},
  FaceRadius    = {130, Name "FaceRadius"}
];

If (!(TipHeight < FlangeTop && FlashHeight < FlangeTop && FlangeTop < BossTop))
  Error("hub_finisher_upper.geo: TipHeight = %g and FlashHeight = %g have to be below FlangeTop = %g, and that below BossTop = %g",
        TipHeight, FlashHeight, FlangeTop, BossTop);
EndIf

Include "rounded_chain.geo";
slope = Tan(Draft * Pi / 180);
rim   = FlangeRadius + (FlangeTop - FlashHeight) * slope;
chain_r[] = {0, PinRadius, PinRadius + (BossTop - TipHeight) * slope, BossRadius - (BossTop - FlangeTop) * slope, BossRadius,
             FlangeRadius, rim, rim + LandWidth, rim + LandWidth + GutterDepth, FaceRadius};
chain_z[] = {TipHeight, TipHeight, BossTop, BossTop, FlangeTop, FlangeTop, FlashHeight, FlashHeight,
             FlashHeight + GutterDepth, FlashHeight + GutterDepth};
chain_f[] = {0, PinCorner, BossFillet, BossFillet, MouthRadius, FlangeFillet, LandRadius, LandRadius, LandRadius, 0};
For chain_i In {0 : #chain_z[] - 1}
  chain_z[chain_i] += Lift;
EndFor
Call RoundedChain;
Physical Curve("tool") = chain_curves[];
