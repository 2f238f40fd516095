#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# folder.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# A folder of results: it can be run again where it lies, on its own and over itself; a second run is kept out;
# files of others stay; what a kill has left goes; a changed geometry is noticed when it is resumed; missing
# fields and a full disk are told.
set -euo pipefail
export LC_ALL=C OPENBLAS_NUM_THREADS=1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"
here_work=$PWD

# A scene whose geometry includes its sizes from another folder, with a table; both end with the same name.
mkdir -p scene/lib scene/mine
echo '// sizes' >scene/lib/part.geo
{ echo 'Include "../lib/part.geo";' && cat scene/geometry/cylinder.geo; } >scene/mine/part.geo
printf 'time_s,position_mm\n0,0\n20,5\n' >scene/lib/motion.csv
cat >scene/mine/scene.prm <<'SCENE'
include ../cylinder_coarse.prm
# Mine, with a comment.
subsection Workpiece
  set Geometry file       = part.geo
  set Geometry parameters = Radius = 25, Height = 25, RadialCells = 3, AxialCells = 3
end
subsection Tool upper
  set Geometry file       = ../geometry/platen.geo
end
subsection Time stepping
  set Stroke per step = 0.1
end
subsection Process
  set End stroke = 0.3
end
subsection Output
  set Fields every steps = 1
end
SCENE

# same HISTORY: it is that of the first run.
same() {
  compare first/output/history.csv "$1" -v rel=0
}

name=where_it_lies
run first 0 mine/scene.prm --set "Checkpoint/Every steps = 1"
for file in mine/part.geo lib/part.geo; do
  cmp -s "scene/$file" "first/output/input/$file" || fail "$file is not kept"
done
[ -z "$(find first -name '*.tmp' -o -name '*.lock' -o -name '*.part')" ] || fail "$(find first)"
cp -r first moved
mv scene away
mkdir scene
for file in input parameters; do
  run "again_$file" 0 "$here_work/moved/output/$file.prm"
  same "again_$file/output/history.csv"
done
rmdir scene && mv away scene

name=over_itself
run moved 0 "$here_work/moved/output/input.prm"
same moved/output/history.csv
cmp first/output/input.prm moved/output/input.prm || fail "the scene was written over"

name=scene_in_the_folder
mkdir own
cp -r scene own/output
mv own/output/mine/scene.prm own/output/mine/input.prm
cp own/output/mine/input.prm mine.prm
(cd own/output/mine && "$program" input.prm --quiet --output .) || fail "it has not run"
cmp mine.prm own/output/mine/input.prm || fail "the scene was written over"
cp own/output/mine/history.csv first_history.csv
(cd own/output/mine && "$program" input.prm --quiet --output .) || fail "it has not run again"
cmp mine.prm own/output/mine/input.prm || fail "the scene was written over"
same own/output/mine/history.csv

name=files_of_others
mkdir -p foreign/output
echo "subsection Mine" >foreign/output/input.prm
run foreign 1 mine/scene.prm
grep -qF 'is no folder of results' foreign/stderr || fail "$(cat foreign/stderr)"
[ "$(cat foreign/output/input.prm)" = "subsection Mine" ] || fail "a file of another was written over"
# As are a geometry file and fields where the run would put its own.
for file in input/platen.geo fields/workpiece_00099.vtu; do
  folder=foreign_$(dirname $file)
  mkdir -p "$folder/output/$(dirname $file)"
  echo "// mine" >"$folder/output/$file"
  run "$folder" 1 mine/scene.prm
  grep -qF "has a file \"$file\" and is no folder of results" "$folder/stderr" || fail "$(cat "$folder/stderr")"
  [ "$(cat "$folder/output/$file")" = "// mine" ] || fail "$file of another was written over"
done
mkdir -p table/output
cp scene/lib/motion.csv table/output/history.csv
run table 1 mine/scene.prm --set "Tool upper/Motion/Type = table" \
  --set "Tool upper/Motion/Velocity = 0, 0" --set "Tool upper/Motion/Table file = $here_work/table/output/history.csv"
