#!/usr/bin/env bash
# c_by_pkg_config.sh COMPILER LIBRARY_FOLDER SOURCE LOG FOLDER: builds a program in C with what pkg-config says of an
# installed gdtslam, and maps the log with it; the library is found by its folder.
set -euo pipefail
compiler=$1 libraries=$2 source=$3 log=$4 folder=$5
rm -rf "$folder"
mkdir -p "$folder"
read -ra flags < <(PKG_CONFIG_PATH="$libraries/pkgconfig" pkg-config --cflags --libs gdtslam)
"$compiler" -std=c99 -pedantic -Wall -Wextra -Werror "$source" "${flags[@]}" -o "$folder/map"
LD_LIBRARY_PATH="$libraries" "$folder/map" "$log" "$folder/run"
