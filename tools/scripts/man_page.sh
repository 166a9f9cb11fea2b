#!/bin/sh
# Writes the manual page of a command, by help2man from what its --help says: man_page.sh PROGRAM FOLDER [COMMAND]. The
# date is that of SOURCE_DATE_EPOCH, else of the commit that --version names, never today's.
set -eu
program=$(readlink -f "$1") folder=$2 command=${3:-}
name=gdtslam${command:+-$command}
COLUMNS=100 LC_ALL=C.UTF-8
export COLUMNS LC_ALL
version=$("$program" --version)
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  day=$(printf '%s\n' "$version" | sed -n 's/^commit .* of \(....-..-..\)$/\1/p')
  SOURCE_DATE_EPOCH=$(date -u -d "${day:-1970-01-02}" +%s)
  export SOURCE_DATE_EPOCH
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# help2man names the page after the file that it runs.
printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$program" "$command" >"$work/$name"
chmod +x "$work/$name"
summary=$("$work/$name" --help | head -n 1)
help2man --no-info --name="$summary" --version-string="$name ($(printf '%s' "$version" | sed -n '1s/ /) /p')" \
  "$work/$name" >"$work/page"
# Examples are command lines, each on lines of its own.
sed -e '/^\.SH EXAMPLES/,${' -e '/^\.[IP]P/d' -e '}' -e '/^\.SH EXAMPLES/a .nf' "$work/page" >"$folder/$name.1"
