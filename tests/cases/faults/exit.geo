// SPDX-License-Identifier: GPL-2.0-or-later
Point(1) = {0, 0, 0};
Exit;
