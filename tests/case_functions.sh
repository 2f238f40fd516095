# SPDX-License-Identifier: GPL-2.0-or-later
# What run_case.sh and run_faults.sh share. To be sourced; $name is the case at hand.

n_failures=0
fail() { # TEXT
  echo "$name: $1"
  n_failures=$((n_failures + 1))
}

# read_entries FILE: gives each line "key: value" to read_entry KEY VALUE. # begins a comment line.
read_entries() {
  local line number=0 key value
  if [ ! -f "$1" ]; then
    echo "$1 is missing" >&2
    exit 1
  fi
  while IFS= read -r line || [ -n "$line" ]; do
    number=$((number + 1))
    line=${line%$'\r'}
    [[ $line =~ ^[[:space:]]*(#.*)?$ ]] && continue
    if [[ $line =~ ^([a-z]+):[[:space:]]*(.*[^[:space:]])?[[:space:]]*$ ]]; then
      key=${BASH_REMATCH[1]}
      value=${BASH_REMATCH[2]-}
      read_entry "$key" "$value" && continue
    fi
    echo "$1:$number: cannot read \"$line\"" >&2
    exit 1
  done <"$1"
}

# run_program WORK RANKS PROGRAM ARGUMENT...: in WORK, what it says goes to WORK/stdout and WORK/stderr.
run_program() {
  local work=$1 ranks=$2
  shift 2
  local launcher=()
  if [ "$ranks" -gt 1 ]; then
    launcher=("${AXIFORGE_MPIRUN:-mpirun}" --oversubscribe -np "$ranks")
    [ "$(id -u)" -ne 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  fi
  (
    cd "$work"
    export OPENBLAS_NUM_THREADS=1
    ${launcher[@]+"${launcher[@]}"} "$@" >stdout 2>stderr </dev/null
  )
}

# check_no_crash SCREEN: an exception nobody has caught, or a signal, is a failure of any case.
check_no_crash() {
  local text
  for text in 'terminate called' 'Stacktrace:' 'An error occurred in line <' 'Segmentation fault' \
    'runtime error:' 'AddressSanitizer' 'MPI_ABORT was invoked'; do
    ! grep -qF -- "$text" <<<"$1" || fail "the program has crashed: \"$text\""
  done
}
