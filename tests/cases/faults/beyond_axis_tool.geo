// SPDX-License-Identifier: GPL-2.0-or-later
Point(1) = {-50, 25, 0};
Point(2) = {50, 25, 0};
Line(1) = {1, 2};
Physical Curve("tool") = {1};
