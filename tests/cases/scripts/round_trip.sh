#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# round_trip.sh PROGRAM PARAMETER_FILES WORK_FOLDER
#
# What the program says about itself and about a scene, and that the parameters it keeps beside the results
# are the whole scene: run again they give the same history, number by number.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
. "$here/../../case_functions.sh"
. "$here/functions.sh"
begin "$@"

name=version
run version 0 --version
grep -qE '^axiforge [0-9]+\.[0-9]+\.[0-9]+ \(revision .+\)$' version/stdout ||
  fail "not a version: $(cat version/stdout)"

name=help
run help 0 --help
for option in FILE.prm --set --output --validate --print-parameters --version 'Exit status'; do
  grep -qF -- "$option" help/stdout || fail "it has not told of $option"
done

name=validate
run validate 0 cylinder_upsetting.prm --validate "${coarse[@]}"
grep -qF 'is sound: 25 cells' validate/stdout || fail "$(cat validate/stdout)"
no_files validate

name=print_parameters
run print 0 cylinder_upsetting.prm --print-parameters "${coarse[@]}"
no_files print

name=round_trip
run first 0 cylinder_upsetting.prm "${coarse[@]}"
# The files that the scene names are kept in input/; blanks align the comments.
plain() {
  sed -E 's,input/(cylinder|platen)\.geo,geometry/\1.geo,; s/ +/ /g' "$1"
}
plain first/output/parameters.prm | cmp - <(plain print/stdout) || fail "parameters.prm is not what is printed"
run again 0 "$PWD/first/output/parameters.prm"
plain first/output/parameters.prm | cmp - <(plain again/output/parameters.prm) ||
  fail "the parameters have changed on their way through the program"
compare first/output/history.csv again/output/history.csv -v rel=0
run input 0 "$PWD/first/output/input.prm"
compare first/output/history.csv input/output/history.csv -v rel=0

finish
