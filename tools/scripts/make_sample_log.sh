#!/usr/bin/env bash
# Makes the sample log again, its truth, and what every host and device must get out of it: assets/logs/office-start.log.gz
# and assets/expected/office-start.json, which `gdtslam verify` checks. The log changes with the simulator only; the
# expected results change with the mapper, and then on purpose.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

gdtslam=${1:-$root/build/release/bin/gdtslam}
if [[ ! -x $gdtslam ]]; then
  echo "make_sample_log: no program at $gdtslam; build it (tools/run.sh) or name it" >&2
  exit 69
fi
logs=$root/assets/logs
"$gdtslam" simulate office-loop --trajectory "$logs/office-start.path.yaml" --rate 6 --seed 1 -o "$logs/office-start.log.gz"
mkdir -p "$root/assets/expected"
"$gdtslam" verify --write-expected "$root/assets/expected/office-start.json"
sha256sum "$logs/office-start.log.gz"
