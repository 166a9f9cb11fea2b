#!/usr/bin/env bash
# Runs the relocatable bundle in a root of its own, where there is nothing but the C library, a shell with its small
# programs, and the bundle: first without any Vulkan, then (vulkan) with the loader and lavapipe beside it.
# Usage: bare_root.sh cpu|vulkan BUNDLE.tar.gz WORK_FOLDER. Exit 77: this machine lets nobody make such a root (skipped).
set -euo pipefail
here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
kind=$1 archive=$2 work=$3
root=$work/root
PATH=$PATH:/usr/sbin:/sbin # for chroot and ldconfig, which an ordinary user does not see

# Everything of a program or library that the loader needs, at the same paths.
copy_with_libraries() {
  local file=$1 listing
  listing=$(ldd "$file")
  if grep -q 'not found' <<<"$listing"; then echo "$file: incomplete on this machine" >&2 && return 1; fi
  { echo "$file" && grep -oE '/[^ ]+' <<<"$listing"; } | sort -u | while read -r path; do
    if [[ ! -e $root$path ]]; then install -D "$(readlink -f "$path")" "$root$path"; fi
  done
}

make_root() {
  local program
  rm -rf "$root"
  mkdir -p "$root"/{bin,etc,home,opt,proc,dev,tmp}
  for program in sh awk basename cat chmod cp cut date dirname getconf grep head mkdir mv nproc rm sed tail tee tr uname; do
    copy_with_libraries "$(command -v "$program")"
    if [[ ! -e $root/bin/$program ]]; then ln -s "$(command -v "$program")" "$root/bin/$program"; fi
  done
  touch "$root/dev/null"
  tar -C "$root/opt" -xzf "$archive"
  mv "$root"/opt/gdtslam-* "$root/opt/moved here" # a bundle is bound to no place, and its path may have a blank
  cp "$here/in_bare_root.sh" "$root/in_bare_root.sh"
}

library() { ldconfig -p | sed -n "s/^[[:space:]]*$1 .*=> //p" | head -n 1; }

# The loader, where libraries are looked for, and the driver that its description names.
add_lavapipe() {
  local loader description driver
  loader=$(library libvulkan.so.1)
  description=$(find /usr/share/vulkan/icd.d -name 'lvp_icd*.json' 2>/dev/null | head -n 1)
  if [[ -z $loader || -z $description ]]; then
    echo "SKIPPED: no Vulkan loader or no lavapipe on this machine (packages libvulkan1, mesa-vulkan-drivers)"
    if [[ ${GDTSLAM_REQUIRE_VULKAN:-0} == 1 ]]; then exit 1; fi
    exit 77
  fi
  driver=$(sed -n 's/.*"library_path": *"\([^"]*\)".*/\1/p' "$description")
  if [[ $driver != /* ]]; then driver=$(library "$driver"); fi
  copy_with_libraries "$loader"
  copy_with_libraries "$driver"
  install -D -m 644 "$description" "$root$description"
}

# in_root PROGRAM...: with mounts that end with their namespace, whatever happens.
in_root() {
  local as_root=()
  if [[ $(id -u) -ne 0 ]]; then as_root=(--map-root-user); fi
  # shellcheck disable=SC2016  # expanded by the inner shell
  unshare "${as_root[@]}" --mount --pid --fork --kill-child sh -euc '
    root=$1
    shift
    mount --bind /dev/null "$root/dev/null"
    mount -t proc proc "$root/proc" || mount --rbind /proc "$root/proc"
    exec env -i PATH=/bin HOME=/home "$(command -v chroot)" "$root" "$@"' sh "$root" "$@" </dev/null
}

mkdir -p "$work"
make_root
if ! in_root /bin/sh -c :; then
  echo "SKIPPED: this machine lets this user make no private root (unshare, mount or chroot is refused)"
  exit 77
fi
if [[ $kind == vulkan ]]; then add_lavapipe; fi
echo "in the root: $(find "$root" -name '*.so*' | wc -l) shared libraries, $(du -sh "$root" | cut -f1)"
if find "$root" -name '*.so*' | grep -E '/lib(fmt|yaml-cpp|png|embree)'; then
  echo "the root has what the bundle must do without" >&2
  exit 1
fi

status=0
in_root /bin/sh /in_bare_root.sh "$kind" || status=$?
if [[ $status -eq 0 && $kind == vulkan ]]; then
  python3 - "$root/tmp/report" <<'CHECK' || status=1
import json, pathlib, sys
folder = pathlib.Path(sys.argv[1])
files = sorted(folder.glob("*.json"))
for file in files:
    json.loads(file.read_text())
names = {file.name for file in files}
assert "devices.json" in names, names
page = (folder / "report.md").read_text()
assert "llvmpipe" in page.splitlines()[0], page.splitlines()[0]
for matcher in ("gauss-newton", "exhaustive"):
    rows = [line for line in page.splitlines() if line.startswith(f"| office-start.log | {matcher} |")]
    assert len(rows) == 3 and len({tuple(row.split("|")[-3:-1]) for row in rows}) == 1, rows
CHECK
fi
rm -rf "$root"
exit "$status"
