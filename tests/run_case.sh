#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# run_case.sh PROGRAM CASE_FOLDER WORK_FOLDER
#
# Runs the scene of a case and compares what comes out with what is expected. With UPDATE_EXPECTED=1 the
# files in expected/ are written instead. The format of case.conf stands in cases/README.md.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/case_functions.sh"

program=$(realpath "$1")
case_folder=$(realpath "$2")
work=$3
name=$(basename "$case_folder")

scene=case.prm expected=expected status=0 ranks=1
arguments=() messages=() absent=() files=() comparisons=()
read_entry() { # KEY VALUE
  case $1 in
    scene) scene=$2 ;;
    expected) expected=$2 ;;
    status) status=$2 ;;
    ranks) ranks=$2 ;;
    set) arguments+=(--set "$2") ;;
    argument) arguments+=("$2") ;;
    message) messages+=("$2") ;;
    absent) absent+=("$2") ;;
    file) files+=("$2") ;;
    compare) comparisons+=("$2") ;;
    labels | timeout) ;; # read by cases.cmake
    *) return 1 ;;
  esac
}
read_entries "$case_folder/case.conf"

# compare FILE [text] [abs X] [rel X] [range X] [skip A,B] [only A,B]
compare() {
  local file=$1 mode=numbers
  local abs=0 rel=1e-6 range=0 skip='' only=''
  shift
  while [ $# -gt 0 ]; do
    case $1 in
      text)
        mode=text
        shift
        continue
        ;;
      abs | rel | range | skip | only) ;;
      *) fail "compare: $file: unknown word \"$1\"" && return ;;
    esac
    [ $# -ge 2 ] || { fail "compare: $file: \"$1\" without a value" && return; }
    printf -v "$1" '%s' "$2"
    shift 2
  done

  local actual=$work/output/$file wanted=$case_folder/$expected/$file
  if [ ! -f "$actual" ]; then
    fail "the program has not written $file"
  elif [ "${UPDATE_EXPECTED:-0}" = 1 ]; then
    if [ "$expected" != expected ]; then
      echo "$name: $file is the expectation of another case, not updated"
      return
    fi
    mkdir -p "$(dirname "$wanted")"
    if [ "$mode" = text ]; then
      cp "$actual" "$wanted"
    else
      awk -v mode=filter -v skip="$skip" -v only="$only" -f "$here/compare_csv.awk" \
        "$actual" >"$wanted"
    fi
    echo "$name: $wanted updated"
  elif [ ! -f "$wanted" ]; then
    fail "there is no $wanted; UPDATE_EXPECTED=1 writes it"
  elif [ "$mode" = text ]; then
    diff -u "$wanted" "$actual" || fail "$file differs"
  else
    awk -v abs="$abs" -v rel="$rel" -v range="$range" -v skip="$skip" -v only="$only" \
      -f "$here/compare_csv.awk" "$wanted" "$actual" ||
      fail "$file differs (tolerances: abs $abs, rel $rel, range $range)"
  fi
}

rm -rf "$work"
mkdir -p "$work"
work=$(realpath "$work")
got=0
run_program "$work" "$ranks" "$program" "$case_folder/$scene" --output "$work/output" \
  ${arguments[@]+"${arguments[@]}"} || got=$?

screen=$(cat "$work/stdout" "$work/stderr")
[ "$got" -eq "$status" ] || fail "exit status $got instead of $status"
for text in ${messages[@]+"${messages[@]}"}; do
  grep -qF -- "$text" <<<"$screen" || fail "the program has not said: $text"
done
for text in ${absent[@]+"${absent[@]}"}; do
  ! grep -qF -- "$text" <<<"$screen" || fail "the program has said: $text"
done
check_no_crash "$screen"
for file in ${files[@]+"${files[@]}"}; do
  [ -s "$work/output/$file" ] || fail "the program has not written $file"
done
left=$(find "$work" -name '.*.tmp')
[ -z "$left" ] || fail "half-written files are left: $left"
for comparison in ${comparisons[@]+"${comparisons[@]}"}; do
  read -r -a words <<<"$comparison"
  compare "${words[@]}"
done

if [ "$n_failures" -gt 0 ]; then
  echo "--- the end of what the program said (all of it: $work/stdout, $work/stderr)"
  tail -n 30 <<<"$screen"
  exit 1
fi
echo "$name: passed"
