#!/usr/bin/env bash
# What is too long for tools/test.sh: the unit and property tests unoptimised, by clang and under three sanitizers, every
# test with its longest settings, clang-tidy over every source, fuzzing for minutes, the tests of the command in builds for
# other platforms. Some hours on two processors.
# The last line is 'N passed, N failed' over the steps; the exit status is 0 only when none failed.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
step_count=12
source "$root/tools/scripts/common.sh"

usage() {
  cat <<'USAGE'
Usage: tools/soak.sh [STEP...]

  debug      unit and property tests, unoptimised, with the checks of the standard library
  clang      the same, built by clang
  asan       the same and the tests of the command under AddressSanitizer and UndefinedBehaviorSanitizer
  tsan       the same as asan under ThreadSanitizer, without the real logs: they are mapped by one thread, in hours. In the
             tests of the command, kernels of the processor run as they are
  long       all tests with every mutant of the shaders, every failing call and 200 draws of the calibration;
             those of the Vulkan backend once more under validation
  platforms  unit tests and those of the command, unoptimised, by clang, and compiled for this processor by both compilers
  lint       clang-tidy over every source
  fuzz       every fuzz target for GDTSLAM_FUZZ_S seconds (default 600)
  integer    the corpora of the fuzz targets and the unit tests of the readers, where whole numbers that wrap or lose bits
             are errors
  endurance  ten hours of live, 10,000 maps in one process, a million scans (tools/scripts/experiments.py endurance)
  memcheck   one of each command under valgrind
  arm64      the command built for arm64, and the samples' hashes under qemu (tools/scripts/cross_arm64.sh)

Without STEP: all of them.
USAGE
}
steps=()
for argument in "$@"; do
  case "$argument" in
    debug | clang | asan | tsan | long | platforms | lint | fuzz | integer | endurance | memcheck | arm64)
      steps+=("$argument") ;;
    -h | --help) usage; exit 0 ;;
    *) echo "soak.sh: unknown step '$argument'" >&2; usage >&2; exit 2 ;;
  esac
