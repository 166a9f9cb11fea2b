#!/bin/sh
# The one command for a machine with a GPU, inside the bundle: proves that the GPU gives the same bits as the CPU (every
# kernel, whole logs), maps logs on both and writes a page with the times. Needs /bin/sh and the usual small programs only.
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
    -*) wrong_usage "unknown option '$1'" ;;
    *) break ;;
  esac
done
case "$device" in vulkan | vulkan:[0-9]*) ;; *) wrong_usage "--device is vulkan or vulkan:N, not '$device'" ;; esac
case "$repeat" in '' | 0* | *[!0-9]*) wrong_usage "--repeat is a number from 1, not '$repeat'" ;; esac
for log in "$@"; do [ -r "$log" ] || wrong_usage "cannot read the log '$log'"; done
[ -x "$gdtslam" ] || unavailable "no program at $gdtslam"

# A CPU that plays a GPU proves nothing about a GPU whose driver does not load, so it is taken only by its number.
kind=$("$gdtslam" doctor --devices --json | awk -v name="$device" '
  { value = $2; gsub(/[",]/, "", value) }
  $1 == "\"device\":" { found = index(value, "vulkan:") == 1 && (name == "vulkan" || value == name) }
  $1 == "\"kind\":" { kind = value }
  $1 == "\"problem\":" && value == "null" && found && (name != "vulkan" || kind ~ /^(discrete|integrated|virtual)$/) { print kind; exit }')
if [ -z "$kind" ]; then
  "$gdtslam" doctor --devices
  [ "$device" = vulkan ] || unavailable "there is no device '$device' here that can be used"
  unavailable "there is no hardware GPU here that can be used; its driver may be missing or not load (README.md, 'When no device is found'). --device vulkan:N proves another device"
fi
title=
case "$kind" in
  discrete | integrated | virtual) ;;
  *) title=", no hardware GPU ($kind)" && echo "NO GPU: $device is no hardware ($kind); what follows says nothing of a GPU" ;;
esac
mkdir "$output" || wrong_usage "cannot make the folder '$output'; name another with --output"
work=$output/runs
mkdir "$work"
trap 'rm -rf "$work"' EXIT
failures=
failed() {
  echo "FAILED: $1"
  failures="$failures* **FAILED**: $1
"
}
# value KEY FILE: the first such key in a JSON file of gdtslam, which has one key a line.
value() { sed -n "s/^ *\"$1\": *//p" "$2" | head -n 1 | sed 's/,$//; s/^"//; s/"$//'; }

# map_on LABEL LOG OPTION...: maps the log by $matcher $repeat times and keeps the row of the fastest run. Sets hashes; empty if it failed.
map_on() {
  label=$1 log=$2 hashes='' best='' run=0
  shift 2
  while [ "$run" -lt "$repeat" ]; do
    run=$((run + 1))
    rm -rf "$work/one"
    "$gdtslam" map "$log" -o "$work/one" --matcher "$matcher" --no-fallback --quiet "$@" || {
      failed "mapping $(basename "$log") with $* ended with status $?"
      return 0
    }
    r=$work/one/report.json
    found="$(value map_sha256 "$r") $(value trajectory_sha256 "$r")"
    if [ "${hashes:=$found}" != "$found" ]; then failed "two runs of $(basename "$log") with $* differ"; fi
    if [ -z "$best" ] || awk -v a="$(value wall_s "$r")" -v b="$best" 'BEGIN { exit !(a < b) }'; then
      best=$(value wall_s "$r") name=$(value name "$r")
      row="| $(basename "$log" .gz) | $matcher | $label: $name | $(value scans "$r") | $(printf '%.3f | %.3f | %.3f' "$best" "$(value match "$r")" "$(value cpu_s "$r")")"
      row="$row | $(value dispatches "$r") | $(value submissions "$r") | $(value map_sha256 "$r" | cut -c 1-12) | $(value trajectory_sha256 "$r" | cut -c 1-12) |"
    fi
  done
  echo "$row" | tee -a "$output/logs.md"
}

printf '\n== Devices\n'
"$gdtslam" doctor --devices | tee "$output/devices.txt"
"$gdtslam" doctor --devices --json >"$output/devices.json"
printf '\n== Verify: the same bits as the CPU gives (%s)\n' "$device"
(
  count=$#
  while [ "$count" -gt 0 ]; do
    log=$1 count=$((count - 1))
    shift
    set -- "$@" --log "$log"
  done
  exec "$gdtslam" verify --device "$device" --quiet "$@"
) >"$output/verify.txt" 2>"$output/verify.err" || failed "verify ended with status $?: $(tail -n 1 "$output/verify.err")"
cat "$output/verify.txt"

printf '\n== Whole logs, loops closed, on the CPU and on %s: the fastest of %s\n' "$device" "$repeat"
printf '%s\n' '| log | matcher | device | scans | wall s | matching s | CPU s | dispatches | submissions | map | trajectory |' \
  '|---|---|---|---|---|---|---|---|---|---|---|' | tee "$output/logs.md"
name=$device
for log in "${GDTSLAM_ASSETS:-$here/share/gdtslam}"/logs/*.log.gz "$@"; do
  for matcher in gauss-newton exhaustive; do
    map_on "cpu, 1 thread" "$log" --device cpu --threads 1
    reference=$hashes
    map_on "cpu, all threads" "$log" --device cpu --threads 0
    every=$hashes
    map_on "$device" "$log" --device "$device"
    if [ -n "$reference" ] && [ "$reference" = "$hashes" ] && [ "$reference" = "$every" ]; then continue; fi
    failed "$(basename "$log"), $matcher: the map or the trajectory is not the same on every device"
  done
done

verdict=${failures:-Everything is equal on the CPU and on the device.}
{
  printf '# %s on %s%s\n\n' "$("$gdtslam" --version | sed -n 1p)" "$name" "$title"
  printf '%s, device %s, %s threads, %s\n\n' "$(date -u +%Y-%m-%dT%H:%M:%SZ)" "$device" "$(nproc 2>/dev/null || echo '?')" "$(uname -srm)"
  # shellcheck disable=SC2016  # a word as code
  printf '%s\n\n## Whole logs, loops closed, by the default and by `--matcher exhaustive`, the fastest of %s\n\n' "$verdict" "$repeat"
  cat "$output/logs.md"
  for part in BUILD:"$here/BUILD" "The same bits:$output/verify.txt" Devices:"$output/devices.txt"; do
    [ -r "${part#*:}" ] || continue
    # shellcheck disable=SC2016  # the fence of a block
    printf '\n## %s\n\n```text\n%s\n```\n' "${part%%:*}" "$(cat "${part#*:}")"
  done
} >"$output/report.md"
rm "$output/logs.md"
printf '\n== Done: %s\n%s\n' "$output/report.md" "$verdict"
[ -z "$failures" ]
