#!/usr/bin/env bash
# Compiles every shader, and what shaders share (shaders/common) inside an empty one, so that source that is common to
# C++ and GLSL stays valid in both.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

compile() { glslangValidator -V --quiet --target-env vulkan1.2 -I"$root/shaders" -o "$work/out.spv" "$1"; }

count=0
while IFS= read -r -d '' file; do
  source=$file
  if [[ $file == *.glsl ]]; then
    source=$work/wrapped.comp
    { printf '#version 450\n#line 1\n' && cat "$file" && printf 'void main() {}\n'; } >"$source"
  fi
  compile "$source" || { echo "in $file" >&2; exit 1; }
  count=$((count + 1))
done < <(find "$root/shaders" \( -name '*.comp' -o -name '*.glsl' \) -print0 | sort -z)
echo "$count shader sources compile"
