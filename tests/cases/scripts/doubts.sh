#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# doubts.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# What is allowed but doubtful is told in a note, by --validate as well; runs that form nothing or stop before
# their end are no results: status 2.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

# noted NAME TEXT ARGUMENT...: sound for --validate, with a note that has the text.
noted() {
  name=$1
  run "$1" 0 "${@:3}" --validate
  grep -q "^Note: .*$2" "$1/stdout" || fail "no note with \"$2\": $(cat "$1/stdout")"
  no_files "$1"
}
noted unused_curve 'physical curve "outer"' tube_expansion.prm
noted in_metres 'Lengths are in mm' cylinder_upsetting.prm \
  --set "Workpiece/Geometry parameters = Radius = 0.025, Height = 0.025, RadialCells = 5, AxialCells = 5" \
  --set "Tool upper/Geometry parameters = Z = 0.025, Radius = 0.1" --set "Process/End stroke = 0.005" \
  --set "Tool upper/Motion/Velocity = 0, -0.001" --set "Time stepping/Stroke per step = 0.001"
noted half_model 'gauge "belly" measures half way up' cylinder_upsetting.prm --set "Gauges = belly" \
  --set "Gauge belly/Measure = outer radius" --set "Gauge belly/At = middle"

# The axis of a drawing that is 1e-6 mm off, on either side, and a symmetry line as crooked.
name=noise
cat >scene/noise.geo <<'END'
DefineConstant[ Off = {1e-6, Name "Off"} ];
Point(1) = {Off, Off, 0}; Point(2) = {10, 0, 0}; Point(3) = {10, 10, 0}; Point(4) = {0, 10, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1:4} = 5; Transfinite Surface{1}; Recombine Surface{1};
Physical Surface("workpiece") = {1}; Physical Curve("symmetry") = {1};
END
noise=(cylinder_upsetting.prm --set "Workpiece/Geometry file = noise.geo" --set "Tool upper/Geometry parameters = Z = 10"
  --set "Tool upper/Friction/Law = sticking" --set "Tool upper/Friction/Factor = 0" --set "Process/End stroke = 3"
  --set "Output/Fields = none")
for off in 0 1e-6 -1e-7; do
  run "noise_$off" 0 "${noise[@]}" --set "Workpiece/Geometry parameters = Off = $off"
  [ "$off" = 0 ] || grep -q '^Note: the axis of the workpiece is drawn up to' "noise_$off/stdout" ||
    fail "the axis is moved without a word"
  compare noise_0/output/history.csv "noise_$off/output/history.csv" -v rel=1e-5 -v only=force_upper_N,height_mm
done

# A punch pushes a billet through a container whose bottom was forgotten: what friction there could hold has
# no pressure to act with.
cat >scene/container.prm <<'END'
set Tools = punch, container
subsection Workpiece
  set Geometry file = geometry/billet.geo
  set Geometry parameters = Radius = 20, Height = 25, CellSize = 5
end
subsection Material
  set Model        = perfectly plastic
  set Yield stress = 100
end
subsection Tool punch
  set Geometry file       = geometry/platen.geo
  set Geometry parameters = Z = 25
  subsection Motion
    set Type     = constant velocity
    set Velocity = 0, -1
  end
end
subsection Tool container
  set Geometry file       = geometry/container.geo
  set Geometry parameters = Radius = 20, Height = 80, Z = -40
  subsection Friction
    set Law         = coulomb
    set Coefficient = 0.1
  end
end
subsection Process
  set End stroke = 1
end
END
noted carried 'friction at tool "container"' container.prm
run carried 2 container.prm --set "Time stepping/Stroke per step = 0.5"
grep -qE 'Nothing has been formed|nothing holds the workpiece' carried/stderr || fail "$(cat carried/stderr)"

name=most_steps
run short 2 cylinder_upsetting.prm "${coarse[@]}" --set "Time stepping/Most steps = 2"
grep -qF 'The run has stopped after 2 steps ("Time stepping/Most steps" = 2)' short/stderr || fail "$(cat short/stderr)"
grep -qF -- '--resume continues there' short/stderr || fail "$(cat short/stderr)"
run short 0 cylinder_upsetting.prm "${coarse[@]}" --resume
run whole 0 cylinder_upsetting.prm "${coarse[@]}"
compare whole/output/history.csv short/output/history.csv -v rel=0
name=resumed_beyond_the_end
run beyond 2 cylinder_upsetting.prm "${coarse[@]}" --set "Time stepping/Most steps = 2"
cp beyond/output/history.csv beyond/before.csv
run beyond 1 cylinder_upsetting.prm "${coarse[@]}" --set "Process/End stroke = 0.1" --resume
grep -qF 'beyond the end of the operation' beyond/stderr || fail "$(cat beyond/stderr)"
cmp beyond/before.csv beyond/output/history.csv || fail "the results have been touched"

# Half of the height in one step: nodes go straight, the volume does not.
name=volume
run volume 0 cylinder_upsetting.prm "${coarse[@]}" --set "Process/End stroke = 10" --set "Time stepping/Stroke per step = 10"
grep -qE 'the volume has changed by -?[0-9.]+ %' volume/stdout || fail "$(cat volume/stdout)"
! grep -qF 'the volume has changed' short/stdout || fail "$(cat short/stdout)"

# A billet of the radius of its die rests in the fillet that leads from the wall to the cone.
name=rests
cat >scene/extrusion_die.geo <<'END'
Include "geometry/rounded_chain.geo";
chain_r[] = {20, 20, 12, 12, 12.5, 12.5};
chain_z[] = {60, 0, -8, -11, -12, -80};
chain_f[] = {0, 4, 2, 0.3, 0.3, 0};
Call RoundedChain;
Physical Curve("tool") = chain_curves[];
END
sed -e 's|container.geo|extrusion_die.geo|' -e 's|geometry/extrusion|extrusion|' \
  -e 's|set Geometry parameters = Radius = 20, Height = 80, Z = -40||' scene/container.prm >scene/extrusion.prm
run rests 0 extrusion.prm --set "Placement/Rest on = container" --set "Tool punch/Start = touching" \
  --set "Workpiece/Geometry parameters = Radius = 20, Height = 40, CellSize = 4"
finish
