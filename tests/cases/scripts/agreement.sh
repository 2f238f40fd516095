#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# agreement.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# Ways to the same answer: example 1 with CHOLMOD and with MUMPS on one rank and on two, and with the platen
# as a polyline. The run goes on until surface of the side has folded on to the platen, where the contact set
# changes.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

scene=(cylinder_upsetting.prm --set "Output/Fields = none" --set "Time stepping/Stroke per step = 0.5"
  --set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 10, AxialCells = 10")
shape=force_upper_N,largest_radius_mm,contact_radius_upper_mm,volume_mm3,largest_strain

name=cholmod
run cholmod 0 "${scene[@]}"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
  NR == 2 { first = $column["contact_radius_upper_mm"] }
  NR > 1 { last = $column["contact_radius_upper_mm"] }
  END { exit !(last > first + 2) }' cholmod/output/history.csv ||
  fail "the side has not folded on to the platen: the scene is too easy for this test"

name=mumps
run mumps 0 "${scene[@]}" --set "Flow solver/Linear solver = mumps"
compare cholmod/output/history.csv mumps/output/history.csv -v rel=1e-6 -v only="$shape"

name=two_ranks
ranks=2 run two_ranks 0 "${scene[@]}"
compare cholmod/output/history.csv two_ranks/output/history.csv -v rel=1e-6 -v only="$shape"

name=two_ranks_mumps
ranks=2 run two_ranks_mumps 0 "${scene[@]}" --set "Flow solver/Linear solver = mumps"
compare cholmod/output/history.csv two_ranks_mumps/output/history.csv -v rel=1e-6 -v only="$shape"

# A short first step, where MUMPS with pivoting filled in more than it had room for.
short=(--set "Output/Fields = none" --set "Time stepping/Stroke per step = 0.01" --set "Process/End stroke = 0.01"
  --set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 25, AxialCells = 25")
name=short_step
run short_one 0 cylinder_upsetting.prm "${short[@]}"
ranks=2 run short_two 0 cylinder_upsetting.prm "${short[@]}" --set "Flow solver/Linear solver = mumps"
compare short_one/output/history.csv short_two/output/history.csv -v rel=1e-6 -v only=force_upper_N,repeats

# Cells divided and joined on the way, with hanging nodes.
adaptive=(--set "Refinement/Enabled = true" --set "Refinement/Start cycles = 2" --set "Refinement/Every steps = 3"
  --set "Refinement/Coarsen fraction = 0.05")
name=adaptive
run adaptive_one 0 "${scene[@]}" "${adaptive[@]}"
ranks=2 run adaptive_two 0 "${scene[@]}" "${adaptive[@]}"
compare adaptive_one/output/history.csv adaptive_two/output/history.csv -v rel=1e-6 -v only="$shape,cells"
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i } END { exit !($column["cells"] > 100) }' \
  adaptive_one/output/history.csv || fail "no cell has been divided"

# The points stand where no corner of the workpiece meets them.
name=polyline
printf '# The platen of platen.geo.\nr_mm, z_mm\n0, 25\n70, 25\n200, 25\n' >scene/platen.csv
run polyline 0 "${scene[@]}" --set "Tool upper/Geometry file = platen.csv" \
  --set "Tool upper/Geometry parameters ="
compare cholmod/output/history.csv polyline/output/history.csv -v rel=1e-9 -v only="$shape"

finish
