#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# resumed.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# A run that was stopped and resumed has the history of one that was not: digit by digit on the same number of
# ranks, to 1e-8 on another. Stopped by SIGTERM, by kill -9 at any moment, by steps that can't be solved. The
# side folds on to the platen in between; with the SMM layer, and with shear friction whose rate lags.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

scene=(cylinder_upsetting.prm --set "Time stepping/Stroke per step = 0.1" --set "Process/End stroke = 6"
  --set "Output/Fields every steps = 7"
  --set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 8, AxialCells = 8")
figures=time_s,force_upper_N,contact_radius_upper_mm,volume_mm3,largest_strain,power_friction_mW
shear=(--set "Tool upper/Friction/Law = shear")

# resume FOLDER STATUS ARGUMENT...: goes on in the folder's results.
resume() {
  local folder=$1
  run "$@" --resume
  no_gap "$folder"
}

# no_gap FOLDER: collections and fields fit each other.
no_gap() {
  local named files
  named=$(sed -n 's/.*file="fields\/\([^"]*\)".*/\1/p' "$1"/output/*.pvd | sort)
  files=$(cd "$1/output/fields" && ls | sort)
  [ "$named" = "$files" ] || fail "the collections name other files than there are in $1"
}

# stop FOLDER SIGNAL ROWS ARGUMENT...: starts the scene and sends the signal when history.csv has so many rows.
# Sets $got.
stop() {
  local output=$PWD/$1/output signal=$2 rows=$3 pid waited=0
  mkdir -p "$1"
  cd scene
  OPENBLAS_NUM_THREADS=1 "$program" "${@:4}" --quiet --output "$output" </dev/null \
    >"../$1/stdout" 2>"../$1/stderr" &
  pid=$!
  cd ..
  while [ "$(cat "$output/history.csv" 2>/dev/null | wc -l)" -le "$rows" ]; do
    if ! kill -0 "$pid" 2>/dev/null || [ "$waited" -gt 2400 ]; then
      fail "the run has ended before the signal: $(cat "$1/stderr")"
      break
    fi
    sleep 0.02
    waited=$((waited + 1))
  done
  kill "-$signal" "$pid" 2>/dev/null || true
  got=0
  wait "$pid" 2>/dev/null || got=$?
}

# same A B: all rows, and as many of them.
same() {
  compare "$1/output/history.csv" "$2/output/history.csv" -v rel=0
  [ "$(wc -l <"$1/output/history.csv")" = "$(wc -l <"$2/output/history.csv")" ] ||
    fail "$2 has another number of rows than $1"
  [ "$(ls "$1/output/fields")" = "$(ls "$2/output/fields")" ] || fail "$2 has other fields than $1"
}

name=uninterrupted
run smm 0 "${scene[@]}"
run shear 0 "${scene[@]}" "${shear[@]}"
[ ! -e smm/output/checkpoint.axi ] || fail "there is a checkpoint that nobody asked for"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
  NR == 7 { first = $column["contact_radius_upper_mm"] }
  NR > 1 { last = $column["contact_radius_upper_mm"] }
  END { exit !(last > first + 1) }' smm/output/history.csv ||
  fail "the side has not folded on to the platen after step 6: the scene is too easy for this test"

name=terminated
stop term TERM 4 "${scene[@]}"
[ "$got" -eq 2 ] || fail "exit status $got instead of 2"
grep -qF 'asked to stop by a signal' term/stderr || fail "$(cat term/stderr)"
grep -qF -- '--resume continues there' term/stderr || fail "$(cat term/stderr)"
[ -s term/output/checkpoint.axi ] || fail "there is no checkpoint"
resume term 0 "${scene[@]}"
same smm term

name=terminated_with_shear
stop term_shear TERM 6 "${scene[@]}" "${shear[@]}"
[ "$got" -eq 2 ] || fail "exit status $got instead of 2"
resume term_shear 0 "${scene[@]}" "${shear[@]}"
same shear term_shear

# Whatever the moment, there is a whole checkpoint; steps after it are made again.
name=killed
for rows in 2 9 23; do
  stop "killed_$rows" KILL "$rows" "${scene[@]}" --set "Checkpoint/Every steps = 1"
  resume "killed_$rows" 0 "${scene[@]}" --set "Checkpoint/Every steps = 1"
  same smm "killed_$rows"
done
stop killed_minutes KILL 5 "${scene[@]}" --set "Checkpoint/Every minutes = 1e-7"
resume killed_minutes 0 "${scene[@]}"
same smm killed_minutes

name=every_steps
stop steps KILL 9 "${scene[@]}" --set "Checkpoint/Every steps = 4"
[ -s steps/output/checkpoint.old.axi ] || fail "the checkpoint before the last is not kept"
cp -r steps older
resume steps 0 "${scene[@]}"
same smm steps
# From the one before it, which is further back.
mv older/output/checkpoint.old.axi older/output/back.axi
run older 0 "${scene[@]}" --resume "$PWD/older/output/back.axi"
newer=$(sed -n 's/^resumed after step \([0-9]*\),.*/\1/p' steps/stdout)
back=$(sed -n 's/^resumed after step \([0-9]*\),.*/\1/p' older/stdout)
# The same if it was killed when the last one was about to take its place.
[ "$back" -eq $((newer - 4)) ] || [ "$back" -eq "$newer" ] ||
  fail "the older checkpoint is of step $back, the newer one of step $newer"
same smm older

name=asked
stop asked USR1 3 "${scene[@]}"
[ "$got" -eq 0 ] || fail "exit status $got: the run should go on"
[ -s asked/output/checkpoint.axi ] || fail "there is no checkpoint"
same smm asked

# A run that can't go on keeps its last good state; with what it lacked it goes on from there.
name=iterations_run_out
run out 2 "${scene[@]}" --set "Time stepping/Most steps = 10" --set "Checkpoint/Every steps = 100"
run out 2 "${scene[@]}" --set "Flow solver/Most iterations = 1" --resume
grep -qF 'The state after step 10 is kept' out/stderr || fail "$(cat out/stderr)"
resume out 0 "${scene[@]}"
same smm out

# A finished run goes further; its steps differ by rounding errors, because they share out what is left.
name=further
run further 0 "${scene[@]}" --set "Process/End stroke = 2" --set "Checkpoint/Every steps = 1000"
resume further 0 "${scene[@]}"
compare smm/output/history.csv further/output/history.csv -v rel=1e-7 -v only="$figures"

name=two_ranks
ranks=2 run two 0 "${scene[@]}"
ranks=2 run two_short 2 "${scene[@]}" --set "Time stepping/Most steps = 20" \
  --set "Checkpoint/Every steps = 12"
cp -r two_short two_on_one
ranks=2 resume two_short 0 "${scene[@]}"
same two two_short
resume two_on_one 0 "${scene[@]}"
compare two/output/history.csv two_on_one/output/history.csv -v rel=1e-8 -v only="$figures"

# A signal that reaches one rank stops both.
name=signal_to_one_rank
mkdir -p one_rank
cd scene
OPENBLAS_NUM_THREADS=1 "${AXIFORGE_MPIRUN:-mpirun}" --oversubscribe -np 2 "$program" "${scene[@]}" --quiet \
  --output "$PWD/../one_rank/output" </dev/null >../one_rank/stdout 2>../one_rank/stderr &
pid=$!
cd ..
for _ in $(seq 600); do
  [ "$(cat one_rank/output/history.csv 2>/dev/null | wc -l)" -le 5 ] || break
  sleep 0.05
done
kill -TERM "$(pgrep -P "$pid" | tail -n 1)" || fail "there are no ranks"
wait "$pid" && fail "the run has gone on"
[ "$(grep -cF 'asked to stop by a signal' one_rank/stderr)" -eq 1 ] || fail "$(cat one_rank/stderr)"
ranks=2 resume one_rank 0 "${scene[@]}"
same two one_rank

# Messages of one line, status 1, and nothing in the folder is touched.
refused() { # TEXT ARGUMENT...
  local text=$1
  shift
  run refused 1 "${scene[@]}" "$@"
  grep -qF -- "$text" refused/stderr || fail "the message does not have \"$text\": $(cat refused/stderr)"
}
name=refused
refused 'There is no checkpoint' --resume
mkdir -p refused/output
head -c 3000 two/output/history.csv >refused/output/checkpoint.axi
refused 'is no checkpoint of axiforge' --resume
head -c 30000 term/output/checkpoint.axi >refused/output/checkpoint.axi
refused 'is damaged' --resume
cp term/output/checkpoint.axi refused/output/
refused 'history.csv' --resume
refused '"Tool upper/Friction/Factor"' --resume --set "Tool upper/Friction/Factor = 0.123"
refused 'Leave --output out' --resume "$PWD/term/output"

finish
