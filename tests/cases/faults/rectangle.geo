// SPDX-License-Identifier: GPL-2.0-or-later
// A rectangle from InnerRadius to Radius and from 0 to Height, without physical groups, for the others.
DefineConstant[
  InnerRadius = {0, Name "InnerRadius"},
  Radius      = {25, Name "Radius"},
  Height      = {25, Name "Height"}
];
Point(1) = {InnerRadius, 0, 0};
Point(2) = {Radius, 0, 0};
Point(3) = {Radius, Height, 0};
Point(4) = {InnerRadius, Height, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = 4;
Transfinite Surface{1};
