#!/usr/bin/env bash
# Packages a build tree for Debian twice, in folders of different names, and compares the bytes; checks the packages with
# lintian; installs them with apt, offline, in a root of its own that has only what they depend on, and uses them there.
# Usage: packages.sh BUILD_TREE SOURCE WORK_FOLDER [PART...], where PART is what the packages must have: library, pages.
# Exit 77: this machine has no means to build packages or lets nobody make such a root (skipped).
set -euo pipefail
here=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)
build=$(realpath "$1") source=$(realpath "$2") work=$3
parts=" ${*:4} "
PATH=$PATH:/usr/sbin:/sbin

skip() {
  echo "SKIPPED: $*"
  if [[ ${GDTSLAM_REQUIRE_PROGRAMS:-0} == 1 ]]; then exit 1; fi
  exit 77
}
fail() { echo "FAILED: $*" >&2; exit 1; }
has() { [[ $parts == *" $1 "* ]]; }
for program in dpkg-buildpackage dh lintian; do
  command -v "$program" >/dev/null || skip "no $program (packages dpkg-dev, debhelper, lintian)"
done
for package in man-db bash-completion python3; do
  [[ -e /usr/share/doc/$package ]] || skip "no package $package to make the root of"
done

# files: the names of what git tracks or does not ignore; of an unpacked archive, or a clone that git refuses to read, of all
# but what is built.
files() {
  if [[ -e $source/.git ]] && git -C "$source" ls-files -z --cached --others --exclude-standard 2>/dev/null; then return; fi
  (cd "$source" && find . \( -name build -o -path './build-*' -o -path ./runs -o -name .git -o -name __pycache__ \) -type d -prune \
    -o ! -type d -print0)
}

# package FOLDER: the packages of a copy of the files, beside it. Packed fast: what is compared is what is inside.
package() {
  local folder=$1
  mkdir -p "$folder/gdtslam"
  # What was deleted and is tracked still is no file.
  files | tar -C "$source" --ignore-failed-read --warning=no-failed-read --null -T - -cf - | tar -C "$folder/gdtslam" -xf -
  (cd "$folder/gdtslam" && DPKG_DEB_COMPRESSOR_TYPE=gzip DPKG_DEB_COMPRESSOR_LEVEL=1 GDTSLAM_BUILD_TREE=$build \
    dpkg-buildpackage --build=binary -us -uc -d --no-sign >"$folder/build.log" 2>&1) || {
    tail -n 40 "$folder/build.log" >&2
    fail "dpkg-buildpackage"
  }
}

rm -rf "$work"
mkdir -p "$work/a" "$work/another-folder"
package "$work/a"
package "$work/another-folder"
for deb in "$work"/a/*.deb; do
  cmp "$deb" "$work/another-folder/$(basename "$deb")" || fail "two builds differ: $(basename "$deb")"
done
debs=("$work"/a/*.deb)
echo "the same bytes twice: $(basename -a "${debs[@]}" | paste -sd ' ')"
wanted=(gdtslam gdtslam-doc libgdtslam-dev)
if has library; then wanted+=(libgdtslam0 python3-gdtslam); fi
for name in "${wanted[@]}"; do
  compgen -G "$work/a/${name}_*.deb" >/dev/null || fail "there is no package $name"
done

lintian --fail-on error --tag-display-limit 0 "$work"/a/*.changes >"$work/lintian.txt" || {
  grep '^E:' "$work/lintian.txt" >&2
  fail "lintian"
}
echo "lintian: no error, $(grep -c '^W:' "$work/lintian.txt" || true) warnings"

root=$work/root
python3 "$here/debian_root.py" "$root" apt man-db bash-completion "${debs[@]}"
mkdir -p "$root/packages"
cp "${debs[@]}" "$root/packages/"
cp "$here/in_debian_root.sh" "$root/in_debian_root.sh"

# With mounts that end with their namespace, whatever happens.
in_root() {
  local as_root=()
  if [[ $(id -u) -ne 0 ]]; then as_root=(--map-root-user); fi
  # shellcheck disable=SC2016  # expanded by the inner shell
  unshare "${as_root[@]}" --mount --pid --fork --kill-child --net sh -euc '
    root=$1
    shift
    touch "$root/dev/null"
    mount --bind /dev/null "$root/dev/null"
    ln -sfn /proc/self/fd "$root/dev/fd"
    mount -t proc proc "$root/proc" || mount --rbind /proc "$root/proc"
    exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root TERM=dumb LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
      "$(command -v chroot)" "$root" "$@"' sh "$root" "$@" </dev/null
}
in_root /bin/sh -c : || skip "this machine lets this user make no private root (unshare, mount or chroot is refused)"
in_root /bin/bash /in_debian_root.sh "${@:4}"
rm -rf "$root"
