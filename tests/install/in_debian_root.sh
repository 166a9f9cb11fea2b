#!/bin/bash
# What packages.sh runs in the root: the packages are installed as somebody does who downloaded them, used, and removed.
# Arguments: what they must have, library or pages.
set -euo pipefail
parts=" $* "
has() { [[ $parts == *" $1 "* ]]; }
fail() { echo "FAILED in the root: $*"; exit 1; }

# What stands for libblas.so.3 and the like: of what is here, which may be other than on the machine that this was made of.
# A record without any leaves no link.
for record in /var/lib/dpkg/alternatives/*; do
  update-alternatives --quiet --auto "$(basename "$record")" >>/tmp/alternatives.txt 2>&1 || true
done

apt-get -q install -y --no-install-recommends -o APT::Sandbox::User=root /packages/*.deb >/tmp/apt.txt 2>&1 || {
  cat /tmp/apt.txt
  fail "apt install"
}
dpkg --audit | grep . && fail "dpkg --audit"
apt-get -q check >/dev/null || fail "apt-get check"

version=$(dpkg-query -W -f '${source:Upstream-Version}' gdtslam)
gdtslam --version | head -n 1 | grep -q "^gdtslam $version" || fail "version: $(gdtslam --version) and $version"

cd /tmp
gdtslam map /usr/share/gdtslam/logs/office-start.log.gz -o run --quiet || fail "map"
for name in map.pgm map.yaml trajectory.tum report.json; do
  [[ -s run/$name ]] || fail "no $name"
done
expected=$(sed -n '/"loops": true/,/map_sha256/s/.*"map_sha256": "\([0-9a-f]*\)".*/\1/p' /usr/share/gdtslam/expected/office-start.json)
grep -q "\"map_sha256\": \"$expected\"" run/report.json || fail "the map is not the one that is shipped"
gzip -dc /usr/share/gdtslam/logs/office-start.log.gz | gdtslam live -o drive --quiet >poses.jsonl || fail "live"
grep -q "\"map_sha256\": \"$expected\"" drive/report.json || fail "the map of live is another"
for sample in /usr/share/gdtslam/expected/*.json; do
  log=$(sed -n 's/.*"log": "\([^"]*\)".*/\1/p' "$sample")
  grep -q "\"log_sha256\": \"$(sha256sum "/usr/share/gdtslam/logs/$log" | cut -d ' ' -f 1)\"" "$sample" || fail "$log is another"
done
gdtslam verify gdt --device cpu --quiet | tail -n 1 | grep -q '^PASS' || fail "verify"
gdtslam doctor --after run | grep -q . || fail "doctor"
gdtslam render run -o a.png || fail "render"
for page in docs/tutorial.md docs/howto/install.md docs/reference/json.md README.md; do
  [[ -s /usr/share/doc/gdtslam/$page ]] || fail "no $page in gdtslam-doc"
done
[[ -s /usr/include/gdtslam/mapping/mapper.hpp ]] || fail "no headers in libgdtslam-dev"

if has pages; then
  man -P cat gdtslam-map >man.txt 2>&1 || fail "man gdtslam-map: $(cat man.txt)"
  grep -q -- '--matcher' man.txt || fail "man gdtslam-map does not tell the options"
  man -P cat gdtslam >man.txt 2>&1 || fail "man gdtslam"
  offered=$(bash -c '
    source /usr/share/bash-completion/bash_completion
    source /usr/share/bash-completion/completions/gdtslam
    COMP_WORDS=(gdtslam eval) COMP_CWORD=1 COMP_LINE="gdtslam eval" COMP_POINT=12
    function=$(complete -p gdtslam | sed -n "s/.* -F \([^ ]*\) .*/\1/p")
    "$function" gdtslam eval gdtslam
    echo "${COMPREPLY[*]}"')
  [[ $offered == *evaluate* ]] || fail "completion of 'gdtslam eval' offers '$offered'"
fi

if has library; then
  python3 -c 'import gdtslam; print(gdtslam.__name__)' | grep -q '^gdtslam$' || fail "import gdtslam"
  [[ -s /usr/include/gdtslam.h ]] || fail "no gdtslam.h"
fi

names=()
for deb in /packages/*.deb; do names+=("$(dpkg-deb -f "$deb" Package)"); done
dpkg --purge "${names[@]}" >/tmp/purge.txt 2>&1 || { cat /tmp/purge.txt; fail "purge"; }
left=$(find /usr -iname '*gdtslam*' | head -n 3)
[[ -z $left ]] || fail "left after purging: $left"
echo "installed, used and removed: ${names[*]}"
