#!/usr/bin/env bash
# From a clean clone to maps and pictures: installs the packages, builds, simulates the sample offices, maps them in 2D and
# 3D, compares the trajectory with the truth, draws map, cloud and linkage, and says where everything is. Can be run again
# at any time; a second run rebuilds nothing.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd)
step_count=7
source "$root/tools/scripts/common.sh"

usage() {
  cat <<'USAGE'
Usage: tools/run.sh

Installs what is missing (Debian 12; root or sudo), builds gdtslam into build/release, simulates drives through the
sample offices and maps them: in 2D into runs/office-loop, in 3D, with the nodding laser, into runs/office-7f. Pictures
of both, a page to turn the cloud in, and a film of the linkage come into runs/pictures; neither a display nor a GPU is
needed. GDTSLAM_JOBS=N limits the compiler processes.
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
floor=$runs/office-7f
pictures=$runs/pictures

report_failure() {
  local status=$?
  if ((status)); then echo "run.sh: failed in step $step_number, $step_title (status $status)" >&2; fi
}
trap report_failure EXIT

step "Packages"
"$root/tools/install-packages.sh" build

step "Build (Release)"
mkdir -p "$root/build" "$runs" "$pictures"
configure "$build" -DCMAKE_BUILD_TYPE=Release -DGDTSLAM_BUILD_TESTS=OFF -DGDTSLAM_WERROR=OFF \
  -DCMAKE_UNITY_BUILD=ON
cmake --build "$build" --parallel "$(build_jobs)"

step "Simulate the sample office"
"$gdtslam" simulate office-loop -o "$log" --force

step "Map it"
"$gdtslam" map "$log" -o "$result" --force

step "Compare with the truth"
"$gdtslam" evaluate "$result/trajectory.tum" --reference "$truth"

step "Map in 3D: a floor with the nodding laser"
"$gdtslam" simulate office-7f -o "$floor.log" --force
"$gdtslam" map "$floor.log" -o "$floor" --force

step "Pictures"
"$gdtslam" render "$result" -o "$pictures/map.png" --force
"$gdtslam" render "$floor" -o "$pictures/cloud.png" --force
"$gdtslam" render "$floor" -o "$pictures/cloud.html" --force
"$gdtslam" render paper-b -o "$pictures/linkage.gif" --force
finish_step

cat <<END

Done. The results:
  $pictures/map.png       the map with the path
  $pictures/cloud.png     the 3D cloud of the second office
  $pictures/cloud.html    the same, to turn and play in a browser
  $pictures/linkage.gif   the linkage that nods the laser
  $result/map.yaml        the map for ROS and Nav2 (with map.pgm)
  $result/trajectory.tum  the pose of every scan
  $result/report.json     figures and warnings of the run
  $floor/cloud.ply        the cloud itself
The command itself:  $gdtslam --help
Your own log:        $gdtslam map LOG
END
