#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/sanitize.sh [FILE.prm [arguments]]
#
# Builds the program in Debug with the address and undefined-behaviour sanitizers (build/sanitize) and runs a
# scene: the one given, or a few short ones. Ends with 0 if nothing is found. The first build takes some
# minutes, the short scenes less than one.
#
# Leaks of OpenMPI and its libraries are left out by tests/lsan.supp.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

ensure_packages "${axiforge_packages[@]}"
folder=$axiforge_build/sanitize
mkdir -p "$folder"
[ -f "$folder/build.ninja" ] ||
  run_logged "$folder/configure.log" "the configuration" cmake -G Ninja -S "$axiforge_root" \
    -B "$folder" -DCMAKE_BUILD_TYPE=Debug -DAXIFORGE_SANITIZE=ON -DAXIFORGE_BUILD_TESTS=OFF
run_logged "$folder/build.log" "the build with sanitizers" \
  ninja_announced "Debug, sanitizers" "$folder" axiforge 3>&2

# OpenMPI unloads its modules at the end, and their leaks would have no name to leave them out by: a dlclose
# that does nothing keeps them. Slow unwinding names what a library's C library calls belong to.
printf 'int dlclose(void *handle) { (void)handle; return 0; }\n' |
  cc -shared -fPIC -x c - -o "$folder/keep_modules.so"
export ASAN_OPTIONS="verify_asan_link_order=0:fast_unwind_on_malloc=0:detect_stack_use_after_return=1"
export LSAN_OPTIONS="suppressions=$axiforge_root/tests/lsan.supp:print_suppressions=0"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"

run() { # WHAT ARGUMENT...
  local what=$1
  shift
  say "$what"
  LD_PRELOAD=$folder/keep_modules.so "$folder/axiforge" "$@" || { say "$what: failed" && exit 1; }
}

if [ $# -gt 0 ]; then
  run "$1" "$@"
  exit 0
fi

results=$folder/results
scene=$axiforge_root/parameter_files/cylinder_upsetting.prm
few=(--set "Workpiece/Geometry parameters = Radius = 25, Height = 25, RadialCells = 4, AxialCells = 4"
  --set "Process/End stroke = 2.5" --set "Time stepping/Stroke per step = 0.5")
run "cylinder, Newton, iterated penalty, SMM friction" "$scene" --output "$results/newton" "${few[@]}"
run "cylinder, Picard, plain penalty, MUMPS" "$scene" --output "$results/picard" "${few[@]}" \
  --set "Process/End stroke = 1" --set "Flow solver/Incompressibility = penalty" \
  --set "Flow solver/Penalty = 1e5" --set "Flow solver/Iteration = picard" \
  --set "Flow solver/Most iterations = 500" --set "Flow solver/Linear solver = mumps"
for law in coulomb shear arctan "tangential forces" sticking none; do
  own=(--set "Tool upper/Friction/Law = $law" --set "Tool upper/Friction/Factor = 0")
  case $law in
    coulomb) own+=(--set "Tool upper/Friction/Coefficient = 0.1") ;;
    shear | arctan | "tangential forces") own+=(--set "Tool upper/Friction/Factor = 0.3") ;;
  esac
  run "cylinder, $law" "$scene" --quiet --output "$results/friction" "${few[@]}" \
    --set "Process/End stroke = 1" "${own[@]}"
done
say "nothing found"
