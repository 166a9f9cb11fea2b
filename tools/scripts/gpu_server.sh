#!/bin/sh
# The one command for a machine with a GPU, inside the bundle: lists the devices, proves that the GPU gives the same bits as
# the CPU (every kernel, whole logs), maps logs on both with the times of each, and writes all of it into one folder with a
# page that can be sent or put into docs/benchmarks.md. Asks for nothing but /bin/sh and the usual small programs.
set -eu
export LC_ALL=C # numbers with a point

usage() {
  cat <<'USAGE'
Usage: gpu_server.sh [--device NAME] [--output DIR] [--repeat N] [LOG ...]

Proves and measures gdtslam on a GPU; the results are in DIR/report.md and beside it.

  --device NAME   vulkan (default: the first hardware GPU) or vulkan:N, also one that is no hardware ('gdtslam doctor --devices')
  --output DIR    a new folder (default: gdtslam-report-<UTC time> in the current folder)
  --repeat N      runs of each log on each device, the fastest counts (default 3)
  LOG             CARMEN logs to verify and map beside the sample log

Exit 0: everything equal; 1: a difference, or something failed; 2: wrong usage; 69: no such Vulkan device here.
USAGE
}
wrong_usage() { echo "gpu_server: $1" >&2; usage >&2; exit 2; }
unavailable() { echo "gpu_server: $1" >&2; exit 69; }

here=$(cd "$(dirname "$0")" && pwd)
gdtslam=${GDTSLAM:-$here/bin/gdtslam}
sample_logs=${GDTSLAM_ASSETS:-$here/share/gdtslam}/logs
device=vulkan
output=gdtslam-report-$(date -u +%Y%m%dT%H%M%SZ)
repeat=3
while [ $# -gt 0 ]; do
  case "$1" in
    --device | --output | --repeat)
      [ $# -ge 2 ] || wrong_usage "$1 needs a value"
      case "$1" in --device) device=$2 ;; --output) output=$2 ;; --repeat) repeat=$2 ;; esac
      shift 2
      ;;
    -h | --help) usage; exit 0 ;;
    --) shift; break ;;
    -*) wrong_usage "unknown option '$1'" ;;
    *) break ;;
  esac
done
case "$device" in vulkan | vulkan:[0-9]*) ;; *) wrong_usage "--device is vulkan or vulkan:N, not '$device'" ;; esac
case "$repeat" in '' | 0* | *[!0-9]*) wrong_usage "--repeat is a number from 1, not '$repeat'" ;; esac
for log in "$@"; do [ -r "$log" ] || wrong_usage "cannot read the log '$log'"; done
[ -x "$gdtslam" ] || unavailable "no program at $gdtslam"

