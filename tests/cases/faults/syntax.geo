// SPDX-License-Identifier: GPL-2.0-or-later
Point(1) = {0, 0, 0};
Point(2) = {25, 0, 0};
Line(1) = {1, 2;
