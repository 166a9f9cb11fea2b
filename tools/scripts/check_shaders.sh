#!/usr/bin/env bash
# Compiles every shader as the build does and checks its SPIR-V; finds files of shaders/common that no shader includes;
# compiles the source that C++ shares (elementary.glsl) by itself, so that it stays valid in both.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
shared_with_cpp=elementary.glsl

# compile FILE: its SPIR-V is checked, what it includes is noted.
compile() {
  if ! glslangValidator -V --quiet --target-env vulkan1.2 -I"$root/shaders" --depfile "$work/out.d" \
      -o "$work/out.spv" "$1" || ! spirv-val --target-env vulkan1.2 "$work/out.spv"; then
    echo "in $1" >&2
    exit 1
  fi
  cat "$work/out.d" >>"$work/includes"
}

count=0
while IFS= read -r -d '' file; do
  compile "$file"
  count=$((count + 1))
done < <(find "$root/shaders" -maxdepth 1 -name '*.comp' -print0 | sort -z)

{ printf '#version 450\n#line 1\n' && cat "$root/shaders/common/$shared_with_cpp" && printf 'void main() {}\n'; } \
  >"$work/shared.comp"
compile "$work/shared.comp"

status=0
while IFS= read -r -d '' file; do
  if ! grep -qF "common/$(basename "$file")" "$work/includes"; then
    echo "$file: no shader includes it" >&2
    status=1
  fi
done < <(find "$root/shaders/common" -name '*.glsl' -print0 | sort -z)
if [[ $status -ne 0 ]]; then exit 1; fi
echo "$count shaders compile"
