#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# timing.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# --timing: the table has the phases that a scene enters and no others, its parts add up to the whole, and
# the answers are those of a run without it.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

optional=("friction" "need of a new mesh" "remeshing" "adaptive refinement" "error estimate" "folds" "gauges" "fields" "checkpoint")
has_phase() { # FOLDER NAME
  grep -qE "^\| +$2 +\|" "$1/stdout"
}

bare=(cylinder_upsetting.prm "${coarse[@]}" --set "Output/Fields = none" --set "Folding/When found = off"
  --set "Tool upper/Friction/Law = none" --set "Tool upper/Friction/Factor = 0")
name=bare
run bare 0 "${bare[@]}" --timing
for phase in "whole run" "flow solver" "assembly" "factorisation" "contact search" "output"; do
  has_phase bare "$phase" || fail "there is no phase \"$phase\": $(cat bare/stdout)"
done
for phase in "${optional[@]}"; do
  ! has_phase bare "$phase" || fail "the phase \"$phase\" was entered, and nobody asked for it"
done
# Each figure is rounded to a thousandth of a second.
awk -F'|' '$2 ~ /whole run/ { whole = $4 } $2 ~ /^ *[a-z]/ && $7 ~ /[0-9]/ { own += $7; ++n }
  END { d = own - whole; exit !(n > 5 && d * d <= (0.0005 * (n + 1)) ^ 2) }' \
  bare/stdout || fail "the phases' own times do not add up to the whole"

name=plain
run plain 0 "${bare[@]}"
! grep -q "whole run" plain/stdout || fail "a table that nobody asked for"
compare bare/output/history.csv plain/output/history.csv

name=full
run full 0 cylinder_upsetting.prm "${coarse[@]}" --timing --set "Remeshing/Enabled = true" --set "Remeshing/Every steps = 2" \
  --set "Accuracy/Estimate errors = true" --set "Refinement/Enabled = true" --set "Refinement/Every steps = 2" \
  --set "Checkpoint/Every steps = 2" --set "Gauges = bulge" --set "Gauge bulge/Measure = outer radius"
for phase in "${optional[@]}"; do
  has_phase full "$phase" || fail "the phase \"$phase\" is missing: $(cat full/stdout)"
done

finish
