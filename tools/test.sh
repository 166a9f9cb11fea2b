#!/usr/bin/env bash
# Everything that has to hold before a change lands: installs the packages, builds all, runs every test, checks format and
# lint, builds the site of the documentation, runs the tests of the Vulkan backend under validation, verifies the command
# on a Vulkan device, repeats the tests of the readers under sanitizers, and fuzzes the readers for a short while.
# The last line is 'N passed, N failed, N skipped' over all tests and checks; the exit status is 0 only when none failed.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
step_count=9
source "$root/tools/scripts/common.sh"

usage() {
  cat <<'USAGE'
Usage: tools/test.sh [--quick]

  --quick   without Vulkan validation, and without sanitizers and fuzzing (one skipped each); of the calls of a
            drive on Vulkan every eighth is failed instead of every fourth (tools/soak.sh fails every one)

Vulkan runs on lavapipe, which needs no GPU; VK_DRIVER_FILES=FILE names another driver.

GDTSLAM_DATA=DIR   real logs for the accuracy tests (they skip where there are none)
GDTSLAM_FUZZ_S=N   seconds per fuzz target (default 2; tools/soak.sh has more)
GDTSLAM_LINT_SINCE=REVISION   clang-tidy checks what changed since then (default: in the last six hours); what builds
                   all once more does so where something of how things are built has changed
GDTSLAM_LONG_SHARE=N   of the long tests (ctest -L long) every N-th, which the commit decides; from 2 on without
                   the unit tests of the readers under sanitizers (default 1: all)
GDTSLAM_LINT_S=N   seconds for clang-tidy (default 150)
GDTSLAM_JOBS=N     compiler processes at a time
GDTSLAM_END_S=N    after that many seconds what repeats tests in another way is skipped: clang-tidy, sanitizers
                   and fuzzing, one skipped each (default: never)
USAGE
}
quick=false
for argument in "$@"; do
  case "$argument" in
    --quick) quick=true ;;
    -h | --help) usage; exit 0 ;;
    *) echo "test.sh: unknown argument '$argument'" >&2; usage >&2; exit 2 ;;
  esac
done

# Tests that need Vulkan fail where there is none. They run on lavapipe, so that the result is the same on every machine.
export GDTSLAM_REQUIRE_VULKAN=1
# So do those of the page where there is no browser, and those of films where there is no ffmpeg.
export GDTSLAM_REQUIRE_BROWSER=1 GDTSLAM_REQUIRE_PROGRAMS=1

long_share=${GDTSLAM_LONG_SHARE:-1}
if ! [[ $long_share =~ ^[1-9][0-9]?$ ]]; then echo "test.sh: GDTSLAM_LONG_SHARE must be a number from 1 to 99" >&2; exit 2; fi
# ask_git WORD...: fails in an unpacked archive, also where that lies in somebody's clone, and in a clone that git refuses.
ask_git() { [[ -e $root/.git ]] && git -C "$root" "$@" 2>/dev/null; }
revision=$(ask_git rev-parse --verify HEAD || echo 00000000)

reports=$root/build/reports
build=$root/build/test
sanitized=$root/build/fuzz

passed=0 failed=0 skipped=0
problems=()
complete=false