grep -qF 'would write its results over it' table/stderr || fail "$(cat table/stderr)"
cmp -s scene/lib/motion.csv table/output/history.csv || fail "the table was written over"
for file in mine.vtu workpiece_1.vtu .mine.7.tmp; do echo mine >"moved/output/fields/$file"; done
for file in .workpiece_00001.vtu.77.tmp workpiece_00007.vtu workpiece_00001.vtu.part; do
  echo half >"moved/output/fields/$file"
done
echo half >moved/output/.history.csv.77.tmp
run moved 0 mine/scene.prm --set "Checkpoint/Every steps = 1"
[ "$(cd moved/output/fields && ls -A | tr '\n' ' ')" = ".mine.7.tmp mine.vtu \
tools_00000.vtu tools_00001.vtu tools_00002.vtu tools_00003.vtu \
workpiece_00000.vtu workpiece_00001.vtu workpiece_00002.vtu workpiece_00003.vtu workpiece_1.vtu " ] ||
  fail "$(ls -A moved/output/fields)"
[ ! -e moved/output/.history.csv.77.tmp ] || fail "what a kill has left is still there"

name=in_use
begin_long() { # ARGUMENT...: a run that lasts; sets $pid
  (cd scene && exec "$program" mine/scene.prm --quiet --output "$here_work/long/output" "$@" \
    --set "Time stepping/Stroke per step = 0.0001") >long_out 2>&1 &
  pid=$!
  for _ in $(seq 1200); do
    [ ! -e long/output/history.csv ] || break
    sleep 0.05
  done
}
begin_long
run long 1 mine/scene.prm
grep -qF "is in use by another run (process $pid on" long/stderr || fail "$(cat long/stderr)"
kill -9 "$pid"
wait "$pid" 2>/dev/null || true
run long 0 mine/scene.prm
same long/output/history.csv
[ -z "$(find long -name '.*')" ] || fail "$(find long -name '.*')"

name=changed_geometry
run resumed 0 mine/scene.prm --set "Checkpoint/Every steps = 1"
echo "// nothing that matters to the volume" >>scene/lib/part.geo
run resumed 1 mine/scene.prm --set "Process/End stroke = 0.4" --resume
grep -qF 'Workpiece/Geometry file' resumed/stderr || fail "$(cat resumed/stderr)"
grep -qF 'has changed since' resumed/stderr || fail "$(cat resumed/stderr)"
# From the folder itself, with the copies of then.
run resumed 0 "$here_work/resumed/output/input.prm" --set "Process/End stroke = 0.4" --resume

name=missing_fields
rm resumed/output/fields/workpiece_00002.vtu
run resumed 0 "$here_work/resumed/output/input.prm" --set "Process/End stroke = 0.5" --resume
grep -qF 'Note: 1 file' resumed/stderr || fail "$(cat resumed/stderr)"
! grep -qF workpiece_00002 resumed/output/fields.pvd || fail "the list names a file that is not there"

# A small disk of its own, where that may be made.
name=full_disk
if unshare -m true 2>/dev/null; then
  mkdir -p full small
  got=0
  unshare -m sh -c 'mount -t tmpfs -o size=400k none small && mkdir small/output && cd scene || exit 77
    "$0" cylinder_upsetting.prm --quiet --output ../small/output --set "Output/Fields every steps = 1" \
      --set "Time stepping/Stroke per step = 0.02" --set "Checkpoint/Every steps = 1" "$@" 2>../full/stderr
    got=$?
    ls -A ../small/output >../full/files
    exit $got' "$program" "${coarse[@]}" || got=$?
  if [ "$got" -ne 77 ]; then
    [ "$got" -eq 2 ] || fail "exit status $got instead of 2: $(cat full/stderr)"
    grep -qF 'No space left on device' full/stderr || fail "$(cat full/stderr)"
    [ "$(wc -l <full/stderr)" -eq 1 ] || fail "$(cat full/stderr)"
    grep -qx checkpoint.axi full/files || fail "$(cat full/files full/stderr)"
    ! grep -qE 'tmp$' full/files || fail "$(cat full/files)"
  fi
fi
finish