done
if ((${#steps[@]} == 0)); then steps=(debug clang asan tsan long platforms lint fuzz integer endurance memcheck arm64); fi
step_count=${#steps[@]}

passed=0 failed=0
problems=()

export GDTSLAM_REQUIRE_VULKAN=1 GDTSLAM_REQUIRE_BROWSER=1 GDTSLAM_REQUIRE_PROGRAMS=1
for lavapipe in /usr/share/vulkan/icd.d/lvp_icd{".$(uname -m)",}.json; do
  if [[ -z ${VK_DRIVER_FILES:-} && -f $lavapipe ]]; then export VK_DRIVER_FILES=$lavapipe; fi
done

# test_build PRESET [LEFT_OUT]: builds the unit and property tests of a preset of CMakePresets.json and runs them, those
# whose names match LEFT_OUT excepted.
test_build() {
  local build=$root/build/$1 program names=() left_out=()
  if (($# > 1)); then left_out=(--exclude-regex "$2"); fi
  (cd "$root" && cmake --preset "$1" --log-level=WARNING)
  while read -r program; do names+=("$program"); done < <(
    ninja -C "$build" -t targets all | sed -n 's/^\(gdtslam_\(unit\|property\)_[a-z_]*_tests\): phony$/\1/p')
  if ((${#names[@]} != $(find "$root/tests/unit" "$root/tests/property" -mindepth 1 -maxdepth 1 -type d | wc -l))); then
    echo "soak: tests/unit and tests/property have other folders than $build has programs: ${names[*]}" >&2
    return 1
  fi
  cmake --build "$build" --parallel "$(build_jobs)" --target "${names[@]}" gdtslam
  (cd "$build" && TSAN_OPTIONS="halt_on_error=1" UBSAN_OPTIONS=print_stacktrace=1 \
    ctest -j "$(nproc)" --output-on-failure --no-tests=error -L '^(unit|property)$' "${left_out[@]}")
}

# test_command PRESET: the tests of the command of such a build. memcheck looks for leaks, also those of libraries.
test_command() {
  local build=$root/build/$1
  (cd "$root" && cmake --preset "$1" --log-level=WARNING)
  cmake --build "$build" --parallel "$(build_jobs)" --target gdtslam live_mapper
  (cd "$build" && ASAN_OPTIONS=detect_odr_violation=1:detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
    TSAN_OPTIONS="halt_on_error=1 suppressions=$root/tests/tsan.supp" \
    ctest -j "$(nproc)" --output-on-failure --no-tests=error -L '^cli$')
}

# What results must not depend on: each build runs the unit tests and whole commands, whose bytes are compared with the
# hashes that ship.
run_platforms() {
  local preset build
  for preset in debug clang native clang-native; do
    build=$root/build/$preset
    (cd "$root" && cmake --preset "$preset" --log-level=WARNING)
    cmake --build "$build" --parallel "$(build_jobs)"
    (cd "$build" && ctest -j "$(nproc)" --output-on-failure --no-tests=error -L '^(unit|cli)$')
  done
}

run_long() {
  local build=$root/build/test
  configure "$build" -DCMAKE_BUILD_TYPE=Release -DGDTSLAM_BUILD_TESTS=ON -DGDTSLAM_WERROR=ON \
    -DCMAKE_UNITY_BUILD=ON
  cmake --build "$build" --parallel "$(build_jobs)"
  GDTSLAM_ALL_MUTANTS=1 GDTSLAM_CALIBRATION_DRAWS=200 ctest --test-dir "$build" -j "$(nproc)" --output-on-failure \
    --no-tests=error --timeout 7200
  GDTSLAM_VULKAN_VALIDATION=1 ctest --test-dir "$build" -j "$(nproc)" --output-on-failure --no-tests=error \
    -L equivalence --timeout 7200
}

run_lint() {
  configure "$root/build/test" -DCMAKE_BUILD_TYPE=Release -DGDTSLAM_BUILD_TESTS=ON -DGDTSLAM_WERROR=ON \
    -DCMAKE_UNITY_BUILD=ON
  cmake --build "$root/build/test" --parallel "$(build_jobs)"
  python3 "$root/tools/scripts/lint.py" "$root/build/test"
}

# The command of build/test.
build_command() {
  local build=$root/build/test
  configure "$build" -DCMAKE_BUILD_TYPE=Release -DGDTSLAM_BUILD_TESTS=ON -DGDTSLAM_WERROR=ON \
    -DCMAKE_UNITY_BUILD=ON
  cmake --build "$build" --parallel "$(build_jobs)" --target gdtslam "$@"
}

# One of each command, each with what those before it made. Errors are memory that was never written or is freed, and
# memory that nobody can free any more; tests/memcheck.supp names what libraries do.
run_memcheck() {
  local folder words status=0
  command -v valgrind >/dev/null || install_besides valgrind
  build_command
  folder=$(mktemp -d)
  while read -ra words; do
    echo "gdtslam ${words[*]}"
    (cd "$folder" && valgrind --quiet --error-exitcode=99 --num-callers=24 --leak-check=full --trace-children=yes \
      --errors-for-leak-kinds=definite --show-leak-kinds=definite --keep-debuginfo=yes \
      --trace-children-skip='*/ffmpeg,*/sh,*/git' --suppressions="$root/tests/memcheck.supp" \
      "$root/build/test/bin/gdtslam" "${words[@]}" </dev/null >/dev/null) || status=1
  done <<'COMMANDS'
simulate three-boxes -o deep.log --rate 1 -q
simulate office-loop -o drive.log --rate 1 --seed 3 -q
convert drive.log -o drive.mcap -q
map drive.log -o run -q --first 60
map deep.log -o deep -q --first 30 --no-pictures
localize run drive.log --scan 3
localize run drive.log --track -o out.tum -q
live drive.log -o live -q
map --continue live drive.mcap -q
evaluate run --reference drive.truth.tum
merge run live -o sites -q --no-pictures
edit run --origin 1,1,90 --tiles -o edited -q
render run --view map -o out.png --size 96x64 -q
render deep --seconds 0.08s -o out.mp4 --size 96x64 -q
evaluate deep --planes --boxes
doctor drive.log
linkage paper-b
config show
doctor --devices
COMMANDS
  rm -rf "$folder"
  return "$status"
}

# Packages that no other step needs.
install_besides() {
  local as_root=()
  if ((EUID != 0)); then as_root=(sudo); fi
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" apt-get install -y -qq --no-install-recommends "$@"
}

run_arm64() {
  local as_root=()
  if ((EUID != 0)); then as_root=(sudo); fi
  "${as_root[@]}" dpkg --add-architecture arm64
  install_besides g++-aarch64-linux-gnu qemu-user-static
  "$root/tools/scripts/cross_arm64.sh"
}

run_endurance() {
  build_command gdtslam_c
  python3 "$root/tools/scripts/experiments.py" endurance "$root/build/test/bin/gdtslam"
}

run_fuzz() { GDTSLAM_FUZZ_S=${GDTSLAM_FUZZ_S:-600} "$root/tools/scripts/fuzz.sh"; }

run_integer() {
  export CCACHE_EXTRAFILES=$root/tests/fuzz/integer_ignored.txt  # which ccache does not know of
  local corpus build=$root/build/integer tests=(gdtslam_unit_io_tests gdtslam_unit_runs_tests)
  (cd "$root" && cmake --preset integer --log-level=WARNING)
  cmake --build "$build" --parallel "$(build_jobs)" --target gdtslam_fuzz "${tests[@]}"
  for corpus in "$root"/tests/fuzz/corpus/*; do "$build/bin/gdtslam_fuzz" "${corpus##*/}" -runs=0 "$corpus"; done
  for program in "${tests[@]}"; do "$build/bin/$program" --gtest_filter=-*RealLog*:*RealData*; done
}

run_step() {
  case "$1" in
    debug | clang) test_build "$1" ;;
    tsan) test_build tsan RealLog; test_command tsan-command ;;
    asan) test_build asan-ubsan; test_command asan-ubsan ;;
    long) run_long ;;
    platforms) run_platforms ;;
    lint) run_lint ;;
    fuzz) run_fuzz ;;
    integer) run_integer ;;
    endurance) run_endurance ;;
    memcheck) run_memcheck ;;
    arm64) run_arm64 ;;
  esac
}

mkdir -p "$root/build"
if ((${#steps[@]} == 1)); then
  "$root/tools/install-packages.sh" all
  run_step "${steps[0]}"
  printf '1 passed, 0 failed\n'
  exit 0
fi
# Each step is a process of its own, so that its first command that fails ends the step and not the run.
for name in "${steps[@]}"; do
  step "$name"
  if "$root/tools/soak.sh" "$name"; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    problems+=("$name")
  fi
done
finish_step
if ((failed)); then printf 'Failed: %s\n' "${problems[*]}"; fi
printf '%d passed, %d failed\n' "$passed" "$failed"
((failed == 0))
