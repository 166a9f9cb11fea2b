#!/usr/bin/env bash
# Builds the fuzz program with clang and runs each of its targets (or those named) from its corpus for GDTSLAM_FUZZ_S seconds
# (default 15), one per processor at a time, and prints a table. More than 512 MB or 10 s for an input is a finding too. New
# inputs go into the build tree, and so does one that breaks something; the exit status is 1 then.
# With GDTSLAM_FUZZ_RUNS=N so many executions of all together, in as many calls as it takes. --replay, --minimise, -j and
# the rest: fuzz.sh --help. GDTSLAM_FUZZ_UNOPTIMISED=ON builds all without optimisation, in half the time.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
step_count=1
source "$root/tools/scripts/common.sh"
fuzzed=$root/build/fuzz
run=(python3 -B "$root/tools/scripts/fuzz_targets.py" --program "$fuzzed/bin/gdtslam_fuzz" --corpus "$root/tests/fuzz/corpus"
  --folder "$fuzzed")

if [[ " $* " == *" -h "* || " $* " == *" --help "* ]]; then exec "${run[@]}" --help; fi
export CCACHE_EXTRAFILES=$root/tests/fuzz/not_covered.txt  # which ccache does not know of
case ${GDTSLAM_FUZZ_UNOPTIMISED:-OFF} in
  OFF) unoptimised=() ;;
  ON) unoptimised=(-DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O0 -g1 -D_GLIBCXX_ASSERTIONS") ;;
  *) echo "fuzz.sh: GDTSLAM_FUZZ_UNOPTIMISED must be ON or OFF" >&2 && exit 2 ;;
esac
configure "$fuzzed" --preset fuzz "${unoptimised[@]}"
cmake --build "$fuzzed" --parallel "$(build_jobs)" --target gdtslam_fuzz
# Freed memory that AddressSanitizer holds back counts as memory of the program. Of where memory was taken a few calls are
# kept, which take a tenth of the time of all.
export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=32:malloc_context_size=6}
exec "${run[@]}" "$@"
