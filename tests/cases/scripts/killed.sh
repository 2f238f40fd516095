#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# killed.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# A run that is killed leaves whole files: complete rows in history.csv, complete .vtu and .pvd, and nothing in
# a .pvd that is not there. Killed at several moments, without a chance to tidy up.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

# kill_after ROWS: starts the scene and kills it when history.csv has so many rows.
kill_after() {
  local rows=$1 output=$PWD/after_$1 pid waited=0
  cd scene
  OPENBLAS_NUM_THREADS=1 "$program" cylinder_upsetting.prm --quiet --output "$output" \
    --set "Output/Fields every steps = 1" --set "Time stepping/Stroke per step = 0.02" \
    </dev/null >../stdout 2>../stderr &
  pid=$!
  cd ..
  while [ "$(cat "$output/history.csv" 2>/dev/null | wc -l)" -le "$rows" ]; do
    if ! kill -0 "$pid" 2>/dev/null || [ "$waited" -gt 1200 ]; then
      fail "the run has ended before it was killed: $(cat stderr)"
      break
    fi
    sleep 0.05
    waited=$((waited + 1))
  done
  kill -9 "$pid" 2>/dev/null || true
  wait "$pid" 2>/dev/null || true
}

check_whole() { # FOLDER
  local file named
  [ -z "$(tail -c 1 "$1/history.csv" | tr -d '\n')" ] || fail "history.csv ends within a row"
  awk -F, 'NR == 1 { n = NF } NF != n || $NF == "" { exit 1 }' "$1/history.csv" ||
    fail "history.csv has rows of different lengths"
  for file in "$1"/*.pvd "$1"/fields/*.vtu; do
    [ "$(tail -n 1 "$file")" = "</VTKFile>" ] || fail "$file is not whole"
  done
  for file in "$1"/*.pvd; do
    while IFS= read -r named; do
      [ -s "$1/$named" ] || fail "$file names $named, which is not there"
    done < <(sed -n 's/.*file="\([^"]*\)".*/\1/p' "$file")
  done
  for file in input.prm parameters.prm versions.txt; do
    [ -s "$1/$file" ] || fail "$file is missing"
  done
}

for rows in 1 4 8; do
  name=after_$rows
  kill_after "$rows"
  check_whole "$PWD/after_$rows"
done
finish
