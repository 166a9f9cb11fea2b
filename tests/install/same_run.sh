#!/usr/bin/env bash
# same_run.sh COMMAND PROGRAM LOG FOLDER: maps the log with `COMMAND map` and with PROGRAM and compares every file of the two
# run folders, byte for byte; of report.json the hashes, for it holds times.
set -euo pipefail
command=$1 program=$2 log=$3 folder=$4
rm -rf "$folder"
mkdir -p "$folder"
"$command" map "$log" -o "$folder/command" --quiet
"$program" "$log" "$folder/program"
for file in "$folder"/command/*; do
  name=$(basename "$file")
  if [[ $name == report.json ]]; then
    for key in map_sha256 trajectory_sha256; do
      diff <(grep "\"$key\"" "$file") <(grep "\"$key\"" "$folder/program/$name")
    done
  else
    cmp "$file" "$folder/program/$name"
  fi
done
[[ $(find "$folder/command" -type f | wc -l) == $(find "$folder/program" -type f | wc -l) ]]
echo "equal"
