# SPDX-License-Identifier: GPL-2.0-or-later
# What the scripts of this folder share. To be sourced after case_functions.sh.

# Example 1 with few cells and steps.
coarse=(--set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 5, AxialCells = 5"
  --set "Process/End stroke = 1")

# begin PROGRAM PARAMETER_FILES WORK_FOLDER: an empty work folder with a copy of the scenes in scene/.
begin() {
  program=$(realpath "$1")
  rm -rf "$3"
  mkdir -p "$3"
  cp -r "$2" "$3/scene"
  cd "$3"
}

# run FOLDER STATUS ARGUMENT...: on $ranks ranks (1), in scene/; results in FOLDER/output.
run() {
  local folder=$1 status=$2 got=0
  shift 2
  mkdir -p "$folder"
  run_program scene "${ranks:-1}" "$program" "$@" --output "$PWD/$folder/output" || got=$?
  mv scene/stdout scene/stderr "$folder/"
  if [ "$got" -ne "$status" ]; then
    fail "exit status $got instead of $status; it said: $(tail -n 3 "$folder/stderr" "$folder/stdout")"
  fi
  check_no_crash "$(cat "$folder/stdout" "$folder/stderr")"
}

# no_files FOLDER: the run has left no results.
no_files() {
  [ ! -e "$1/output" ] || fail "there are files: $(find "$1/output")"
}

# compare EXPECTED ACTUAL [OPTION OF AWK...]: all columns but the times on the wall.
compare() {
  local expected=$1 actual=$2 columns
  shift 2
  if [ ! -s "$expected" ] || [ ! -s "$actual" ]; then
    fail "$expected or $actual is missing"
    return
  fi
  columns=$(head -n 1 "$expected" | tr ',' '\n' | grep '^wall_' | paste -sd, -)
  awk "$@" -v skip="$columns" -f "$here/../../compare_csv.awk" "$expected" "$actual" ||
    fail "$actual differs from $expected"
}

# Ends the script: 0 if nothing has failed.
finish() {
  [ "$n_failures" -eq 0 ] || exit 1
  echo "passed"
  exit 0
}
