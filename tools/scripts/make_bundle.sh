#!/usr/bin/env bash
# Makes the relocatable bundle from a build tree with GDTSLAM_STATIC=ON; called by its target `bundle`. Refuses a program
# that needs any shared library but the C library's own.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
if (($# != 3)); then
  echo "Usage: tools/scripts/make_bundle.sh BUILD_FOLDER NAME COMPILER (better: cmake --build BUILD_FOLDER --target bundle)" >&2
  exit 2
fi
build=$1 name=$2 compiler=$3
folder=$build/bundle/$name
program=$folder/bin/gdtslam
fail() { echo "make_bundle: $*" >&2; exit 1; }

rm -rf "$build/bundle"
mkdir -p "$folder/licences"
cmake --install "$build" --component tools --strip --prefix "$folder" >"$build/bundle/install.log" || {
  cat "$build/bundle/install.log"
  fail "cannot install from $build"
}

# What the program asks for: shared libraries, and the newest version of the C library's symbols.
needed=$(readelf -d "$program" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
foreign=$(grep -vE '^(lib(c|m|dl|rt|pthread)\.so\.[0-9]+|ld-linux.*\.so\.[0-9]+)$' <<<"$needed" | paste -sd ' ' || true)
if [[ -n $foreign ]]; then fail "the program needs shared libraries that a machine may not have: $foreign"; fi
if readelf -d "$program" | grep -qE '\((RPATH|RUNPATH)\)'; then fail "the program has a run path into this machine"; fi
glibc=$(readelf -VW "$program" | grep -oE 'GLIBC_[0-9.]+' | sed 's/GLIBC_//' | sort -uV | tail -n 1)
if [[ -z $glibc ]]; then fail "cannot tell which C library the program needs"; fi

# The licences: those of the Debian package that each input belongs to, and the common texts that they name.
while read -r input; do
  owner=$(dpkg-query -S "$(readlink -f "$input")" | head -n 1 | cut -d: -f1) || fail "no package owns $input"
  package=$(basename "$(readlink -f "/usr/share/doc/$owner")") # several packages of one source may share a text
  cp -L "/usr/share/doc/$package/copyright" "$folder/licences/$package.txt" || fail "no licence text of $package"
done <"$build/bundle_inputs.txt"
cp "$root/LICENSE" "$folder/LICENSE"
while read -r text; do
  cp -L "$text" "$folder/licences/$(basename "$text").txt"
done < <(grep -ohE '/usr/share/common-licenses/[A-Za-z0-9.+-]*[A-Za-z0-9]' "$folder"/licences/*.txt | sort -u)

# What the program says of itself (cmake/GdtslamStamp.cmake): no tag of this clone counts.
commit=${GDTSLAM_COMMIT:-}
date=${SOURCE_DATE_EPOCH:-}
if [[ -e $root/.git ]] && revision=$(git -C "$root" log -1 --format='%h %ct' --abbrev=12 2>/dev/null); then
  if ! git -C "$root" diff --quiet HEAD --; then revision=${revision/ /-changed }; fi
  commit=${commit:-${revision% *}}
  date=${date:-${revision#* }}
fi
commit=${commit:-unknown}
date=${date:-0}
cat >"$folder/BUILD" <<END
name=$name
commit=$commit
compiler=$compiler
glibc_needed=$glibc
END
sed "s/@GLIBC@/$glibc/g; s/@NAME@/$name/g" "$root/tools/scripts/bundle_readme.md" >"$folder/README.md"
install -m 755 "$root/tools/scripts/gpu_server.sh" "$folder/gpu_server.sh"
chmod -R u=rwX,go=rX "$folder"

# The same build gives the same archive, byte for byte.
tar -C "$build/bundle" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$date" -cf - "$name" |
  gzip -9n >"$build/bundle/$name.tar.gz"
printf '%s: %s, %s.tar.gz: %s; needs glibc %s or newer and nothing else\n' "$name" "$(du -sh "$folder" | cut -f1)" \
  "$name" "$(du -h "$build/bundle/$name.tar.gz" | cut -f1)" "$glibc"