listing=$("$gdtslam" doctor --devices --json)
# kinds_of NAME: the kind of the Vulkan device NAME ("vulkan": of each) that can be used, a line each.
kinds_of() {
  printf '%s\n' "$listing" | awk -v name="$1" '
    { value = $2; gsub(/[",]/, "", value) }
    $1 == "\"device\":" { found = index(value, "vulkan:") == 1 && (name == "vulkan" || value == name) }
    $1 == "\"kind\":" { kind = value }
    $1 == "\"problem\":" && value == "null" && found { print kind }'
}
is_hardware() { case "$1" in discrete | integrated | virtual) return 0 ;; *) return 1 ;; esac; }
# A processor that plays a GPU proves nothing of a GPU whose driver does not load: it is taken only by its number.
device_kind=
for kind in $(kinds_of "$device"); do
  if [ "$device" != vulkan ] || is_hardware "$kind"; then device_kind=$kind && break; fi
done
if [ -z "$device_kind" ]; then
  "$gdtslam" doctor --devices
  if [ "$device" = vulkan ]; then
    unavailable "there is no hardware GPU here that can be used; its driver may be missing or not load (README.md, 'When no device is found'). --device vulkan:N proves another device"
  fi
  unavailable "there is no device '$device' here that can be used"
fi
is_hardware "$device_kind" || echo "NO GPU: $device is no hardware ($device_kind); what follows says nothing of a GPU"
mkdir "$output" || wrong_usage "cannot make the folder '$output'; name another with --output"
page=$output/report.md
work=$output/runs
mkdir "$work"
trap 'rm -rf "$work"' EXIT

status=0
failures=
device_name=$device
failed() {
  echo "FAILED: $1"
  failures="$failures* **FAILED**: $1
"
  status=1
}
announce() { printf '\n== %s\n' "$1"; }
say() { printf '%s\n' "$*" >>"$page"; }
in_block() { { echo '```text'; cat "$1"; echo '```'; } >>"$page"; }
# value KEY FILE and seconds KEY FILE: of the first such key in a JSON file of gdtslam, which has one key a line.
seconds() { printf '%.3f' "$(value "$1" "$2")"; }
value() { sed -n "s/^ *\"$1\": *//p" "$2" | head -n 1 | sed 's/,$//; s/^"//; s/"$//'; }
# made KEY: what the file BUILD says of how the bundle was made.
made() { sed -n "s/^$1=//p" "$here/BUILD" 2>/dev/null || true; }
# smaller A B: whether the number A is below B; anything is below nothing.
smaller() { [ -z "$2" ] || awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }'; }

# verify LOG...: kernels and logs; everything is shown, and kept for the page.
verify() {
  count=$#
  while [ "$count" -gt 0 ]; do
    log=$1
    shift
    set -- "$@" --log "$log"
    count=$((count - 1))
  done
  "$gdtslam" verify --device "$device" --quiet "$@" >"$output/verify.txt" 2>"$output/verify.err" ||
    failed "verify ended with status $?: $(tail -n 1 "$output/verify.err")"
  cat "$output/verify.txt"
}

# map_on LABEL LOG OPTION...: maps the log $repeat times; keeps the report of the fastest run and adds its row to the page.
# Sets run_hashes; empty where it failed.
map_on() {
  label=$1 log=$2
  shift 2
  name=$(basename "$log" .gz)
  kept="$output/$(printf '%s-%s' "$name" "$label" | tr ' :/' '---').json"
  run_hashes=
  best=
  run=0
  while [ "$run" -lt "$repeat" ]; do
    run=$((run + 1))
    rm -rf "$work/one"
    "$gdtslam" map "$log" -o "$work/one" --matcher exhaustive --no-fallback --quiet "$@" || {
      failed "mapping $name with $* ended with status $?"
      return 0
    }
    report=$work/one/report.json
    hashes="$(value map_sha256 "$report") $(value trajectory_sha256 "$report")"
    if [ "${run_hashes:=$hashes}" != "$hashes" ]; then failed "two runs of $name with $* differ"; fi
    seconds=$(value wall_s "$report")
    if smaller "$seconds" "$best"; then best=$seconds && cp "$report" "$kept"; fi
  done
  row="| $name | $label: $(value name "$kept") | $(value scans "$kept") | $(seconds wall_s "$kept") |"
  row="$row $(seconds match "$kept") | $(seconds cpu_s "$kept") | $(value dispatches "$kept") | $(value submissions "$kept") |"
  row="$row $(value map_sha256 "$kept" | cut -c 1-12) | $(value trajectory_sha256 "$kept" | cut -c 1-12) |"
  echo "$row"
  say "$row"
}

# compare LOG: on the processor and on the device; the hashes must be the same.
compare() {
  map_on "cpu, 1 thread" "$1" --device cpu --threads 1
  reference=$run_hashes
  map_on "cpu, all threads" "$1" --device cpu --threads 0
  every=$run_hashes
  map_on "$device" "$1" --device "$device"
  if [ -n "$run_hashes" ]; then device_name=$(value name "$kept"); fi
  if [ -z "$reference" ] || [ "$reference" != "$run_hashes" ] || [ "$reference" != "$every" ]; then
    failed "$(basename "$1"): the map or the trajectory is not the same on every device"
  fi
}

announce "Devices"
"$gdtslam" doctor --devices | tee "$output/devices.txt"
printf '%s\n' "$listing" >"$output/devices.json"

announce "Verify: the same bits as the processor gives ($device)"
verify "$@"

announce "Whole logs, matched exhaustively, on the processor and on $device: the fastest of $repeat"
header='| log | device | scans | wall s | matching s | CPU s | dispatches | submissions | map | trajectory |'
printf '%s\n%s\n' "$header" '|---|---|---|---|---|---|---|---|---|---|' >"$page"
echo "$header"
for log in "$sample_logs"/*.log.gz "$@"; do compare "$log"; done
mv "$page" "$output/logs.md"

# The page: what ran where, then everything that was printed.
system=$(sed -n 's/^PRETTY_NAME=//p' /etc/os-release 2>/dev/null | tr -d '"')
processor=$(sed -n 's/^model name[[:space:]]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)
title="$("$gdtslam" --version | sed -n 1p) on $device_name"
is_hardware "$device_kind" || title="$title, no hardware GPU ($device_kind)"
say "# $title"
say ""
say "| | |"
say "|---|---|"
say "| date | $(date -u +%Y-%m-%dT%H:%M:%SZ) |"
say "| build | $(made name), commit $(made commit), $(made compiler) |"
say "| processor | ${processor:-unknown}, $(nproc 2>/dev/null || echo '?') threads |"
say "| system | ${system:-unknown}, $(uname -srm), $(getconf GNU_LIBC_VERSION 2>/dev/null || echo 'C library unknown') |"
say "| device asked for | $device |"
say ""
if [ -n "$failures" ]; then say "$failures"; else say "Everything is equal on the processor and on the device."; fi
say ""
say "## Whole logs, \`--matcher exhaustive\`, the fastest of $repeat"
say ""
cat "$output/logs.md" >>"$page"
say ""
for part in "verify:The same bits" "devices:Devices"; do
  say ""
  say "## ${part#*:}"
  say ""
  in_block "$output/${part%%:*}.txt"
done
rm "$output/logs.md"

announce "Done: $page"
if [ "$status" -eq 0 ]; then echo "Everything is equal on the processor and on the device."; else printf '%s' "$failures"; fi
exit "$status"
