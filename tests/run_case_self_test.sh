#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# run_case_self_test.sh WORK_FOLDER
#
# The test of the test: run_case.sh and run_faults.sh, with a program of a few lines in the place of
# axiforge, pass what is right and find what is wrong.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
rm -rf "$1"
mkdir -p "$1/a folder/cases/faults"
cd "$1/a folder"
unset UPDATE_EXPECTED

# The stand-in: its scene is a list of commands for it.
cat >program <<'EOF'
#!/usr/bin/env bash
scene=$1
shift
text=$([ -f "$scene" ] && cat "$scene" || echo "refuse Cannot read the file $scene.")
while [ $# -gt 0 ]; do
  case $1 in
    --output) output=$2 && shift ;;
    --set) text+=$'\n'${2#* = } && shift ;;
    *) echo "argument <$1>" ;;
  esac
  shift
done
while IFS= read -r line; do
  word=${line%% *} rest=${line#* }
  case $word in
    write) mkdir -p "$output" && printf "${rest#* }" >"$output/${rest%% *}" ;;
    say) echo "$rest" ;;
    warn) echo "$rest" >&2 ;;
    beside) [ -f "$rest" ] || { echo "No file $rest." >&2 && exit 3; } ;;
    end) exit "$rest" ;;
    refuse) echo "$rest" >&2 && exit 1 ;;
  esac
done <<<"$text"
EOF
chmod +x program

n_wrong=0
verdict() { # EXPECTED_VERDICT WORDS COMMAND...: passes|fails, and what the runner must say ('' anything)
  local wanted=$1 words=$2 said got=passes
  shift 2
  said=$("$@" 2>&1) || got=fails
  if [ "$got" != "$wanted" ] || ! grep -qF -- "$words" <<<"$said"; then
    printf 'WRONG: %s instead of %s with "%s":\n%s\n' "$got" "$wanted" "$words" "$said"
    n_wrong=$((n_wrong + 1))
  fi
}

