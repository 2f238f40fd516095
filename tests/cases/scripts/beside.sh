#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# beside.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# Single processes beside each other: a hundred starts, eight at a time, and none fails in MPI or leaves
# anything in the folder for temporary files, which need not even be there. What MPI can't do is not called
# bad input.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"
export OPENBLAS_NUM_THREADS=1
mkdir temporary said

name=hundred_starts
# A scene that is not there: MPI starts, one message is told, status 1.
seq 100 | TMPDIR=$PWD/temporary xargs -P 8 -I{} \
  sh -c '"$0" missing.prm >said/{} 2>&1; echo "status $?" >>said/{}' "$program" || true
for number in $(seq 100); do
  if [ "$(sed -n '$p' "said/$number")" != "status 1" ] || [ "$(wc -l <"said/$number")" -ne 2 ]; then
    fail "start $number: $(head -n 12 "said/$number")"
  fi
done
[ -z "$(ls -A temporary)" ] || fail "there are files: $(find temporary)"

name=no_folder_for_temporary_files
TMPDIR=$PWD/missing run validated 0 cylinder_coarse.prm --validate

name=mpi_fails
# The user's own setting wins, and can't work.
OMPI_MCA_orte_create_session_dirs=1 OMPI_MCA_orte_tmpdir_base=/proc run failed 3 cylinder_coarse.prm --validate
grep -qF 'MPI could not be started' failed/stderr || fail "$(cat failed/stderr)"
finish
