#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# study.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# `axiforge study`: over meshes with a single velocity solve, with a reference and the order that theory asks
# for, with a run that fails, with faults in the section, on two ranks.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

# check FOLDER CONDITION: an awk condition on study.csv; v(row, "column") is a number in it.
check() {
  local file=$1/output/study.csv
  if [ ! -s "$file" ]; then
    fail "$file is missing"
    return
  fi
  # A field in quotes may hold commas: they are taken out.
  awk -F, 'function v(row, name) { return value[row, column[name]] + 0 }
    { line = ""; n = split($0, part, "\"")
      for (i = 1; i <= n; ++i) { if (i % 2 == 0) gsub(",", " ", part[i]); line = line part[i] }
      $0 = line }
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i }
    NR > 1 { for (i = 1; i <= NF; ++i) value[NR - 1, i] = $i }
    END { rows = NR - 1; exit !('"$2"') }' "$file" || fail "$file: not true: $2"
}
study_files() {
  local file
  for file in study.csv study.md study.svg; do
    [ -s "$1/output/$file" ] || fail "there is no $1/output/$file"
  done
}

cells='Study/Entry = Workpiece/Geometry parameters/RadialCells; Workpiece/Geometry parameters/AxialCells'
single=(study cylinder_upsetting.prm --set "$cells" --set "Study/Values = 4; 8; 16"
  --set "Study/Refinement ratio = 2" --set "Study/Single velocity solve = true"
  --set "Output/Fields = none")

# One solve on three meshes: the force falls to its limit (the meshes are nested), which is less than what
# uniform stress and sticking in the full friction would need.
name=single_solve
run single 0 "${single[@]}"
study_files single
check single 'rows == 3 && v(1, "cells") == 16 && v(2, "cells") == 64 && v(3, "cells") == 256'
check single 'v(1, "steps") == 1 && v(3, "steps") == 1 && v(3, "unknowns") == 2 * 33 * 33'
check single 'v(1, "force_upper_N") > v(2, "force_upper_N") && v(2, "force_upper_N") > v(3, "force_upper_N")'
check single 'v(3, "force_upper_N_order") > 0.5 && v(3, "force_upper_N_limit") < v(3, "force_upper_N")'
check single 'v(3, "force_upper_N_difference") == v(3, "force_upper_N") - v(2, "force_upper_N")'
check single 'v(3, "cpu_s") > 0 && v(3, "wall_s") > 0'
for i in 1 2 3; do
  [ "$(wc -l <single/output/run_$i/history.csv)" -eq 2 ] || fail "run_$i should have one step"
done
grep -q 'observed order' single/stdout || fail "the screen does not tell the order"
if command -v python3 >/dev/null; then
  python3 -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' \
    single/output/study.svg || fail "study.svg is no XML"
fi

name=two_ranks
ranks=2 run two_ranks 0 "${single[@]}"
check two_ranks 'rows == 3'
for column in force_upper_N largest_radius_mm; do
  compare single/output/study.csv two_ranks/output/study.csv -v rel=1e-7 -v only="$column"
done

# The exact pressure of the tube, C/(sqrt(3) n) (2 c/sqrt(3))^n (a^-2n - b^-2n). Velocities of order 3 in
# the energy norm: order 4 in the power.
name=tube
exact=$(awk 'BEGIN { n = 0.2; c = 10; s = sqrt(3)
  printf "%.12g", 100 / (s * n) * (2 * c / s)^n * (10^(-2 * n) - 20^(-2 * n)) }')
run tube 0 study tube_expansion.prm --set "Study/Entry = refinement" --set "Study/Values = 0; 1; 2" \
  --set "Workpiece/Geometry parameters = InnerRadius = 10, OuterRadius = 20, Height = 5, RadialCells = 4, AxialCells = 2" \
  --set "Study/Refinement ratio = 2" --set "Study/Single velocity solve = true" \
  --set "Study/Quantities = pressure_inner_MPa" --set "Study/Reference = $exact" \
  --set "Flow solver/Tolerance = 1e-11" --set "Flow solver/Regularisation = 1e-6" \
  --set "Flow solver/Penalty = 1e9"
study_files tube
check tube 'v(3, "pressure_inner_MPa_error") < 1e-6 && v(3, "pressure_inner_MPa_error") > -1e-6'
for row in 2 3; do
  check tube "v($row, \"pressure_inner_MPa_error_order\") > 3.7 && v($row, \"pressure_inner_MPa_error_order\") < 4.3"
