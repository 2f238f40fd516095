#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/check_format.sh [--fix]: are all C++ files as clang-format 14 writes them? --fix rewrites them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

formatter=
for name in clang-format-14 clang-format; do
  if command -v "$name" >/dev/null && "$name" --version | grep -q 'version 14\.'; then
    formatter=$name
    break
  fi
done
if [ -z "$formatter" ]; then
  echo "clang-format 14 is not installed: apt-get install clang-format-14" >&2
  exit 1
fi

# The files git knows of; without git all there are.
if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  list() { git ls-files -z -- 'include/*.h' 'source/*.h' 'source/*.cc' 'tests/*.h' 'tests/*.cc'; }
else
  list() { find include source tests \( -name '*.h' -o -name '*.cc' \) -print0; }
fi
mapfile -d '' files < <(list)
existing=()
for file in "${files[@]}"; do
  [ ! -f "$file" ] || existing+=("$file")
done
if [ ${#existing[@]} -eq 0 ]; then
  echo "No C++ files found." >&2
  exit 1
fi

if [ "${1-}" = --fix ]; then
  "$formatter" -i "${existing[@]}"
else
  wrong=$("$formatter" --dry-run "${existing[@]}" 2>&1 | sed -n 's/^\([^ :]*\):.*-Wclang-format-violations.*/\1/p' |
    sort | uniq -c || true)
  if [ -n "$wrong" ]; then
    printf 'Not as clang-format 14 writes them (number of places, file):\n%s\n' "$wrong" >&2
    echo "Run scripts/check_format.sh --fix." >&2
    exit 1
  fi
fi
echo "${#existing[@]} files, format checked."
