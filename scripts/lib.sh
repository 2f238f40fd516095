# SPDX-License-Identifier: GPL-2.0-or-later
# What run.sh, test.sh and .ci/run share: packages, builds, messages. To be sourced by bash.
# After it: $axiforge_root (the folder of the sources) and the functions below.

axiforge_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
axiforge_build=${AXIFORGE_BUILD_DIR:-$axiforge_root/build}

# The packages axiforge needs on Debian 12: the only list there is. The BLAS is named because
# deal.II alone brings the reference one, with which the factorisation is four times slower.
axiforge_packages=(
  libdeal.ii-dev libopenblas0-pthread libsuitesparse-dev libgmsh-dev openmpi-bin
  libcli11-dev libfmt-dev libgtest-dev libeigen3-dev nlohmann-json3-dev
  cmake ninja-build g++ ccache
)

# OpenMPI refuses to start as root (containers) unless told so.
if [ "$(id -u)" -eq 0 ]; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi
# One BLAS thread per rank: the fronts are too small to gain from more.
export OPENBLAS_NUM_THREADS=${OPENBLAS_NUM_THREADS:-1}

say() { # TEXT...: to the terminal, apart from the program's own output
  printf 'axiforge set-up: %s\n' "$*" >&2
}

# run_logged LOG WHAT COMMAND...: silent; if it fails, WHAT and the end of the log are shown.
run_logged() {
  local log=$1 what=$2 status=0
  shift 2
  mkdir -p "$(dirname "$log")"
  "$@" >"$log" 2>&1 || status=$?
  if [ "$status" -ne 0 ]; then
    say "$what failed:"
    tail -n 40 "$log" >&2
    say "the whole log is in $log"
  fi
  return "$status"
}

# ensure_packages NAME...: installs those that are missing, or says how to and ends the script.
ensure_packages() {
  local name missing=() as_root=()
  # No Debian: the packages are the user's business, and CMake says what it misses.
  command -v dpkg-query >/dev/null || return 0
  local installed
  installed=$(dpkg-query -W -f='${db:Status-Abbrev} ${Package}\n' "$@" 2>/dev/null |
    sed -n 's/^ii  *//p' || true)
  for name in "$@"; do
    grep -qxF -- "$name" <<<"$installed" || missing+=("$name")
  done
  [ ${#missing[@]} -gt 0 ] || return 0

  local command="apt-get install -y --no-install-recommends ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
      as_root=(sudo -n)
    else
      say "these packages are missing, and only root can install them. Please run"
      printf '  sudo apt-get update && sudo %s\n' "$command" >&2
      say "and start this script again."
      exit 1
    fi
  fi
  say "installing ${missing[*]}"
  local log=${TMPDIR:-/tmp}/axiforge-apt-$(id -u).log
  if ! run_logged "$log" "apt-get update" "${as_root[@]}" apt-get update ||
    ! run_logged "$log" "apt-get install" "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y --no-install-recommends "${missing[@]}"; then
    say "the packages could not be installed. By hand: apt-get update && $command"
    exit 1
  fi
}

# A compilation with deal.II takes up to 1.5 GB of memory.
build_jobs() {
  local cores gigabytes
  cores=$(nproc)
  gigabytes=$(awk '/^MemAvailable/ { print int($2 / 1.5e6) }' /proc/meminfo 2>/dev/null || echo 1)
  [ "${gigabytes:-0}" -ge 1 ] || gigabytes=1
  echo "${AXIFORGE_JOBS:-$((cores < gigabytes ? cores : gigabytes))}"
}

# ninja_announced TYPE FOLDER [TARGET...]: ninja, which tells on descriptor 3 that it compiles, and on a
# terminal how far it is; nothing if there is nothing to do.
ninja_announced() {
  local type=$1 folder=$2 line announced=
  shift 2
  ninja -C "$folder" -j "$(build_jobs)" "$@" 2>&1 | while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line == *Building* || $line == *Linking* ]] || continue
    if [ -t 3 ]; then
      printf '\raxiforge set-up: building (%s) %s ' "$type" "${line%%]*}]" >&3
    elif [ -z "$announced" ]; then
      say "building ($type), the log is $folder/build.log" 2>&3
    fi
    announced=1
  done
  local status=${PIPESTATUS[0]}
  [ ! -t 3 ] || printf '\r\033[K' >&3
  return "$status"
}

# ensure_build release|debug [TARGET...]: configures if need be, brings the targets (default: all) up
# to date. Two scripts that are started together wait for each other.
ensure_build() {
  local name=$1 type folder log
  shift
  case $name in
    release) type=Release ;;
    debug) type=Debug ;;
    *) say "no such build: $name"; return 1 ;;
  esac
  folder=$axiforge_build/$name
  log=$folder/build.log
  mkdir -p "$folder"
  (
    flock 9
    # A tree that was moved or copied has a cache that names another place: begin anew.
    if [ -f "$folder/CMakeCache.txt" ] &&
      ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$axiforge_root" "$folder/CMakeCache.txt"; then
      rm -rf "$folder/CMakeCache.txt" "$folder/CMakeFiles" "$folder/build.ninja"
    fi
    if [ ! -f "$folder/build.ninja" ]; then
      say "first $type build, in $folder: this takes a few minutes"
      run_logged "$folder/configure.log" "the configuration" cmake -G Ninja -S "$axiforge_root" -B "$folder" \
        -DCMAKE_BUILD_TYPE="$type"
    fi
    run_logged "$log" "the $type build" ninja_announced "$type" "$folder" "$@" 3>&2
  ) 9>"$folder/.lock"
}