case_is() { # SCENE CONF [EXPECTED_CSV]
  rm -rf cases/one
  mkdir -p cases/one/expected
  printf '%b' "$1" >cases/one/case.prm
  printf '%b' "$2" >cases/one/case.conf
  [ $# -lt 3 ] || printf '%b' "$3" >cases/one/expected/h.csv
}
run=("$here/run_case.sh" ./program cases/one work/one)

table='write h.csv a,b,t\\n1,2.0000001,17\\n2,nan,18\\n'
case_is "$table\n" 'compare: h.csv rel 1e-6 skip t\n' 'a,b,t\n1,2,0\n2,nan,0\n'
verdict passes 'one: passed' "${run[@]}"
case_is "$table\n" 'compare: h.csv rel 1e-6\n' 'b,a\n2,1\nnan,2\n'
verdict passes '' "${run[@]}"
case_is "$table\n" 'compare: h.csv rel 1e-9\n' 'a,b\n1,2\n2,nan\n'
verdict fails 'row 1, b: 2.0000001 instead of 2' "${run[@]}"
case_is "$table\n" 'compare: h.csv rel 1e-9 abs 1e-6\n' 'a,b\n1,2\n2,nan\n'
verdict passes '' "${run[@]}"
case_is "$table\n" 'compare: h.csv only a\n' 'a,b\n1,5\n2,5\n'
verdict passes '' "${run[@]}"
case_is "$table\n" 'compare: h.csv\n' 'a,b\n1,2\n2,0\n'
verdict fails 'row 2, b: "nan" instead of "0"' "${run[@]}"
case_is "$table\n" 'compare: h.csv\n' 'a\n1\n2\n3\n'
verdict fails '2 rows instead of 3' "${run[@]}"
case_is "$table\n" 'compare: h.csv\n' 'a\n1\n'
verdict fails '2 rows instead of 1' "${run[@]}"
case_is "$table\n" 'compare: h.csv\n' 'a,c\n1,1\n2,2\n'
verdict fails 'column "c" is missing' "${run[@]}"
case_is 'write h.csv ' 'compare: h.csv\n' 'a,c\n1,1\n'
verdict fails '0 rows instead of 1' "${run[@]}"
# A column through zero: 1e-9 instead of 0 beside values of 100.
case_is 'write h.csv f\\n100\\n1e-9\\n' 'compare: h.csv rel 1e-6\n' 'f\n100\n0\n'
verdict fails 'row 2, f' "${run[@]}"
case_is 'write h.csv f\\n100\\n1e-9\\n' 'compare: h.csv rel 1e-6 range 1e-8\n' 'f\n100\n0\n'
verdict passes '' "${run[@]}"
case_is 'say nothing' 'compare: h.csv\n' 'a\n1\n'
verdict fails 'has not written h.csv' "${run[@]}"
case_is 'write h.csv x\\n' 'compare: h.csv text\n' 'y\n'
verdict fails 'h.csv differs' "${run[@]}"

# Expected files: missing, written, then right.
case_is "$table\n" 'compare: h.csv skip t\n'
verdict fails 'UPDATE_EXPECTED=1 writes it' "${run[@]}"
verdict passes 'updated' env UPDATE_EXPECTED=1 "${run[@]}"
verdict passes 'a,b' cat cases/one/expected/h.csv
verdict fails '' grep t cases/one/expected/h.csv
verdict passes '' "${run[@]}"

# Exit status, messages, arguments, files, crashes.
case_is 'warn it stopped here\nend 2' '# all is well\nstatus: 2\nmessage: it stopped\n\n'
verdict passes '' "${run[@]}"
case_is 'end 2' ''
verdict fails 'exit status 2 instead of 0' "${run[@]}"
case_is 'say hello' 'message: farewell\n'
verdict fails 'has not said: farewell' "${run[@]}"
case_is 'say hello' 'absent: hello\n'
verdict fails 'has said: hello' "${run[@]}"
case_is '' 'set: A/B = say from set\nargument: --two words\nmessage: from set\nmessage: <--two words>\n'
verdict passes '' "${run[@]}"
case_is 'write f.vtu ' 'file: f.vtu\n'
verdict fails 'has not written f.vtu' "${run[@]}"
case_is 'write .f.vtu.123.tmp x' ''
verdict fails 'half-written' "${run[@]}"
case_is "warn terminate called after throwing an instance of 'int'" ''
verdict fails 'has crashed' "${run[@]}"
case_is '' 'messages: x\n'
verdict fails 'case.conf:1: cannot read "messages: x"' "${run[@]}"
case_is '' 'compare: h.csv sloppy 1\n'
verdict fails 'unknown word "sloppy"' "${run[@]}"

# Faults.
fault_is() { # TEXT
  rm -f cases/faults/*
  printf 'say sound\nbeside part.txt\nrefuse not found: x\n' >cases/base.prm
  touch cases/part.txt
  printf '%b' "$1" >cases/faults/one.fault
}
run=("$here/run_faults.sh" ./program cases/faults work/faults)

fault_is 'base: ../base.prm\nexpect: not found\nexpect: x\n'
verdict passes '1 faults run, 0 complaints' "${run[@]}"
fault_is 'base: ../base.prm\nexpect: something else\n'
verdict fails 'the message does not have: something else' "${run[@]}"
fault_is 'base: ../base.prm\nreplace: found: x => seen: y $&\nexpect: not seen: y $&\n'
verdict passes '' "${run[@]}"
fault_is 'base: ../base.prm\nreplace: lost => y\nexpect: not\n'
verdict fails 'the scene has no "lost"' "${run[@]}"
fault_is 'base: ../base.prm\nremove: refuse\nexpect: not\n'
verdict fails 'exit status 0 instead of 1' "${run[@]}"
fault_is 'base: ../base.prm\nremove: refuse\nappend: refuse appended\nexpect: appended\n'
verdict passes '' "${run[@]}"
fault_is 'base: ../base.prm\nremove: refuse\nset: A = refuse set\nexpect: set\n'
verdict passes '' "${run[@]}"
fault_is 'base: ../base.prm\nreplace: say sound => warn two lines\nexpect: not found\n'
verdict fails 'should have 1 line' "${run[@]}"
fault_is 'base: ../base.prm\nreplace: say sound => write r.vtu x\nexpect: not found\n'
verdict fails 'result files are left' "${run[@]}"
fault_is 'base: ../base.prm\nreplace: refuse => warn Stacktrace:\nappend: end 1\nexpect: x\n'
verdict fails 'has crashed' "${run[@]}"
fault_is 'scene: missing.prm\nexpect: Cannot read the file missing.prm\n'
verdict passes '' "${run[@]}"
fault_is 'base: ../other.prm\nexpect: x\n'
verdict fails 'other.prm is missing' "${run[@]}"
fault_is 'base: ../base.prm\n'
verdict fails 'no "expect:"' "${run[@]}"
fault_is 'expect: whole\n'
printf 'beside mesh.msh\nrefuse whole scene\n' >cases/faults/one.prm
verdict fails 'exit status 3' "${run[@]}"
touch cases/faults/mesh.msh
verdict passes '' "${run[@]}"
fault_is 'base: ../base.prm\nreplace: say sound => beside mesh.msh\nfile: mesh.msh\nexpect: not found\n'
touch cases/faults/mesh.msh
verdict passes '' "${run[@]}"
# Each fault is run by one of the parts.
for name in two three; do
  cp cases/faults/one.fault cases/faults/$name.fault
done
verdict passes '2 faults run' "${run[@]}" 0 2
verdict passes '1 faults run' "${run[@]}" 1 2
rm cases/faults/*
verdict fails '0 faults run' "${run[@]}"

[ "$n_wrong" -eq 0 ]
echo "the runners of cases and faults judge rightly"
