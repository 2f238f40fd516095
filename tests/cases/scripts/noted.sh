#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# noted.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# Doubtful input that may be meant: one line for each, and none for the shipped scenes; what --set and include do to
# lists and names of files; a run outside of its flow-stress table; all entries without a scene.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

# noted NAME TEXT: the run NAME has said one line with the text. quiet NAME: it has none.
noted() {
  [ "$(grep -cF -- "$2" "$1/stdout")" -eq 1 ] || fail "no line, or several, with \"$2\": $(cat "$1/stdout")"
}
quiet() {
  ! grep -E '^(Note|Warning): ' "$1/stdout" || fail "a sound scene is noted"
}
validate() { # NAME ARGUMENT...
  name=$1
  run "$name" 0 "${@:2}" --validate
}

validate sound cylinder_upsetting.prm
quiet sound

validate one_parameter cylinder_upsetting.prm --set "Workpiece/Geometry parameters/RadialCells = 4" \
  --set "Workpiece/Geometry parameters/AxialCells = 3" --set "Tool upper/Geometry parameters/Z = 26"
quiet one_parameter
noted one_parameter 'is sound: 12 cells'
validate dropped cylinder_upsetting.prm --set "Workpiece/Geometry parameters = RadialCells = 4, AxialCells = 3"
noted dropped 'Radius, Height back at the default'

validate idle cylinder_upsetting.prm --set "Remeshing/Element size = 2" --set "Refinement/Every steps = 3"
noted idle 'Section "Remeshing" with "Enabled = false" does nothing, and it is given "Element size"'
noted idle 'Section "Refinement" with "Enabled = false" does nothing'

validate transfinite cylinder_upsetting.prm --set "Workpiece/Element size = 2"
noted transfinite '"Workpiece/Element size" = "2" does nothing'

sed 's/set Law    = smm/# from D:\\friction\\\n    set Law = smm/' scene/cylinder_upsetting.prm >scene/comment.prm
validate comment comment.prm
line=$(grep -nF 'friction\' scene/comment.prm | cut -d: -f1)
noted comment "comment.prm:$line: The comment ends in a backslash"
run comment_print 0 comment.prm --print-parameters
grep -qE '^ *set Law  *= smm' comment_print/stdout || fail "the comment has swallowed the line"

# A scene in another folder: its files lie beside the one that names them. The copy of the input says the same.
mkdir -p scene/others scene/common
cp -r scene/geometry scene/common/
sed 's/^  set Geometry file  .*cylinder.geo/  set Geometry file = "geometry\/my cylinder.geo"/' scene/cylinder_upsetting.prm >scene/common/base.prm
mv scene/common/geometry/cylinder.geo "scene/common/geometry/my cylinder.geo"
printf 'include ../common/base.prm\nsubsection Process\n  set End stroke = 0.25\nend\n' >scene/others/own.prm
name=included
run included 0 others/own.prm --set "Workpiece/Geometry parameters/RadialCells = 4" \
  --set "Workpiece/Geometry parameters/AxialCells = 4"
quiet included
name=input
run input 0 "$PWD/included/output/input.prm"
compare included/output/history.csv input/output/history.csv -v rel=0

name=range
printf 'strain,0.001,0.01,0.1\n0,50,60,70\n0.1,60,72,85\n0.2,62,75,90\n' >scene/flow.csv
cat >scene/range.prm <<'SCENE'
set Tools = upper
subsection Workpiece
  set Geometry file = geometry/cylinder.geo
  set Geometry parameters = Radius = 10, Height = 10, RadialCells = 4, AxialCells = 4
end
subsection Material
  set Model = table
  set Table file = flow.csv
end
subsection Tool upper
  set Geometry file = geometry/platen.geo
  set Geometry parameters = Z = 10
  subsection Motion
    set Type = constant velocity
    set Velocity = 0, -100
  end
end
subsection Process
  set End stroke = 5
end
subsection Time stepping
  set Stroke per step = 0.5
end
SCENE
run range 0 range.prm
# Uniform: rates 100/9.75 to 100/5.25, strain ln 2.
noted range '100 % of the plastic work was done outside of the table'
noted range 'strains up to 0.2 and rates from 0.001 to 0.1 1/s'
noted range 'the workpiece has strains up to 0.69'
noted range 'rates from 10.26 to 19.05 1/s'
name=inside
run inside 0 range.prm --set "Tool upper/Motion/Velocity = 0, -0.2" --set "Process/End stroke = 1.5"
quiet inside

name=all_entries
mkdir -p all_entries
"$program" --print-parameters >all_entries/stdout 2>all_entries/stderr || fail "exit status $?"
for section in Workpiece Material 'Tool NAME' 'Boundary NAME' 'Region NAME' 'Gauge NAME' Process Study; do
  grep -qx "subsection $section" all_entries/stdout || fail "no section $section"
done

finish
