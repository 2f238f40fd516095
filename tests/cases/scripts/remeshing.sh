#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# remeshing.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# A perfectly plastic cylinder goes to a fifth of its height with remeshing, keeps its volume and does not
# get half way without; and a hardening one with a new mesh every 5 steps gives the same on one rank and on two.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

name=fifth
run fifth 0 upset_to_20_percent.prm --set "Output/Fields = none"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
  NR > 1 { stroke = $column["stroke_mm"]; change = $column["relative_volume_change"]; n = $column["remeshings"]
    if (change < 0) change = -change
    if (change > worst) worst = change }
  END { exit !(stroke > 19.999 && worst < 0.003 && n >= 3) }' fifth/output/history.csv ||
  fail "80 % reduction not reached, the volume not kept to 0.3 %, or no remeshing"

name=without
run without 2 upset_to_20_percent.prm --set "Output/Fields = none" --set "Remeshing/Enabled = false"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { column[$i] = i; if ($i == "remeshings") exit 1 } }
  END { exit !($column["stroke_mm"] < 12.5) }' without/output/history.csv ||
  fail "without remeshing it gets half way, or its history has the columns of remeshing"

scene=(cylinder_upsetting.prm --set "Output/Fields = none" --set "Time stepping/Stroke per step = 0.5"
  --set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 8, AxialCells = 8"
  --set "Remeshing/Enabled = true" --set "Remeshing/Every steps = 5")
shape=force_upper_N,largest_radius_mm,contact_radius_upper_mm,volume_mm3,largest_strain,cells,remeshings
name=one_rank
run one_rank 0 "${scene[@]}"
name=two_ranks
ranks=2 run two_ranks 0 "${scene[@]}"
compare one_rank/output/history.csv two_ranks/output/history.csv -v rel=1e-6 -v only="$shape"

# Cells that are divided and joined between the remeshings.
both=("${scene[@]}" --set "Refinement/Enabled = true" --set "Refinement/Every steps = 4")
name=both_one_rank
run both_one_rank 0 "${both[@]}"
name=both_two_ranks
ranks=2 run both_two_ranks 0 "${both[@]}"
compare both_one_rank/output/history.csv both_two_ranks/output/history.csv -v rel=1e-6 -v only="$shape"

# A real die: a fillet that surface wraps around, a hole that it slides up in, two tools.
name=spike
run spike 0 spike.prm --set "Output/Fields = none"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
  NR > 1 { stroke = $column["stroke_mm"]; change = $column["relative_volume_change"]; n = $column["remeshings"]
    if (change < 0) change = -change
    if (change > worst) worst = change }
  END { exit !(stroke > 29.999 && worst < 1e-3 && n >= 3) }' spike/output/history.csv ||
  fail "the spike is not forged to its end, or its volume not kept to 0.1 %"

finish
