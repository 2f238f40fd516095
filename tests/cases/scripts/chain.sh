#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# chain.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# A chain of operations: frictionless upsetting in three operations, turned over in between, ends with the exact
# radius, strain and force of one; what is stopped in the second operation and resumed, also with later operations
# changed, gives the same; two ranks give the same; what is wrong is told with the name of the operation.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

# column FILE NAME ROW: a value of a CSV file; row 1 is the first below the head.
column() {
  awk -F, -v name="$2" -v row="$3" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) c = i }
    NR == row + 1 { print $c }' "$1"
}

# near WHAT VALUE EXACT TOLERANCE
near() {
  awk -v a="$2" -v b="$3" -v t="$4" 'BEGIN { d = a / b - 1; exit !(d < t && d > -t) }' </dev/null ||
    fail "$1 is $2, not $3"
}

cat >scene/three.prm <<'END'
set Title = A cylinder upset in three operations
set Operations = first, second, third
set Tools = upper, lower
subsection Workpiece
  set Geometry file       = geometry/cylinder_full.geo
  set Geometry parameters = Radius = 20, Height = 40, RadialCells = 4, AxialCells = 6
end
subsection Material
  set Model                 = product
  set Hardening             = swift
  set Strength coefficient  = 100
  set Prestrain             = 0.01
  set Hardening exponent    = 0.2
end
subsection Tool upper
  set Geometry file       = geometry/platen.geo
  set Geometry parameters = Z = 40
  set Start               = touching
  subsection Motion
    set Type     = constant velocity
    set Velocity = 0, -1
  end
end
subsection Tool lower
  set Geometry file       = geometry/platen.geo
  set Geometry parameters = Z = -3
end
subsection Placement
  set Rest on = lower
end
subsection Time stepping
  set Largest reduction per step = 0.02
end
subsection Operation first
  subsection Process
    set End stroke = 8
    set Dwell      = 0.5
  end
end
subsection Operation second
  subsection Placement
    set Flip = true
  end
  subsection Process
    set End height = 24
    set End stroke = 20
  end
end
subsection Operation third
  subsection Placement
    set Flip = true
  end
  subsection Process
    set End stroke  = 4
    set Fill radius = 10
  end
end
END

name=frictionless
run whole 0 three.prm
summary=whole/output/chain.csv
[ "$(wc -l <"$summary")" = 4 ] || fail "chain.csv has not three rows: $(cat "$summary")"
[ "$(column "$summary" ended_by 1),$(column "$summary" ended_by 2),$(column "$summary" ended_by 3)" = stroke,height,stroke ] ||
  fail "the operations have ended by $(cut -d, -f2 "$summary" | paste -sd' ')"
# What is left of 40 mm: 32, 24 and 20 mm; strain ln(40 / h); r = 20 sqrt(40 / h).
final=$(column "$summary" height_mm 3)
near "height after the second operation" "$(column "$summary" height_mm 2)" 24 1e-3
near "radius" "$(column "$summary" largest_radius_mm 3)" "$(awk -v h="$final" 'BEGIN { print 20 * sqrt(40 / h) }')" 1e-4
near "strain" "$(column "$summary" largest_strain 3)" "$(awk -v h="$final" 'BEGIN { print log(40 / h) }')" 1e-4
near "fill" "$(column "$summary" fill 3)" 1 1e-6
near "start of the second operation" "$(column "$summary" start_s 2)" 8.5 1e-9
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
  NR > 1 && ($column["force_imbalance"] > 1e-4 || $column["relative_volume_change"] ^ 2 > 1e-8) { exit 1 }' "$summary" ||
  fail "forces are not in balance, or volume is lost: $(cat "$summary")"

name=friction_resumed
# Friction, a clean cut of the chain: stopped in the second operation, resumed.
rub=(three.prm --set "Tool upper/Friction/Law = smm" --set "Tool upper/Friction/Factor = 0.3"
  --set "Tool lower/Friction/Law = shear" --set "Tool lower/Friction/Factor = 0.2")
run straight 0 "${rub[@]}"
run cut 2 "${rub[@]}" --set "Operation second/Flow solver/Most iterations = 1"
grep -qF 'Operation "second"' cut/stderr || fail "the message does not name the operation: $(cat cut/stderr)"
grep -qF 'operation "first"' cut/stderr || fail "the message does not say what is kept: $(cat cut/stderr)"
run cut 0 "${rub[@]}" --resume
for operation in 1_first 2_second 3_third; do
  compare straight/output/$operation/history.csv cut/output/$operation/history.csv -v rel=0
done

name=stopped_within
# Kill -9 in the second operation, checkpoints every three steps.
cd scene
"$program" "${rub[@]}" --set "Checkpoint/Every steps = 3" --quiet --output ../killed/output </dev/null >/dev/null 2>&1 &
pid=$!
cd ..
for _ in $(seq 2000); do
  [ "$(cat killed/output/2_second/history.csv 2>/dev/null | wc -l)" -le 5 ] || break
  sleep 0.01
done
kill -9 "$pid" 2>/dev/null || true
wait "$pid" 2>/dev/null || true
run killed 0 "${rub[@]}" --resume
for operation in 1_first 2_second 3_third; do
  compare straight/output/$operation/history.csv killed/output/$operation/history.csv -v rel=0
done

name=later_operation_changed
# The second operation fails; another third one may follow when it is resumed, but not another first one.
run changed 2 "${rub[@]}" --set "Operation second/Flow solver/Most iterations = 1"
run changed 0 "${rub[@]}" --set "Operation third/Tool upper/Friction/Factor = 0.1" --resume
run refused 2 "${rub[@]}" --set "Operation second/Flow solver/Most iterations = 1"
run refused 1 "${rub[@]}" --set "Operation first/Tool upper/Friction/Factor = 0.1" --resume
grep -qF 'Operation first/Tool upper/Friction/Factor' refused/stderr || fail "$(cat refused/stderr)"

name=two_ranks
exact=(--set "Flow solver/Tolerance = 1e-9")
run one 0 "${rub[@]}" "${exact[@]}"
ranks=2 run two 0 "${rub[@]}" "${exact[@]}"
for operation in 1_first 2_second 3_third; do
  compare one/output/$operation/history.csv two/output/$operation/history.csv -v rel=1e-6 -v abs=1e-4 \
    -v only=stroke_mm,force_upper_N,force_lower_N,largest_radius_mm,largest_strain,height_mm
done

name=where_it_lies
# The files are kept once, and found from the folders of the operations as well.
[ ! -e straight/output/1_first/input ] || fail "the files are kept twice"
run lies 0 "$PWD/straight/output/input.prm"
for operation in 1_first 2_second 3_third; do
  compare straight/output/$operation/history.csv lies/output/$operation/history.csv -v rel=0
  run validated 0 "$PWD/lies/output/$operation/input.prm" --validate
done
if python3 -c 'import matplotlib, numpy, PIL' 2>/dev/null; then
  got=0
  python3 "$here/../../../scripts/render.py" lies/output >/dev/null 2>render_said || got=$?
  [ "$got" -ne 0 ] && grep -qF '2_second' render_said || fail "the picture of a chain: $(cat render_said)"
fi

finish
