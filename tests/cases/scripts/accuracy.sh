#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# accuracy.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# With a target accuracy the mesh and the steps follow from estimates: they are the same on one rank and on two,
# and in a run that was stopped and resumed, there digit by digit. Without it history.csv has no such columns.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

scene=(cylinder_upsetting.prm --set "Output/Fields = none" --set "Process/End stroke = 4"
  --set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 6, AxialCells = 6"
  --set "Time stepping/Stroke per step = 0" --set "Checkpoint/Every steps = 1000"
  --set "Accuracy/Target accuracy = 0.5 %" --set "Accuracy/Check every steps = 4")

name=whole
run whole 0 "${scene[@]}"
grep -q "Estimated error of the force" whole/stdout || fail "no summary of the errors"
grep -q "mesh adapted" whole/stdout || fail "the mesh stayed as it was"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
  NR > 1 { sum = $column["error_space"] + $column["error_time"] + $column["error_regularisation"] + $column["error_nonlinear"]
    total = $column["error_total"]; if (total > worst) worst = total
    if (sum - total > 1e-9 || total - sum > 1e-9) bad = 1 }
  END { exit !(NR > 5 && !bad && worst < 0.03) }' whole/output/history.csv ||
  fail "the parts do not add up, or the error is out of hand"

name=two_ranks
ranks=2 run two_ranks 0 "${scene[@]}"
compare whole/output/history.csv two_ranks/output/history.csv -v rel=1e-6 \
  -v only=time_s,force_upper_N,contact_radius_upper_mm,volume_mm3,largest_strain,cells

name=resumed
run resumed 2 "${scene[@]}" --set "Time stepping/Most steps = 5"
run resumed 0 "${scene[@]}" --resume
compare whole/output/history.csv resumed/output/history.csv -v rel=0

name=without
run without 2 "${scene[@]}" --set "Accuracy/Target accuracy = none" --set "Time stepping/Most steps = 2"
if grep -q error_ without/output/history.csv; then
  fail "columns of estimates that nobody asked for"
fi

finish
