#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# closed_dies.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# Dies that close: a container that gets full at a stroke known beforehand, on one and two ranks; a die whose
# excess goes out as flash, with and without refinement; a billet that sits with its edge on the end of a fillet;
# rod through a square die; a cup whose wall sticks to the container. Volume is kept in every step.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"
cd scene

# Upper half of a die: a boss with draft, a flange, a flash land; FACE looks down to z = Z.
for side in upper lower; do
  sign=$([ $side = upper ] && echo 1 || echo -1)
  cat >flash_$side.geo <<END
DefineConstant[ Z = {0, Name "Z"} ];
s = $sign;
Point(1) = {0, Z + s*14, 0}; Point(2) = {9, Z + s*14, 0}; Point(3) = {9, Z + s*12.5, 0}; Point(4) = {10.5, Z + s*12.5, 0};
Point(5) = {11.1, Z + s*6, 0}; Point(6) = {13.6, Z + s*6, 0}; Point(7) = {13.6, Z + s*3.5, 0};
Point(8) = {21, Z + s*3.5, 0}; Point(9) = {21, Z + s*2.2, 0}; Point(10) = {22.3, Z + s*2.2, 0};
Point(11) = {22.6, Z, 0}; Point(12) = {45, Z, 0};
Line(1) = {1, 2}; Circle(2) = {2, 3, 4}; Line(3) = {4, 5}; Circle(4) = {5, 6, 7}; Line(5) = {7, 8};
Circle(6) = {8, 9, 10}; Line(7) = {10, 11}; Line(8) = {11, 12};
Physical Curve("tool") = {1:8};
END
done
cat >square_die.geo <<'END'
Point(1) = {9, -25, 0}; Point(2) = {9, 0, 0}; Point(3) = {12, 0, 0}; Point(4) = {12, 60, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4};
Physical Curve("tool") = {1:3};
END

# tool NAME FILE PARAMETERS VELOCITY LAW
tool() {
  printf 'subsection Tool %s\n  set Geometry file = %s\n' "$1" "$2"
  [ -z "$3" ] || printf '  set Geometry parameters = %s\n' "$3"
  [ -z "$4" ] || printf '  subsection Motion\n    set Type = constant velocity\n    set Velocity = 0, %s\n  end\n' "$4"
  printf '  subsection Friction\n    %s\n  end\nend\n' "$5"
}
# workpiece RADIUS HEIGHT RADIAL_CELLS AXIAL_CELLS
workpiece() {
  printf 'subsection Workpiece\n  set Geometry file = geometry/cylinder_full.geo\n'
  printf '  set Geometry parameters = Radius = %s, Height = %s, RadialCells = %s, AxialCells = %s\nend\n' "$@"
}
common='subsection Remeshing
  set Enabled = true
end
subsection Output
  set Fields = none
end'
plastic='subsection Material
  set Model = perfectly plastic
  set Yield stress = 120
end'
hardening='subsection Material
  set Model = product
  set Hardening = swift
  set Strength coefficient = 140
  set Prestrain = 0.04
  set Hardening exponent = 0.12
  set Rate sensitivity = power
  set Rate exponent = 0.1
end'

shear='set Law = shear
    set Factor = 0.2'
{
  echo 'set Tools = ram, wall, bottom'
  workpiece 12 30 6 14
  echo "$plastic"
  tool ram geometry/platen.geo 'Z = 30, Radius = 15' -1 "$shear"
  tool wall geometry/container.geo 'Radius = 15, Height = 50' '' "$shear"
  tool bottom geometry/platen.geo 'Z = 0, Radius = 15' '' "$shear"
  printf 'subsection Process\n  set End stroke = 15\nend\n%s\n' "$common"
} >full.prm

