#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# run_faults.sh PROGRAM FAULTS_FOLDER WORK_FOLDER [PART N_PARTS]
#
# Runs the faulty scenes *.fault of a folder (those whose number modulo N_PARTS is PART) and asks of each:
# exit status 1, one message on one line of the error stream with all the expected texts, no crash, no
# result files. The format of a fault stands in cases/README.md.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/case_functions.sh"

program=$(realpath "$1")
faults=$(realpath "$2")
work_folder=$3
part=${4:-0}
n_parts=${5:-1}

read_entry() { # KEY VALUE
  case $1 in
    base) base=$2 ;;
    scene) scene=$2 ;;
    set) arguments+=(--set "$2") ;;
    argument) arguments+=("$2") ;;
    file) extra_files+=("$2") ;;
    append | remove | replace) edits+=("$1 $2") ;;
    expect) expected+=("$2") ;;
    status) status=$2 ;;
    ranks) ranks=$2 ;;
    lines) n_lines=$2 ;;
    *) return 1 ;;
  esac
}

# edit FILE "append LINE" | "remove TEXT" | "replace OLD => NEW"; TEXT and OLD are plain text and must be
# there: a fault that has lost its hold on the scene is no test.
edit() {
  local file=$1 kind=${2%% *} rest=${2#* } old new content
  content=$(cat "$file")
  case $kind in
    append) printf '%s\n%s\n' "$content" "$rest" >"$file" ;;
    remove)
      grep -qF -- "$rest" "$file" || fail "the scene has no line with \"$rest\""
      grep -vF -- "$rest" <<<"$content" >"$file" || true
      ;;
    replace)
      old=${rest%% => *}
      new=${rest#* => }
      [ "$old" != "$rest" ] || { fail "write replace: OLD => NEW, not \"$rest\"" && return; }
      [[ $content == *"$old"* ]] || fail "the scene has no \"$old\""
      printf '%s\n' "${content//"$old"/"$new"}" >"$file"
      ;;
  esac
}

# A folder with links to all files beside the scene, and the scene as a file of its own.
copy_scene() { # SCENE WORK
  local file
  for file in "$(dirname "$1")"/*; do
    [ "${file##*.}" = fault ] || ln -s "$file" "$2/"
  done
  rm -f "$2/$(basename "$1")"
  cp "$1" "$2/"
}

run_fault() { # FILE.fault
  name=$(basename "$1" .fault)
  base='' scene='' status=1 ranks=1 n_lines=1
  arguments=() extra_files=() edits=() expected=()
  read_entries "$1"
  [ ${#expected[@]} -gt 0 ] || fail "no \"expect:\" in $1"

  local work=$work_folder/$name file text got=0
  mkdir -p "$work"
  if [ -z "$scene" ]; then
    local original=$faults/${base:-$name.prm}
    if [ ! -f "$original" ]; then
      fail "$original is missing"
      return
    fi
    copy_scene "$original" "$work"
    scene=$(basename "$original")
  fi
  for file in ${extra_files[@]+"${extra_files[@]}"}; do
    ln -sf "$faults/$file" "$work/"
  done
  for text in ${edits[@]+"${edits[@]}"}; do
    edit "$work/$scene" "$text"
  done

  # A fault that is not noticed would start the run: two minutes are enough to know.
  run_program "$work" "$ranks" timeout 120 "$program" "$scene" --output "$work/output" \
    ${arguments[@]+"${arguments[@]}"} || got=$?
  local before=$n_failures message
  message=$(cat "$work/stderr")
  [ "$got" -eq "$status" ] || fail "exit status $got instead of $status"
  for text in "${expected[@]}"; do
    grep -qF -- "$text" <<<"$message" || fail "the message does not have: $text"
  done
  check_no_crash "$(cat "$work/stdout" "$work/stderr")"
  # mpirun adds words of its own; there each text must come once, from one rank.
  if [ "$ranks" -eq 1 ]; then
    [ "$(grep -c '[^[:space:]]' <<<"$message")" -eq "$n_lines" ] ||
      fail "the message should have $n_lines line(s)"
  else
    [ "$(grep -cF -- "${expected[0]}" <<<"$message")" -eq 1 ] ||
      fail "the message should come from one rank"
  fi
  [ -z "$(find "$work/output" -type f 2>/dev/null)" ] || fail "result files are left in $work/output"
  if [ "$n_failures" -gt "$before" ]; then
    printf -- '--- %s said:\n%s\n---\n' "$name" "${message:-(nothing)}"
  else
    printf '%-32s %s\n' "$name" "$message"
  fi
}

rm -rf "$work_folder"
mkdir -p "$work_folder"
work_folder=$(realpath "$work_folder")
n_run=0 number=0
for file in "$faults"/*.fault; do
  [ -f "$file" ] || continue
  if [ $((number % n_parts)) -eq "$part" ]; then
    run_fault "$file"
    n_run=$((n_run + 1))
  fi
  number=$((number + 1))
done
echo "$n_run faults run, $n_failures complaints"
[ "$n_run" -gt 0 ] && [ "$n_failures" -eq 0 ]
