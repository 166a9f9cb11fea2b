#!/usr/bin/env bash
# Builds the command for arm64 on a Debian 12 of another architecture, and holds the hashes of the samples that it maps under
# qemu against those that ship with it: tools/scripts/cross_arm64.sh [BUILD] (default build/arm64). Without viewer, Vulkan,
# simulator and calibration. Libraries of arm64 are unpacked into BUILD/root and not installed; needs g++-aarch64-linux-gnu,
# qemu-user-static and pkg-config, and apt's lists of arm64 (dpkg --add-architecture arm64; apt-get update).
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
mkdir -p "${1:-$root/build/arm64}"
build=$(cd "${1:-$root/build/arm64}" && pwd)
step_count=4
source "$root/tools/scripts/common.sh"
triplet=aarch64-linux-gnu
target=$build/root
packages=(
  libc6 libstdc++6 libgcc-s1 libfmt-dev libfmt9 libyaml-cpp-dev libyaml-cpp0.7 libpng-dev libpng16-16 libssl-dev libssl3
  zlib1g-dev zlib1g libbz2-dev libbz2-1.0 liblz4-dev liblz4-1 libzstd-dev libzstd1 liblzma-dev liblzma5
  libsqlite3-dev libsqlite3-0 libcairo2-dev libcairo2
  libpixman-1-0 libfontconfig1 libfreetype6 libexpat1 libbrotli1 libuuid1 libx11-6 libxext6 libxrender1 libxcb1 libxcb-render0
  libxcb-shm0 libxau6 libxdmcp6 libbsd0 libmd0
)
for program in "$triplet-g++" qemu-aarch64-static pkg-config; do
  command -v "$program" >/dev/null || {
    echo "cross_arm64.sh: there is no $program; apt-get install g++-$triplet qemu-user-static pkg-config" >&2
    exit 69
  }
done

step "Libraries of arm64"
if [[ ! -f $target/complete ]]; then
  rm -rf "$target" "$build/packages"
  mkdir -p "$target" "$build/packages"
  (cd "$build/packages" && apt-get download -qq "${packages[@]/%/:arm64}" 2>&1 | sed '/unsandboxed/d')
  for package in "$build"/packages/*.deb; do dpkg -x "$package" "$target"; done
  sed -i '/^Requires.private/d' "$target/usr/lib/$triplet/pkgconfig/cairo.pc"  # headers of X and GLib, which we do not use
  touch "$target/complete"
fi

step "Configure"
cat >"$build/toolchain.cmake" <<TOOLCHAIN
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER $triplet-gcc)
set(CMAKE_CXX_COMPILER $triplet-g++)
set(CMAKE_LIBRARY_ARCHITECTURE $triplet)
set(CMAKE_FIND_ROOT_PATH "$target")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE BOTH)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE BOTH)
include_directories(BEFORE SYSTEM "$target/usr/include" "$target/usr/include/$triplet")
link_directories("$target/usr/lib/$triplet" "$target/lib/$triplet")
add_link_options("-Wl,-rpath-link,$target/usr/lib/$triplet:$target/lib/$triplet")
TOOLCHAIN
export PKG_CONFIG_LIBDIR=$target/usr/lib/$triplet/pkgconfig PKG_CONFIG_SYSROOT_DIR=$target
configure "$build/tree" "-DCMAKE_TOOLCHAIN_FILE=$build/toolchain.cmake" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_UNITY_BUILD=ON -DGDTSLAM_WERROR=OFF -DGDTSLAM_BUILD_TESTS=OFF -DGDTSLAM_BUILD_EXAMPLES=OFF \
  -DGDTSLAM_BUILD_SIM=OFF -DGDTSLAM_BUILD_CALIBRATION=OFF -DGDTSLAM_BUILD_VULKAN=OFF -DGDTSLAM_BUILD_VIEWER=OFF \
  -DGDTSLAM_BUILD_LAB=OFF -DGDTSLAM_BUILD_LIVE_PAGE=OFF

step "Build"
cmake --build "$build/tree" --parallel "$(build_jobs)" --target gdtslam

step "The samples under qemu"
ln -sfn "$root/assets" "$build/assets"  # where the command looks for what comes with it
run() { QEMU_LD_PREFIX=$target qemu-aarch64-static "$build/tree/bin/gdtslam" "$@"; }
run --version
for sample in office-start nodding-start; do
  rm -f "$build/$sample.json"
  run verify --force --write-expected "$build/$sample.json"
  cmp "$build/$sample.json" "$root/assets/expected/$sample.json"
  echo "$sample: maps, trajectories and clouds have the hashes that ship"
done
finish_step
