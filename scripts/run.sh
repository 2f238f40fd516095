#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# scripts/run.sh [-np N] [FILE.prm] [arguments of axiforge]
#
# Installs, configures and builds what is missing, then runs axiforge with FILE.prm (default:
# parameter_files/cylinder_upsetting.prm) and passes the arguments on. -np N, or AXIFORGE_RANKS=N, runs
# it on N ranks. The exit status is the program's: 0 done, 1 bad input, 2 the computation could not go
# on, 3 anything else.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

ranks=${AXIFORGE_RANKS:-1}
if [ "${1-}" = -np ]; then
  ranks=${2-}
  shift $(($# < 2 ? $# : 2))
fi
if ! [[ $ranks =~ ^[1-9][0-9]*$ ]]; then
  say "the number of ranks (-np N or AXIFORGE_RANKS) is \"$ranks\"; it must be a whole number from 1."
  exit 1
fi

# The scene stands first, or there is none.
case ${1-} in
  '' | -*) scene=$axiforge_root/parameter_files/cylinder_upsetting.prm ;;
  *)
    scene=$1
    shift
    ;;
esac

ensure_packages "${axiforge_packages[@]}"
ensure_build release axiforge

program=$axiforge_build/release/axiforge
if [ "$ranks" -eq 1 ]; then
  exec "$program" "$scene" "$@"
fi
exec mpirun --oversubscribe -np "$ranks" "$program" "$scene" "$@"
