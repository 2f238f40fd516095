#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/stress.sh [GROUP ...] [--short] [--output FOLDER]: stress tests of numerical stability.
#
# Groups: penalty scaling invariance friction material steps shapes random_scenes industrial; default all of
# them, about an hour of CPU time on one core. Tables go to benchmarks/results/stress; with --short, which takes a
# minute, nothing is written. doc/stability.md says what came out.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"
ensure_packages "${axiforge_packages[@]}" python3
ensure_build release axiforge
exec python3 "$axiforge_root/benchmarks/stress/stress.py" "$axiforge_build/release/axiforge" "$@"
