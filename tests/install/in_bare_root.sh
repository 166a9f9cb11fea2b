#!/bin/sh
# What bare_root.sh runs inside the root; $1: cpu (there is no Vulkan) or vulkan (lavapipe).
set -eu
bundle='/opt/moved here'
sample="$bundle/share/gdtslam/logs/office-start.log.gz"
expected="$bundle/share/gdtslam/expected/office-start.json"
mkdir -p /tmp/out
cd /tmp/out

# expect STATUS COMMAND...: the output is kept in out and err, and shown where the status is another.
expect() {
  wanted=$1
  shift
  found=0
  "$@" >out 2>err || found=$?
  if [ "$found" -ne "$wanted" ]; then
    echo "exit $found instead of $wanted: $*"
    cat out err
    exit 1
  fi
  echo "ok, exit $found: $*"
}
contains() { grep -qe "$2" "$1" || { echo "no '$2' in:"; cat "$1"; exit 1; }; }
gdtslam() { wanted=$1; shift; expect "$wanted" "$bundle/bin/gdtslam" "$@"; }

# map OPTION...: the sample log gives the hashes that are shipped, which are of the front end alone.
map() {
  rm -rf map
  gdtslam 0 map "$sample" -o map --no-loops --quiet "$@"
  for key in map_sha256 trajectory_sha256; do
    hash=$(sed -n "s/^ *\"$key\": \"\([0-9a-f]*\)\".*/\1/p" map/report.json)
    [ "${#hash}" -eq 64 ] || { echo "no $key in the report"; exit 1; }
    contains "$expected" "\"$key\": \"$hash\""
  done
}

# refused COMMAND...: there is no such device, said in one line.
refused() {
  gdtslam 69 "$@" --device vulkan
  [ "$(grep -c . err)" -eq 1 ] || { echo "not one line:"; cat err; exit 1; }
}

gdtslam 0 --version
for matcher in gauss-newton exhaustive; do map --device cpu --matcher "$matcher"; done
map --device auto --matcher exhaustive # without a hardware GPU: the processor
gdtslam 0 map "$sample" -o loops --quiet --device cpu
contains loops/report.json '"loops": {'
gdtslam 0 doctor --devices
cat out

if [ "$1" = cpu ]; then
  gdtslam 0 verify --device cpu --quiet
  contains out '^PASS: 0 differences'
  refused verify
  refused map "$sample" -o no
  [ ! -e no ] || { echo "a folder of results without results"; exit 1; }
  expect 69 "$bundle/gpu_server.sh"
  contains err 'driver'
  exit 0
fi

contains out 'llvmpipe'
map --device vulkan --matcher exhaustive --no-fallback
expect 69 "$bundle/gpu_server.sh" --output /tmp/report # lavapipe is no GPU
contains err 'no hardware GPU'
expect 0 "$bundle/gpu_server.sh" --device vulkan:0 --repeat 1 --output /tmp/report
cat out
contains out '^NO GPU'
contains /tmp/report/report.md '^Everything is equal'
contains /tmp/report/verify.txt '^PASS: 0 differences'
