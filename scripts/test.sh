#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/test.sh [arguments of ctest]
#
# Installs what is missing, builds everything in Release and the tests labelled "quick" in Debug (with
# deal.II's own assertions), and runs ctest for both, for example
#
#     scripts/test.sh                 all tests
#     scripts/test.sh -R parameter    those with "parameter" in their name
#     scripts/test.sh -L quick        the quick ones
#
# AXIFORGE_SKIP_DEBUG=1 leaves the Debug build out. Ends with 0 only if every test has passed. The tests of one
# build run once at a time: a second call waits for the first.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

ensure_packages "${axiforge_packages[@]}"
ensure_build release
builds=(release)
if [ "${AXIFORGE_SKIP_DEBUG:-0}" != 1 ]; then
  ensure_build debug quick_tests
  builds=(debug release)
fi

failed=0
for build in "${builds[@]}"; do
  selection=()
  [ "$build" = release ] || selection=(-L quick)
  printf '\n== Tests, %s build ==\n' "$build"
  # -j stands first, so that the caller's own wins. The tests have their folders in the build.
  exec 8>"$axiforge_build/$build/.tests.lock"
  flock -n 8 || { say "waiting for the tests that run in $axiforge_build/$build" && flock 8; }
  ctest --test-dir "$axiforge_build/$build" -j 2 --output-on-failure --timeout 600 \
    "${selection[@]}" "$@" 8>&- || failed=1
  exec 8>&-
done
if [ "$failed" -ne 0 ]; then
  printf '\nSome tests have failed, see above.\n'
fi
exit "$failed"
