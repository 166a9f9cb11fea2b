#!/usr/bin/env bash
# Builds the site of the documentation, without a network: the pages of docs/ and the reference of the public headers, as
# HTML that can be read from a folder or put on any server. A link that leads nowhere is a warning, and a
# warning is an error.
set -euo pipefail
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." && pwd)
usage() {
  cat <<'USAGE'
Usage: tools/scripts/make_site.sh [-o DIR]

  -o DIR   where the site goes [build/site]; what an earlier build left there is removed

Needs the packages of tools/install-packages.sh docs.
USAGE
}
output=$root/build/site
while (($#)); do
  case "$1" in
    -o) output=${2:?make_site: -o needs a folder}; shift 2 ;;
    -h | --help) usage; exit 0 ;;
    *) echo "make_site: unknown argument '$1'" >&2; usage >&2; exit 2 ;;
  esac
done

# Debian's Python, which has Debian's Sphinx, whatever else stands before it in PATH.
python=/usr/bin/python3
if ! "$python" -c 'import breathe, furo, myst_parser, sphinx' 2>/dev/null || ! command -v doxygen >/dev/null; then
  echo "make_site: no Sphinx with MyST, furo and Breathe for $python, or no doxygen: tools/install-packages.sh docs" >&2
  exit 69
fi
if [[ -e $output && ! -f $output/searchindex.js && -n $(ls -A "$output") ]]; then
  echo "make_site: $output is there and is not a site; name another folder" >&2
  exit 2
fi

rm -rf "$output" "$root/build/site-work"
mkdir -p "$root/build/site-work"
"$python" -m sphinx -c "$root/docs" -d "$root/build/site-work/doctrees" -b html -j "$(nproc)" -W --keep-going -q \
  "$root" "$output"
