#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# benchmarks/example_1.sh [PROGRAM] [RUNS]
#
# The paper's first example (cylinder_upsetting.prm: hardening, SMM f' = 0.5) on 18 x 18 cells in 40 steps
# and on 28 x 28 cells in 64 steps, one rank, no fields: CPU seconds of the whole process (start, mesh and
# all) and the shares of the phases, as a Markdown table on standard output. The median of RUNS (5) counts.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
program=${1:-$root/build/release/axiforge}
runs=${2:-5}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

median() {
  sort -g | awk '{ v[NR] = $1 } END { print (NR % 2) ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'
}

printf 'Machine: %s, %s. Date: %s. %s.\n\n' \
  "$(awk -F': ' '/model name/ { print $2; exit }' /proc/cpuinfo)" "$(nproc) cores" "$(date -u +%Y-%m-%d)" \
  "$("$program" --version)"
printf '| cells | steps | iterations | CPU [s], median (least to most) | wall per step [ms] | assembly | contact | factorisation | solve |\n'
printf '|---|---|---|---|---|---|---|---|---|\n'
for case in "18 0.25" "28 0.15625"; do
  read -r cells stroke <<<"$case"
  : >"$folder/cpu"
  for _ in $(seq "$runs"); do
    TIMEFORMAT='%U %S'
    { time "$program" "$root/parameter_files/cylinder_upsetting.prm" --quiet --output "$folder/run" \
      --set "Workpiece/Geometry parameters = RadialCells = $cells, AxialCells = $cells" \
      --set "Time stepping/Stroke per step = $stroke" --set "Output/Fields = none" >"$folder/out"; } 2>"$folder/time"
    awk '{ print $1 + $2 }' "$folder/time" >>"$folder/cpu"
  done
  awk -F, -v cells="$cells" -v cpu="$(median <"$folder/cpu")" \
    -v low="$(sort -g "$folder/cpu" | head -n 1)" -v high="$(sort -g "$folder/cpu" | tail -n 1)" '
    NR == 1 { for (i = 1; i <= NF; ++i) c[$i] = i; next }
    { ++n; it += $c["iterations"]; wall = $c["wall_s"]; a += $c["wall_assembly_s"]; k += $c["wall_contact_s"]
      f += $c["wall_factor_s"]; s += $c["wall_solve_s"] }
    END { printf "| %d x %d | %d | %d | %.2f (%.2f to %.2f) | %.1f | %.0f %% | %.0f %% | %.0f %% | %.0f %% |\n",
          cells, cells, n, it, cpu, low, high, 1e3 * wall / n, 100 * a / wall, 100 * k / wall, 100 * f / wall, 100 * s / wall }
  ' "$folder/run/history.csv"
done
