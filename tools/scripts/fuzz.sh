#!/usr/bin/env bash
# Builds the fuzz program with clang and runs each of its targets (or those named) from its corpus for GDTSLAM_FUZZ_S seconds
# (default 15), one per processor at a time, and prints a table. More than 512 MB or 10 s for an input is a finding too. New
# inputs go into the build tree, and so does one that breaks something; the exit status is 1 then.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
step_count=1
source "$root/tools/scripts/common.sh"
fuzzed=$root/build/fuzz
corpus=$root/tests/fuzz/corpus
program=$fuzzed/bin/gdtslam_fuzz
row='%-14s %12s %9s %9s %9s %9s\n'

# Freed memory that AddressSanitizer holds back counts as memory of the program.
export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=32}

# "#2097152 DONE   cov: 1024 ft: 4096 corp: 512/99Kb ..." of a log
figure() { sed -n "s/^#[0-9]*\t*.*DONE .*$2 *\([0-9]*\).*/\1/p" "$1" | tail -n 1; }

fuzz_target() {
  local runs=$fuzzed/runs/$1
  rm -rf "$runs/tmp"
  mkdir -p "$runs/found" "$runs/tmp"
  TMPDIR=$runs/tmp "$program" "$1" -max_total_time="${GDTSLAM_FUZZ_S:-15}" -timeout=10 -rss_limit_mb=512 \
    -malloc_limit_mb=256 -print_final_stats=1 -artifact_prefix="$runs/" "$runs/found" "$corpus/$1" \
    >"$runs/log" 2>&1 || {
    tail -n 40 "$runs/log"
    echo "$1: FAILED; run it again by $program $1 FILE with the file that is named above" >&2
    return 1
  }
  # shellcheck disable=SC2059
  printf "$row" "$1" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$runs/log")" "$(figure "$runs/log" cov:)" \
    "$(figure "$runs/log" ft:)" "$(figure "$runs/log" corp:)" "$(sed -n 's/^Done .* in \([0-9]*\) second.*/\1/p' "$runs/log")"
}

configure "$fuzzed" --preset fuzz
cmake --build "$fuzzed" --parallel "$(build_jobs)" --target gdtslam_fuzz
mapfile -t all < <("$program" targets)
for folder in "$corpus"/*/; do
  [[ " ${all[*]} " == *" $(basename "$folder") "* ]] || {
    echo "$folder is the corpus of no target" >&2
    exit 1
  }
done
targets=("$@")
if ((${#targets[@]} == 0)); then targets=("${all[@]}"); fi
status=0
running=0
# shellcheck disable=SC2059
printf "$row" target executions edges features corpus seconds
for name in "${targets[@]}"; do
  if ((running == $(nproc))); then
    wait -n || status=1
    running=$((running - 1))
  fi
  fuzz_target "$name" &
  running=$((running + 1))
done
while ((running > 0)); do
  wait -n || status=1
  running=$((running - 1))
done
exit "$status"
