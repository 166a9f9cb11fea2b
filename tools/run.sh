#!/usr/bin/env bash
# From a clean clone to a map: installs the packages, builds, simulates the sample office, maps it, compares the
# trajectory with the truth, and says where everything is. Can be run again at any time; a second run rebuilds nothing.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
step_count=5
source "$root/tools/scripts/common.sh"

usage() {
  cat <<'USAGE'
Usage: tools/run.sh

Installs what is missing (Debian 12; root or sudo), builds gdtslam into build/release, simulates a drive through the
sample office and maps it into runs/office-loop. GDTSLAM_JOBS=N limits the compiler processes.
USAGE
}
case "${1:-}" in
  '') ;;
  -h | --help) usage; exit 0 ;;
  *) echo "run.sh: unknown argument '$1'" >&2; usage >&2; exit 2 ;;
esac

build=$root/build/release
gdtslam=$build/bin/gdtslam
runs=$root/runs
log=$runs/office-loop.log
truth=$runs/office-loop.truth.tum
result=$runs/office-loop

report_failure() {
  local status=$?
  if ((status)); then echo "run.sh: failed in step $step_number, $step_title (status $status)" >&2; fi
}
trap report_failure EXIT

step "Packages"
"$root/tools/install-packages.sh" build

step "Build (Release)"
mkdir -p "$root/build" "$runs"
configure "$build" -DCMAKE_BUILD_TYPE=Release -DGDTSLAM_BUILD_TESTS=OFF -DGDTSLAM_WERROR=OFF
cmake --build "$build" --parallel "$(build_jobs)"

step "Simulate the sample office"
"$gdtslam" simulate office-loop -o "$log"

step "Map it"
"$gdtslam" map "$log" -o "$result"

step "Compare with the truth"
"$gdtslam" evaluate "$result/trajectory.tum" --reference "$truth"
finish_step

cat <<END

Done. The results:
  $result/overview.png    the map with the path, to look at
  $result/map.yaml        the map for ROS and Nav2 (with map.pgm)
  $result/trajectory.tum  the pose of every scan
  $result/report.json     figures and warnings of the run
The command itself:  $gdtslam --help
Your own log:        $gdtslam map LOG
END
