#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# benchmarks/hub.sh [PROGRAM] [RUNS]
#
# The third operation of parameter_files/wheel_hub.prm, the paper's second example: CPU seconds in total and of each step,
# beside the paper's time. One rank, with the fields that the scene writes. What the third operation takes is what the chain
# takes more than the chain without it; the median of RUNS (3) counts. Writes benchmarks/results/hub.csv and hub.md.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=${1:-${AXIFORGE:-$root/build/release/axiforge}}
runs=${2:-3}
results=$root/benchmarks/results
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}
mkdir -p "$results"

# The scene without its last operation.
ln -s "$root/parameter_files/geometry" "$folder/geometry"
awk '/^subsection Operation finish/ { skip = 1 }
     !skip { sub(/^set Operations.*/, "set Operations = upset, block"); print }
     /^end/ { skip = 0 }' "$root/parameter_files/wheel_hub.prm" >"$folder/two.prm"
cp "$root/parameter_files/wheel_hub.prm" "$folder/three.prm"

for run in $(seq "$runs"); do
  for scene in two three; do
    rm -rf "$folder/$scene"
    "$program" "$folder/$scene.prm" --quiet --timing --output "$folder/$scene" >"$folder/$scene.$run" 2>&1 ||
      { cat "$folder/$scene.$run" >&2; exit 1; }
  done
done

# Seconds of a phase, summed over its places in the table; column 4 is wall, 5 is CPU time.
phase() { # FILE COLUMN NAME
  awk -F'|' -v column="$2" -v name="$3" '
    { text = $2; gsub(/^ +| +$/, "", text); if (text == name) sum += $column } END { print sum + 0 }' "$1"
}
median() { sort -g | awk '{ v[NR] = $1 } END { print (NR % 2) ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'; }
third() { # COLUMN NAME: of the third operation
  for run in $(seq "$runs"); do
    echo "$(phase "$folder/three.$run" "$1" "$2") $(phase "$folder/two.$run" "$1" "$2")" | awk '{ print $1 - $2 }'
  done | median
}

echo "phase,cpu_s,wall_s" >"$results/hub.csv"
for name in "whole run" "flow solver" "forces of the cells" "assembly" "factorisation" "triangular solves" "remeshing" "gmsh" \
  "transfer" "fields"; do
  echo "$name,$(third 5 "$name"),$(third 4 "$name")" >>"$results/hub.csv"
done

{
  printf '# The third operation of the hub\n\nMade by `benchmarks/hub.sh`, median of %s runs. Machine: %s, %s cores. Date: %s. %s. Load of the machine while measuring: %s.\n\n' \
    "$runs" "$(awk -F': ' '/model name/ { print $2; exit }' /proc/cpuinfo)" "$(nproc)" "$(date -u +%Y-%m-%d)" \
    "$("$program" --version)" "$(awk '{ print $2 }' /proc/loadavg)"
  awk -F, -v cpu="$(third 5 "whole run")" -v solver="$(third 5 "flow solver")" '
    NR == 1 { for (i = 1; i <= NF; ++i) c[$i] = i; next }
    NR == 2 { first = $c["cells"]; before = $c["remeshings"] }
    { ++n; it += $c["iterations"]; cells = $c["cells"]; remeshings = $c["remeshings"]; stroke = $c["stroke_mm"] }
    END {
      printf "| | cells | steps | remeshings | iterations | CPU, total [s] | for each step [ms] | flow solver, for each step [ms] |\n|---|---|---|---|---|---|---|---|\n"
      printf "| here | %d to %d | %d | %d | %d | %.1f | %.0f | %.0f |\n", first, cells, n, remeshings - before, it, cpu, 1e3 * cpu / n, 1e3 * solver / n
      printf "| the paper | 724 to 940 | 64 | 2 | | 19,800 (5 h 30 min, HP 735) | 309,000 | |\n"
    }' "$folder/three/3_finish/history.csv"
  printf '\nWhere the time of the third operation goes:\n\n| phase | CPU [s] | wall [s] |\n|---|---|---|\n'
  awk -F, 'NR > 1 { printf "| %s | %.2f | %.2f |\n", $1, $2, $3 }' "$results/hub.csv"
} | tee "$results/hub.md"