# The closing line comes whatever happens; a run that breaks off is a failure.
close() {
  local status=$?
  finish_step
  if ! $complete; then
    problems+=("the run broke off in step '${broken_step:-start}' (status $status)")
    failed=$((failed + 1))
  fi
  if ((${#problems[@]})); then printf '\nFailed:\n' && printf '  %s\n' "${problems[@]}"; fi
  printf '\nTotal time: %d min %d s\n' $((SECONDS / 60)) $((SECONDS % 60))
  printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
  if ((failed)); then exit 1; fi
}
trap close EXIT
begin() { step "$1"; broken_step=$1; }

# check NAME COMMAND...: one check that counts as one test.
check() {
  local name=$1
  shift
  if "$@"; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    problems+=("$name")
  fi
}
skip() {
  skipped=$((skipped + 1))
  echo "skipped: $1"
}

# may_begin WHAT: whether there is time for it; else it is skipped, and said.
may_begin() {
  if ((SECONDS < ${GDTSLAM_END_S:-SECONDS + 1})); then return 0; fi
  skip "$1: the $GDTSLAM_END_S s of GDTSLAM_END_S have passed"
  return 1
}

# add_results NAME FILE...: adds the counts of JUnit files (ctest's or GoogleTest's).
add_results() {
  local name=$1 counts
  shift
  counts=$(python3 "$root/tools/scripts/count_tests.py" "$@")
  read -r p f s <<<"$counts"
  passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
  echo "$name: $p passed, $f failed, $s skipped"
  if ((f)); then problems+=("$name: $f failed"); fi
  if ((p + f == 0)); then
    failed=$((failed + 1))
    problems+=("$name: no test ran")
  fi
}

# run_ctest NAME REPORT ARGUMENT...: prints what fails or skips; what passes is only counted.
run_ctest() {
  local name=$1 report=$reports/$2
  shift 2
  rm -f "$report.xml"
  {
    local status=0
    ctest --test-dir "$build" -j 2 --output-on-failure --no-tests=error --output-junit "$report.xml" "$@" || status=$?
    echo "$status" >"$report.status"
  } | grep -vE '^ *(Start +[0-9]+:|[0-9]+/[0-9]+ Test +#.* Passed )' || true
  add_results "$name" "$report.xml"
  check_status "$name" "$(<"$report.status")"
}

# A program that fails although no test of it did (a leak found at its end) is a failure too.
check_status() {
  if (($2 != 0 && f == 0)); then check "$1 ended with status $2" false; fi
}

# The parts that read what strangers send under AddressSanitizer and UBSan: the tests of the tree in which their fuzzers are
# built. tools/soak.sh asan has every part.
run_sanitized() {
  local folder names=() name status
  for folder in "$root"/tests/{unit,property,golden}/io; do
    compgen -G "$folder/*.cpp" >/dev/null || continue
    name=${folder#"$root/tests/"}
    names+=("gdtslam_${name/\//_}_tests")
  done
  cmake --build "$sanitized" --parallel "$(build_jobs)" --target "${names[@]}"
  for name in "${names[@]}"; do
    status=0
    rm -f "$reports/asan_$name.xml"
    (cd "$sanitized" && UBSAN_OPTIONS=print_stacktrace=1 "bin/$name" --gtest_brief=1 \
      --gtest_output="xml:$reports/asan_$name.xml") || status=$?
    if [[ -f $reports/asan_$name.xml ]]; then
      add_results "$name under ASan and UBSan" "$reports/asan_$name.xml"
      check_status "$name under ASan and UBSan" "$status"
    else
      check "$name under ASan and UBSan broke off with status $status" false
    fi
  done
}

begin "Packages"
"$root/tools/install-packages.sh" all
mkdir -p "$reports"
# Compilers and tests tell of a full disk in many ways, and late.
for folder in "$reports" "${TMPDIR:-/tmp}"; do
  free_mib=$(df -Pm "$folder" | awk 'END {print $4}')
  echo "free at $folder: $free_mib MiB"
  if ((free_mib < 4096)); then echo "test.sh: the builds and tests need some 4 GiB there; the disk may be full before they end" >&2; fi
done
for lavapipe in /usr/share/vulkan/icd.d/lvp_icd{".$(uname -m)",}.json; do
  if [[ -z ${VK_DRIVER_FILES:-} && -f $lavapipe ]]; then export VK_DRIVER_FILES=$lavapipe; fi
done

begin "Build with all tests"
# Libraries in the folder of the architecture, as Debian has them: the packages are made of this tree.
configure "$build" -DCMAKE_BUILD_TYPE=Release -DGDTSLAM_BUILD_TESTS=ON -DGDTSLAM_WERROR=ON -DCMAKE_UNITY_BUILD=ON \
  -DCMAKE_INSTALL_LIBDIR="lib/$(gcc -print-multiarch)"
cmake --build "$build" --parallel "$(build_jobs)"

begin "Tests"
# Empty where there is no earlier revision, and where git knows none: then all is taken for changed.
since=${GDTSLAM_LINT_SINCE:-$(ask_git rev-list -1 --before='6 hours ago' HEAD || true)}
# leave_out_unless_changed TEST PATH...: the test is left out where the paths are as they were.
left_out=()
leave_out_unless_changed() {
  local test=$1
  shift
  if [[ -z $since ]] || ! ask_git diff --quiet "$since" -- "$@"; then return; fi
  left_out+=("^install\\.$test")
  skip "install.$test: what it is made of is as it was at ${since:0:8} (tools/soak.sh long)"
}
# The bundle, and a project that has this one as a folder, build nearly all once more: ten minutes on two processors, so only
# where it has changed how things are built. The packages, which have the pages too, are made and installed in two.
how_built=(CMakeLists.txt cmake tests/install {engine,shaders,calib,viewer,tools,assets}/'*CMakeLists.txt' tools/install-packages.sh)
leave_out_unless_changed bundle "${how_built[@]}" LICENSE tools/scripts/make_bundle.sh tools/scripts/gpu_server.sh
leave_out_unless_changed as_a_folder "${how_built[@]}"
leave_out_unless_changed debian_packages "${how_built[@]}" debian python assets examples docs README.md CHANGELOG.md
if ((long_share > 1)); then
  left_out+=("$(python3 "$root/tools/scripts/draw_tests.py" "$build" --share "$long_share" --revision "$revision")")
  skip "long tests that do not have their turn (GDTSLAM_LONG_SHARE=$long_share; the next line names them)"
  tr '|' ' ' <<<"  ${left_out[-1]//[\^()$\\]/}"
fi
printf -v without '%s|' "${left_out[@]}"
run_ctest "tests" ctest -LE equivalence ${left_out:+--exclude-regex "${without%|}"}

# The Vulkan backend with the validation layer, synchronisation validation included; any message of it fails.
begin "Tests on Vulkan"
if $quick; then
  run_ctest "tests on Vulkan" vulkan -L equivalence
  skip "Vulkan validation (--quick)"
else
  GDTSLAM_VULKAN_VALIDATION=1 run_ctest "tests on Vulkan under validation" vulkan -L equivalence
fi

# As a user runs it: every kernel and whole logs on the device and on the CPU.
begin "Verify the command on Vulkan"
check "gdtslam verify" env "XDG_CACHE_HOME=$build/cache" "$build/bin/gdtslam" verify --device vulkan --quiet

begin "Format, scripts, shaders"
check "clang-format (mend with: tools/scripts/format.sh)" "$root/tools/scripts/format.sh" --check
check "shellcheck" shellcheck -x -P "$root" "$root"/tools/*.sh "$root"/tools/scripts/*.sh \
  "$root"/tests/install/*.sh "$root/.ci/run"
check "shaders" "$root/tools/scripts/check_shaders.sh"

# The documentation as a site, from the Markdown and the public headers: no warning, no dead link, no page that the
# navigation does not reach; then in a browser from its folder.
begin "Site"
check "site" "$root/tools/scripts/make_site.sh" -o "$root/build/site"
check "site in a browser" python3 -B "$root/tests/scripts/site_browser_test.py" "$root/build/site"

begin "clang-tidy"
# What changed since GDTSLAM_LINT_SINCE, or in the last six hours, in the time that it may take here, the largest batches
# first; tools/soak.sh checks every source.
if may_begin "clang-tidy"; then
  status=0
  python3 "$root/tools/scripts/lint.py" ${since:+--since "$since"} --seconds "${GDTSLAM_LINT_S:-150}" "$build" || status=$?
  check "clang-tidy" test "$status" = 0 -o "$status" = 77
  if ((status == 77)); then skip "clang-tidy of the sources that were left out"; fi
fi

begin "Sanitizers and fuzzing"
if $quick; then
  skip "sanitizers and fuzzing (--quick)"
else
  if may_begin "fuzzing"; then GDTSLAM_FUZZ_S=${GDTSLAM_FUZZ_S:-2} check "fuzzing" "$root/tools/scripts/fuzz.sh"; fi
  if ((long_share > 1)); then
    skip "unit tests of the readers under sanitizers (GDTSLAM_LONG_SHARE=$long_share; tools/soak.sh asan has every part)"
  elif may_begin "tests under sanitizers"; then
    run_sanitized
  fi
fi
complete=true
