#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/setup.sh: installs the packages and builds the program, and runs nothing.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"
ensure_packages "${axiforge_packages[@]}"
ensure_build release axiforge
say "ready: $axiforge_build/release/axiforge"
