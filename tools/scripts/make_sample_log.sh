#!/usr/bin/env bash
# Makes the sample logs again, their truth, and what every host and device must get out of them: in assets/logs
# office-start.log.gz, and nodding-start.log.gz of a laser that nods, and in assets/expected a file for each, which
# `gdtslam verify` checks. The logs change with the simulator only; the expected results change with the mapper, and then
# on purpose.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)

gdtslam=${1:-$root/build/release/bin/gdtslam}
if [[ ! -x $gdtslam ]]; then
  echo "make_sample_log: no program at $gdtslam; build it (tools/run.sh) or name it" >&2
  exit 69
fi
logs=$root/assets/logs
"$gdtslam" simulate office-loop --trajectory "$logs/office-start.path.yaml" --rate 6 --seed 1 -o "$logs/office-start.log.gz" --force
"$gdtslam" simulate office-3f --trajectory "$logs/nodding-start.path.yaml" --laser sick-lms --rate 5 --crank-rate 0.31 \
  --seed 1 -o "$logs/nodding-start.log.gz" --force
rm "$logs"/*.elevation.csv
mkdir -p "$root/assets/expected"
for log in office-start nodding-start; do
  "$gdtslam" verify --force --write-expected "$root/assets/expected/$log.json"
done
sha256sum "$logs"/*.log.gz
