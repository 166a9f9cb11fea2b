#!/usr/bin/env bash
# Builds the fuzz targets with clang and runs each from its corpus for GDTSLAM_FUZZ_S seconds (default 15), one per processor at
# a time. New inputs go into the build tree, and so does one that breaks something; the exit status is 1 then.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
step_count=1
source "$root/tools/scripts/common.sh"
fuzzed=$root/build/fuzz

fuzz_target() {
  local runs=$fuzzed/runs/$1
  mkdir -p "$runs/found"
  "$fuzzed/bin/gdtslam_fuzz_$1" -max_total_time="${GDTSLAM_FUZZ_S:-15}" -max_len=4096 -timeout=5 -rss_limit_mb=1024 \
    -malloc_limit_mb=256 -print_final_stats=1 -artifact_prefix="$runs/" "$runs/found" "$root/tests/fuzz/corpus/$1" \
    >"$runs/log" 2>&1 || {
    tail -n 40 "$runs/log"
    echo "$1: FAILED" >&2
    return 1
  }
  echo "$1: $(sed -n 's/^stat::number_of_executed_units: *//p' "$runs/log") executions, no finding"
}

names=()
for folder in "$root"/tests/fuzz/corpus/*/; do names+=("$(basename "$folder")"); done
configure "$fuzzed" --preset fuzz
cmake --build "$fuzzed" --parallel "$(build_jobs)" --target "${names[@]/#/gdtslam_fuzz_}"
status=0
running=0
for name in "${names[@]}"; do
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
