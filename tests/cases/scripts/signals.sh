#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# signals.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# A terminal that is closed and a pipe that nobody reads any more end a run like SIGTERM: after the present
# step, with a checkpoint and status 2. Under nohup it goes on. On one rank and on two.
set -euo pipefail
export LC_ALL=C OPENBLAS_NUM_THREADS=1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"
scene=(cylinder_upsetting.prm "${coarse[@]}" --set "Time stepping/Stroke per step = 0.01"
  --set "Output/Fields = none")
[ "$(id -u)" -ne 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

# wait_for_rows FOLDER ROWS PID: until history.csv has so many rows.
wait_for_rows() {
  local waited=0
  while [ "$(cat "$1/output/history.csv" 2>/dev/null | wc -l)" -le "$2" ]; do
    if ! kill -0 "$3" 2>/dev/null || [ "$waited" -gt 12000 ]; then
      fail "the run has ended before the signal: $(cat "$1/stderr")"
      break
    fi
    sleep 0.02
    waited=$((waited + 1))
  done
}

# stopped FOLDER TEXT: it has said so, and kept its state.
stopped() {
  grep -qF "asked to stop by a signal ($2" "$1/stderr" || fail "$(cat "$1/stderr")"
  [ -s "$1/output/checkpoint.axi" ] || fail "there is no checkpoint"
}

# begin_run FOLDER COMMAND...: in scene/, beside this script. Sets $pid.
begin_run() {
  local folder=$PWD/$1
  mkdir -p "$folder"
  cd scene
  "${@:2}" "${scene[@]}" --quiet --output "$folder/output" </dev/null >"$folder/stdout" 2>"$folder/stderr" &
  pid=$!
  cd ..
}

name=terminal_closed
begin_run closed "$program"
wait_for_rows closed 3 "$pid"
kill -HUP "$pid"
got=0
wait "$pid" || got=$?
[ "$got" -eq 2 ] || fail "exit status $got instead of 2"
stopped closed SIGHUP
run closed 0 "${scene[@]}" --resume

name=nohup
begin_run ignored nohup "$program"
wait_for_rows ignored 3 "$pid"
kill -HUP "$pid"
got=0
wait "$pid" || got=$?
[ "$got" -eq 0 ] || fail "exit status $got instead of 0: $(cat ignored/stderr)"
compare closed/output/history.csv ignored/output/history.csv -v rel=0

name=pipe
mkdir pipe
(
  cd scene
  got=0
  "$program" "${scene[@]}" --output "$PWD/../pipe/output" 2>../pipe/stderr || got=$?
  echo "$got" >../pipe/status
) | head -n 4 >/dev/null
[ "$(cat pipe/status)" -eq 2 ] || fail "exit status $(cat pipe/status) instead of 2"
stopped pipe SIGPIPE

name=pipe_of_messages
# The message meets the broken pipe as well.
mkdir pipe_too
(
  cd scene
  got=0
  "$program" "${scene[@]}" --output "$PWD/../pipe_too/output" 2>&1 || got=$?
  echo "$got" >../pipe_too/status
) | head -n 4 >/dev/null
[ "$(cat pipe_too/status)" -eq 2 ] || fail "exit status $(cat pipe_too/status) instead of 2"
[ -s pipe_too/output/checkpoint.axi ] || fail "there is no checkpoint"

name=two_ranks
begin_run two "${AXIFORGE_MPIRUN:-mpirun}" --oversubscribe -np 2 "$program"
wait_for_rows two 3 "$pid"
kill -HUP "$(pgrep -P "$pid" | tail -n 1)" || fail "there are no ranks"
wait "$pid" && fail "the run has gone on"
stopped two SIGHUP
finish
