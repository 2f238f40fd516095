#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# unwritten.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# Fields that can't be written, while the run goes on beside: the message names the file, no list and no checkpoint has
# it, and the run can be resumed when the obstacle is gone. The same when they are the last ones, which are then made up for.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

scene=(cylinder_upsetting.prm "${coarse[@]}" --set "Time stepping/Stroke per step = 0.1" --set "Output/Fields every steps = 2")

name=free
run free 0 "${scene[@]}"

for step in 00004 00010; do # in between, and the last step
  name=blocked_$step
  # A folder that is not empty can't be replaced by a file.
  obstacle=$name/output/fields/workpiece_$step.vtu
  mkdir -p "$obstacle/obstacle"
  run "$name" 2 "${scene[@]}"
  grep -qF "workpiece_$step.vtu\": Is a directory" "$name/stderr" || fail "the file is not named: $(cat "$name/stderr")"
  grep -qF -- '--resume continues there' "$name/stderr" || fail "no advice: $(cat "$name/stderr")"
  [ -s "$name/output/checkpoint.axi" ] || fail "there is no checkpoint"
  for list in fields tools; do
    ! grep -q "_$step" "$name/output/$list.pvd" || fail "$list.pvd has the file that is not there"
  done
  rm -r "$obstacle"
  run "$name" 0 "${scene[@]}" --resume
  compare free/output/history.csv "$name/output/history.csv" -v rel=0
  expected=(workpiece_00000 workpiece_00002 workpiece_00004 workpiece_00006 workpiece_00008 workpiece_00010)
  [ "$step" = 00010 ] || expected=("${expected[@]/workpiece_$step/}")
  for list in "$(cd "$name/output/fields" && ls workpiece_*)" "$(sed -n 's/.*file="fields\/\([^"]*\)".*/\1/p' "$name/output/fields.pvd")"; do
    [ "$(echo ${list//.vtu/})" = "$(echo ${expected[*]})" ] || fail "fields and list should be ${expected[*]}, not $list"
  done
done

finish