done
check tube 'v(3, "pressure_inner_MPa_order") > 3.7 && v(3, "pressure_inner_MPa_order") < 4.3'

# Factor 2 is not allowed, 0.5 and 0.9 are: two runs and a reason.
name=goes_on
run goes_on 0 study cylinder_upsetting.prm "${coarse[@]}" --set "Study/Entry = Tool upper/Friction/Factor" \
  --set "Study/Values = 0.5; 2; 0.9" --set "Study/At = all" --set "Output/Fields = none"
check goes_on 'rows == 3 && v(1, "steps") == 4 && v(2, "steps") == 0 && v(3, "steps") == 4'
check goes_on 'v(1, "force_upper_N_rms") > 0 && v(3, "force_upper_N_rms") == 0'
grep -q '^2,2,.*Tool upper/Friction/Factor' goes_on/output/study.csv || fail "the reason is not in study.csv"
grep -q 'Run 2 (2) failed' goes_on/stdout || fail "the screen does not tell the failure"
[ -s goes_on/output/run_3/history.csv ] || fail "the study has stopped at the failure"

name=all_fail
run all_fail 2 study cylinder_upsetting.prm "${coarse[@]}" --set "Study/Entry = Flow solver/Most iterations" \
  --set "Study/Values = 1" --set "Output/Fields = none"
grep -q 'None of the runs' all_fail/stderr || fail "the message does not say that all runs failed"

# fault NAME TEXT ARGUMENT...: status 1, one line with the text, no files.
fault() {
  name=$1
  run "$1" 1 study cylinder_upsetting.prm "${@:3}"
  grep -qF -- "$2" "$1/stderr" || fail "the message does not have \"$2\": $(cat "$1/stderr")"
  [ "$(wc -l <"$1/stderr")" -eq 1 ] || fail "the message should have one line: $(cat "$1/stderr")"
  no_files "$1"
}
values=(--set "Study/Entry = refinement" --set "Study/Values = 0; 1")
fault no_section 'Entry "Study/Entry" = "": the scene has no study'
fault no_values 'Entry "Study/Values" = "": there are no values' --set "Study/Entry = refinement"
fault unknown_entry 'Did you mean "Factor"?' --set "Study/Entry = Tool upper/Friction/Factr" \
  --set "Study/Values = 0.1; 0.2"
fault comma_for_semicolon 'separated by ";"' --set "Study/Entry = Time stepping/Largest reduction per step" \
  --set "Study/Values = 0.1, 0.2"
fault comma_in_geometry 'separated by ";"' --set "Study/Entry = Workpiece/Geometry parameters/Radius" \
  --set "Study/Values = 20, 22"
fault validated '1 of 2 runs' --validate --set "Study/Entry = Tool upper/Friction/Factor" \
  --set "Study/Values = 0.5; 2"
fault unknown_column '"largest_radius_mm"' "${values[@]}" --set "Study/Quantities = force_lower_N"
fault unit_forgotten 'Did you mean "force_upper_N"?' "${values[@]}" --set "Study/Quantities = force_upper"
fault too_many_references '2 references for 1 quantities' "${values[@]}" \
  --set "Study/Quantities = force_upper_N" --set "Study/Reference = 1, 2"

name=validate
run validate 0 study cylinder_upsetting.prm "${coarse[@]}" "${values[@]}" --validate
[ "$(grep -c 'sound$' validate/stdout)" -eq 2 ] || fail "not both values are called sound: $(cat validate/stdout)"
no_files validate

# A billet drawn elsewhere is put in its place before tools and workpiece are compared.
name=placed
run placed 0 study punch_indentation.prm --validate --set "Placement/Rest on = lower" \
  --set "Tool lower/Geometry parameters = Z = 5" --set "Tool punch/Start = touching" \
  --set "Study/Entry = Tool punch/Motion/Velocity" --set "Study/Values = 0, -1; 0, -2"

name=no_scene
run no_scene 1 study
grep -q 'FILE.prm' no_scene/stderr || fail "the message does not ask for the scene"

# A run by itself does not look at the section.
name=ignored
run ignored 0 cylinder_upsetting.prm "${coarse[@]}" --set "Study/Entry = no such thing"
finish