shear='set Law = shear
    set Factor = 0.25'
{
  echo 'set Tools = upper, lower'
  workpiece 10 63 6 32
  printf 'subsection Placement\n  set Rest on = lower\nend\n%s\n' "$hardening"
  tool upper flash_upper.geo 'Z = 40' -80 "$shear"
  printf 'subsection Tool upper\n  set Start = touching\nend\n'
  tool lower flash_lower.geo '' '' "$shear"
  printf 'subsection Process\n  set End stroke = 40\n  set End force = 1.4e6\nend\n%s\n' "$common"
} >flash.prm
# The same dies; the billet's lower edge stands where the fillet meets the draft.
sed 's/Radius = 10, Height = 63/Radius = 10.5, Height = 57/' flash.prm >junction.prm

{
  echo 'set Tools = ram, die'
  workpiece 12 30 6 14
  echo "$plastic"
  tool ram geometry/platen.geo 'Z = 30, Radius = 12' -1 'set Law = none'
  tool die square_die.geo '' '' 'set Law = none'
  printf 'subsection Process\n  set End stroke = 4\nend\n%s\n' "$common"
} >square.prm

{
  echo 'set Tools = punch, wall, bottom'
  workpiece 20 26 8 10
  echo "$hardening"
  tool punch geometry/cup_punch.geo 'Z = 26' -20 "$shear"
  tool wall geometry/container.geo 'Radius = 20, Height = 80' '' 'set Law = sticking'
  tool bottom geometry/platen.geo 'Z = 0, Radius = 20' '' "$shear"
  printf 'subsection Process\n  set End stroke = 6\nend\n%s\n' "$common"
} >cup.prm
cd ..

# figure FOLDER COLUMN first|last|worst: of the history; worst is the largest magnitude.
figure() {
  awk -F, -v c="$2" -v which="$3" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == c) k = i; next }
    { last = $k; if (NR == 2) first = $k; v = $k < 0 ? -$k : $k; if (v > worst) worst = v }
    END { print k ? (which == "first" ? first : which == "last" ? last : worst) : "nan" }' "$1/output/history.csv"
}
# holds TEXT CONDITION OF AWK
holds() {
  awk "BEGIN { exit !($2) }" || fail "$1: $2"
}
keeps_volume() {
  holds "the volume is kept" "$(figure "$1" relative_volume_change worst) < 1e-4"
}

# 30 mm at radius 12 are 19.2 mm at radius 15.
for ranks in 1 2; do
  name=full_$ranks
  run "$name" 0 full.prm
  grep -q 'the die is full at stroke' "$name/stdout" || fail "the die is not said to be full"
  holds "full at the exact stroke" "$(figure "$name" stroke_mm last) > 10.8 * 0.998"
  holds "full at the exact stroke" "$(figure "$name" stroke_mm last) < 10.8 * 1.0005"
  keeps_volume "$name"
done
ranks=1
name=force_before_full
run "$name" 0 full.prm --set "Process/End force = 100e3"
! grep -q 'the die is full' "$name/stdout" || fail "the force comes before the die is full"
holds "the force is reached" "$(figure "$name" end_force_ram_N last) > 99.8e3"
holds "the force is passed by a jump of the contact at most" "$(figure "$name" end_force_ram_N last) < 103e3"

for name in flash junction; do
  run "$name" 0 "$name.prm"
  keeps_volume "$name"
  holds "the force is reached" "$(figure "$name" end_force_upper_N last) > 1.397e6"
  holds "there is a flash" "$(figure "$name" largest_radius_mm last) > 22.6"
done
holds "an edge on a fillet's end is found at once" "$(figure junction iterations first) < 60"

name=flash_refined
run "$name" 0 flash.prm --set "Refinement/Enabled = true" --set "Refinement/Every steps = 2" \
  --set "Refinement/Largest level = 1" --set "Refinement/Most cells = 500" --set "Process/End stroke = 24"
keeps_volume "$name"

name=square
run "$name" 0 square.prm
keeps_volume "$name"

name=cup
run "$name" 0 cup.prm
keeps_volume "$name"
holds "the cup is deep" "$(figure cup stroke_mm last) > 5.999"

finish
