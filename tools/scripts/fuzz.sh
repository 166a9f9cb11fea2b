#!/usr/bin/env bash
# Builds the fuzz program with clang and runs each of its targets (or those named) from its corpus for GDTSLAM_FUZZ_S seconds
# (default 15), one per processor at a time. An input that takes more than 512 MB or 30 s is a finding like a crash; the exit
# status is 1 then. Everything is kept in build/fuzz/runs/TARGET: the log, new inputs (found/), and the input that failed.
#   fuzz.sh --minimise [TARGET...]   keeps of each corpus and of found/ the few inputs that together reach every edge
# GDTSLAM_FUZZ_UNOPTIMISED=ON builds all without optimisation, in half the time.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
step_count=1
source "$root/tools/scripts/common.sh"
fuzzed=$root/build/fuzz
action=fuzz
if [[ ${1:-} == --minimise ]]; then action=minimise && shift; fi
case ${GDTSLAM_FUZZ_UNOPTIMISED:-OFF} in
  OFF) unoptimised=() ;;
  ON) unoptimised=(-DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O0 -g1 -D_GLIBCXX_ASSERTIONS") ;;
  *) echo "fuzz.sh: GDTSLAM_FUZZ_UNOPTIMISED must be ON or OFF" >&2 && exit 2 ;;
esac
export CCACHE_EXTRAFILES=$root/tests/fuzz/not_covered.txt  # which ccache does not know of
configure "$fuzzed" --preset fuzz "${unoptimised[@]}"
cmake --build "$fuzzed" --parallel "$(build_jobs)" --target gdtslam_fuzz
export root fuzzed program=$fuzzed/bin/gdtslam_fuzz
# Freed memory that AddressSanitizer holds back counts as memory of the program. Of where memory was taken a few calls are
# kept, which take a tenth of the time of all.
export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=32:malloc_context_size=6}

# fuzz_program TARGET FOLDERS AND OPTIONS: files of the readers lie in memory where there is some.
fuzz_program() {
  local scratch memory=/dev/shm status=0 runs=$fuzzed/runs/$1
  if [[ ! -w $memory ]]; then memory=${TMPDIR:-/tmp}; fi
  mkdir -p "$runs/found"
  scratch=$(mktemp -d -p "$memory" gdtslam-fuzz-XXXXXX)
  TMPDIR=$scratch "$program" "$@" -timeout=30 -rss_limit_mb=512 -malloc_limit_mb=256 -print_funcs=0 -reload=0 \
    -artifact_prefix="$runs/" >"$runs/log" 2>&1 || status=$?
  rm -rf "$scratch"
  if ((status != 0)); then
    tail -n 40 "$runs/log" >&2
    echo "$1: FAILED; run it again by $program $1 FILE with the file that is named above" >&2
  fi
  return "$status"
}

fuzz() {
  fuzz_program "$1" -max_total_time="${GDTSLAM_FUZZ_S:-15}" "$fuzzed/runs/$1/found" "$root/tests/fuzz/corpus/$1"
  echo "$1: $(grep -oP '^#\K.*(?= lim:)' "$fuzzed/runs/$1/log" | tail -n 1)"
}

# libFuzzer calls an input by its sum; those that are in the corpus already keep their names.
minimise() {
  local file kept=$fuzzed/runs/$1/kept corpus=$root/tests/fuzz/corpus/$1
  rm -rf "$kept" && mkdir -p "$kept"
  fuzz_program "$1" -set_cover_merge=1 -use_counters=0 "$kept" "$corpus" "$fuzzed/runs/$1/found"
  for file in "$corpus"/*; do
    rm "$kept/$(sha1sum <"$file" | cut -d ' ' -f 1)" 2>/dev/null || rm "$file"
  done
  find "$kept" -type f -exec mv -t "$corpus" {} +
  echo "$1: $(find "$corpus" -type f | wc -l) inputs"
}

export -f fuzz_program fuzz minimise
if (($# == 0)); then mapfile -t targets < <("$program" targets); else targets=("$@"); fi
printf '%s\n' "${targets[@]}" | xargs -P "${GDTSLAM_JOBS:-$(nproc)}" -I '{}' bash -euo pipefail -c "$action {}" || exit 1
