#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# shipped_scenes.sh PROGRAM PARAMETER_FILES WORK_FOLDER VARIANT
#
# Every scene of parameter_files to its documented end, studies shortened. VARIANT: "own" as it is; "disturbed" with the
# nodes of the first mesh moved by 1e-12 of the size; otherwise a kernel of OpenBLAS (OPENBLAS_CORETYPE). The scenes end as
# they say, and where they are run twice, the figures agree with those of "own" within what another mesh changes.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$1" "$2" "$3"
variant=$4

# Whether the machine can run a kernel.
runs_here() {
  local flags
  flags=$(grep -m1 '^flags' /proc/cpuinfo || true)
  case $1 in
    own | disturbed | Prescott) ;;
    Sandybridge) [[ $flags == *" avx "* ]] ;;
    Haswell | Zen) [[ $flags == *" avx2 "* && $flags == *" fma "* ]] ;;
    SkylakeX) [[ $flags == *" avx512f "* && $flags == *" avx512dq "* && $flags == *" avx512bw "* && $flags == *" avx512vl "* ]] ;;
    *) echo "no such variant: $1" >&2 && exit 1 ;;
  esac
}
if ! runs_here "$variant"; then
  echo "this machine cannot run $variant"
  exit 77
fi

# The end of the stroke (the time), and the power that is put in at 90 % of it.
figures() { # HISTORY
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { if ($i == "stroke_mm") s = i; if ($i == "time_s") t = i
                                                  if ($i == "power_tools_mW") p = i; if ($i == "power_boundaries_mW") q = i }; next }
           { x[NR] = $s > 0 ? $s : $t; y[NR] = $p + $q; last = NR }
           END { for (i = 2; i < last && x[i + 1] < 0.9 * x[last]; i++);
                 w = (0.9 * x[last] - x[i]) / (x[i + 1] - x[i]); printf "%.6g %.6g\n", x[last], y[i] + w * (y[i + 1] - y[i]) }' "$1"
}

kernel() {
  case $variant in
    own) "$@" ;;
    disturbed) AXIFORGE_DISTURB=1e-12 "$@" ;;
    *) OPENBLAS_CORETYPE=$variant "$@" ;;
  esac
}

for file in scene/*.prm; do
  name=$(basename "$file" .prm)
  status=0 stroke=0.001 force=0.001
  command=("$name.prm")
  case $name in
    groove_closing) status=2 stroke=0.02 ;; # where the fold is found
    study_* | ring_calibration)
      # One value of each study, which are scenes of their own kind.
      command=(study "$name.prm" --set "Study/Values = $(sed -n 's/^ *set Values *= *\([^;#]*\).*/\1/p' "$file")"
        --set "Study/Refinement ratio = 0" --set "Study/Reference = ")
      [ "$name" != ring_calibration ] || command+=(--set "Process/End stroke = 0.4")
      ;;
    # With remeshing another mesh comes out where rounding lets gmsh choose one.
    wheel_hub) force=0.04 ;;
    backward_cup | spike | upset_to_20_percent) force=0.03 ;;
  esac
  mkdir -p "$variant/$name"
  kernel run "$variant/$name" "$status" "${command[@]}" --set "Output/Fields = none"
  case $status in
    2) grep -q "The surface folds" "$variant/$name/stderr" || fail "it should end with a fold: $(cat "$variant/$name/stderr")" ;;
  esac
  [ "${command[0]}" != study ] || continue
  history=$(find "$variant/$name/output" -name history.csv | sort | tail -n 1)
  found=$(figures "$history")
  echo "$name: $found"
  # What the scene gives with the machine's own kernel; the folder is made by the variant "own", which runs before.
  if [ "$variant" = own ]; then
    mkdir -p ../shipped_figures
    echo "$found" >"../shipped_figures/$name"
  else
    awk -v a="$found" -v b="$(cat "../shipped_figures/$name")" -v s="$stroke" -v f="$force" 'BEGIN { split(a, x); split(b, y)
      exit !((x[1] / y[1] - 1) ^ 2 <= s ^ 2 && (x[2] / y[2] - 1) ^ 2 <= f ^ 2) }' ||
      fail "end and power at 90 % of it: $found, not $(cat "../shipped_figures/$name") as with the machine's own kernel"
  fi
done
finish
