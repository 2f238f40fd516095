#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/benchmark.sh [NAME [ARGUMENT...]]: runs the benchmark NAME of benchmarks/; without a name it lists them.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"
cd "$axiforge_root"

# The first sentence of a benchmark's own description
describe() {
  case $1 in
    *.py) sed -n '/^"""/{s/^"""//;p;q}' "$1" ;;
    *) sed -n '5{s/^# *//;p;q}' "$1" ;;
  esac
}

if [ $# -eq 0 ]; then
  echo "usage: scripts/benchmark.sh NAME [ARGUMENT...]"
  for file in benchmarks/*.sh benchmarks/*.py; do
    [ -e "$file" ] || continue
    name=$(basename "${file%.*}")
    printf '  %-18s %s\n' "$name" "$(describe "$file")"
  done
  exit 0
fi

name=$1
shift
for file in "benchmarks/$name.sh" "benchmarks/$name.py"; do
  [ -e "$file" ] || continue
  # A program of your own choice is measured as it is: no build.
  [ -n "${AXIFORGE:-}" ] || ensure_build release axiforge
  case $file in
    *.sh) exec bash "$file" "$@" ;;
    # matplotlib is in Debian's own python
    *) if [ -x /usr/bin/python3 ]; then exec /usr/bin/python3 "$file" "$@"; else exec python3 "$file" "$@"; fi ;;
  esac
done
echo "There is no benchmark $name; scripts/benchmark.sh lists them." >&2
exit 1
