// SPDX-License-Identifier: GPL-2.0-or-later
Include "rectangle.geo";
Translate {0, 40, 0} { Duplicata { Surface{1}; } }
Transfinite Surface{:};
Physical Surface("workpiece") = Surface{:};
