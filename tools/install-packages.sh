#!/usr/bin/env bash
# Installs the Debian 12 packages that gdtslam needs, and only those that are missing: when all are there it touches
# neither the network nor the package database. Runs as root or through sudo. docs/dependencies.md says why each is here.
set -euo pipefail

# To build and run the libraries and the command. The Vulkan backend needs headers and compilers of shaders here, and no
# driver: it looks for one when it is used.
build_packages=(
  g++ cmake ninja-build pkg-config
  libeigen3-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev libcli11-dev
  libpng-dev libssl-dev zlib1g-dev libbz2-dev liblz4-dev libzstd-dev liblzma-dev libsqlite3-dev
  libembree-dev libceres-dev libnanoflann-dev libwebsockets-dev
  libvulkan-dev libglm-dev glslang-tools spirv-tools
  libvtk9-dev libegl-dev libglew-dev libcairo2-dev ffmpeg
  help2man
)
# To compute with Vulkan where the GPU's vendor brought no driver: the loader and Mesa's drivers, lavapipe (which computes
# on the processor) among them.
vulkan_packages=(libvulkan1 mesa-vulkan-drivers)
# To build the site of the documentation (tools/scripts/make_site.sh).
docs_packages=(python3-sphinx python3-myst-parser furo python3-breathe doxygen)
# To build and run the tests, the checks and the benchmark's peer.
test_packages=(
  git ccache libgtest-dev libgmock-dev librapidcheck-dev libmpfr-dev libgsl-dev libnlopt-cxx-dev libpagmo-dev
  libbenchmark-dev libbenchmark-tools python3-scipy python3-matplotlib python3-jinja2
  clang libclang-rt-14-dev clang-tidy clang-format shellcheck
  sqlite3 zstd python3 python3-jsonschema python3-yaml chromium
  python3-numpy python3-pip python3-setuptools python3-wheel rustc patchelf
  munge slurmctld slurmd slurm-client parallel
  zsh bash-completion man-db mandoc
  dpkg-dev debhelper dh-python lintian
  locales openssh-client gnupg gpgv
  "${vulkan_packages[@]}" vulkan-validationlayers "${docs_packages[@]}"
)

usage() {
  cat <<'USAGE'
Usage: tools/install-packages.sh [build|vulkan|docs|test|all] [--list]

  build    what the libraries and the gdtslam command need (default)
  vulkan   a Vulkan loader and Mesa's drivers, to run with: for GPUs by AMD and Intel, and lavapipe, which needs no GPU
  docs     what the site of the documentation is built with
  test     what the tests and checks need besides, vulkan and docs among it
  all      all of them
  --list   print the packages with their state, install nothing
USAGE
}

group=build
list_only=false
for argument in "$@"; do
  case "$argument" in
    build | vulkan | docs | test | all) group=$argument ;;
    --list) list_only=true ;;
    -h | --help) usage; exit 0 ;;
    *) echo "install-packages: unknown argument '$argument'" >&2; usage >&2; exit 2 ;;
  esac
done

case "$group" in
  build) packages=("${build_packages[@]}") ;;
  vulkan) packages=("${vulkan_packages[@]}") ;;
  docs) packages=("${docs_packages[@]}") ;;
  test) packages=("${test_packages[@]}") ;;
  all) packages=("${build_packages[@]}" "${test_packages[@]}") ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-packages: this is no Debian system (no dpkg or apt-get). Install the equivalents of:" >&2
  echo "  ${packages[*]}" >&2
  exit 69
fi

# A package may be there for several architectures.
is_installed() { [[ " $(dpkg-query -W -f '${db:Status-Status} ' "$1" 2>/dev/null) " == *" installed "* ]]; }

missing=()
for package in "${packages[@]}"; do
  if is_installed "$package"; then state=installed; else state=missing; missing+=("$package"); fi
  if $list_only; then printf '%-24s %s\n' "$package" "$state"; fi
done
if $list_only; then exit 0; fi
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "all ${#packages[@]} packages of group '$group' are installed"
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    echo "install-packages: missing packages, and neither root nor sudo to install them. As root, run:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 69
  fi
  as_root=(sudo)
fi

echo "installing ${#missing[@]} of ${#packages[@]} packages: ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300)
install=("${apt[@]}" install -y --no-install-recommends "${missing[@]}")
# The package lists may be absent or stale: the first try needs them only when they are good.
if ! "${install[@]}" </dev/null >/dev/null 2>&1; then
  "${apt[@]}" update </dev/null
  "${install[@]}" </dev/null
fi
for package in "${missing[@]}"; do
  is_installed "$package" || { echo "install-packages: '$package' is still not installed" >&2; exit 1; }
done
