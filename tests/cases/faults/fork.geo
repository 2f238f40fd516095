// SPDX-License-Identifier: GPL-2.0-or-later
Point(1) = {0, 25, 0};
Point(2) = {20, 25, 0};
Point(3) = {50, 25, 0};
Point(4) = {50, 40, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {2, 4};
Physical Curve("tool") = {1, 2, 3};
