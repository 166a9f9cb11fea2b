#!/usr/bin/env bash
# Formats every C++ source of the project with clang-format 14; with --check it only lists what differs.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
cd "$root"

formatter=clang-format
if command -v clang-format-14 >/dev/null; then formatter=clang-format-14; fi
options=(-i)
case "${1:-}" in
  '') ;;
  --check) options=(--dry-run --Werror) ;;
  *) echo "Usage: tools/scripts/format.sh [--check]" >&2; exit 2 ;;
esac

folders=()
for folder in engine calib viewer tools tests examples; do
  if [[ -d $folder ]]; then folders+=("$folder"); fi
done
find "${folders[@]}" \( -name '*.cpp' -o -name '*.hpp' \) -print0 | sort -z |
  xargs -0 -r -n 20 -P "$(nproc)" "$formatter" --style=file "${options[@]}"
