#!/usr/bin/env bash
# Counts the instructions of a job with callgrind, and compares with what instructions.txt has for the build.
#
#   count_instructions.sh PROGRAM BUILD JOB        fails where the job takes 3 % more; 77: nothing to compare, and why
#   count_instructions.sh PROGRAM BUILD --update   writes the build's lines anew
#
# Times hang on the machine and on what else it does; instructions do not. BUILD says what the program was made by, e.g.
# GNU-12-x86_64-Release: another compiler makes other instructions.
set -euo pipefail

readonly ALLOWED_PERCENT=3
readonly PROGRAM=$1 BUILD=$2 JOB=$3
record=$(dirname "$0")/instructions.txt
readonly record

skip() {
  echo "SKIPPED: $1"
  exit 77
}

jobs() { grep -v '^#' "$record" | cut -d ' ' -f 1 | sort -u; }

recorded() { awk -v job="$1" -v build="$BUILD" '$1 == job && $2 == build { print $3 }' "$record"; }

# callgrind's last word is "==PID== Collected : COUNT".
counted() {
  local folder failed=0
  folder=$(mktemp -d)
  valgrind --tool=callgrind --callgrind-out-file="$folder/out" "$PROGRAM" "$1" 2>"$folder/said" || failed=1
  if [ $failed -eq 0 ]; then
    sed -n 's/^==[0-9]*== Collected : \([0-9]*\)$/\1/p' "$folder/said"
  else
    cat "$folder/said" >&2
  fi
  rm -r "$folder"
  return $failed
}

command -v valgrind >/dev/null || skip "no valgrind"
# Some loops are compiled for several processors. Valgrind's has AVX2 where the machine's has it.
grep -qw avx2 /proc/cpuinfo || skip "a processor without AVX2: the counts are of one that has it"

if [ "$JOB" = --update ]; then
  for job in $(jobs); do
    count=$(counted "$job")
    echo "$job: $count, was $(recorded "$job")"
    sed -i "/^$job $BUILD /d" "$record"
    echo "$job $BUILD $count" >>"$record"
  done
  exit
fi

before=$(recorded "$JOB")
[ -n "$before" ] || skip "instructions.txt has no '$JOB' of the build $BUILD"
now=$(counted "$JOB")
awk -v before="$before" -v now="$now" -v allowed="$ALLOWED_PERCENT" -v job="$JOB" 'BEGIN {
  percent = 100 * (now / before - 1)
  printf "%s: %.0f instructions, %.0f recorded: %+.2f %%\n", job, now, before, percent
  if (percent < -allowed) print "fewer than recorded: renew the record, see CONTRIBUTING.md"
  if (percent > allowed) print "more than the " allowed " % allowed"
  exit percent > allowed
}'
