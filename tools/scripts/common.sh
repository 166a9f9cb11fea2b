# Sourced by tools/{run,test,soak}.sh and scripts/fuzz.sh: numbered steps with their times, and a configure that
# survives a tree which was moved, interrupted or set up with another generator. Needs: set -euo pipefail, $root and
# $step_count.
# shellcheck shell=bash

: "${root:?the source folder}" "${step_count:?the number of steps}"

# Python itself and not a version manager's script in its place, which takes ten times as long to begin: tests begin hundreds.
if command -v python3 >/dev/null; then
  PATH=$(dirname "$(python3 -c 'import sys; print(sys.executable)')"):$PATH
fi

step_number=0
step_title=
step_start=$SECONDS

finish_step() {
  if [[ -n $step_title ]]; then printf '      %s: %d s\n' "$step_title" $((SECONDS - step_start)); fi
  step_title=
}

# step TITLE: ends the step before and announces the next.
step() {
  finish_step
  step_number=$((step_number + 1))
  step_title=$1
  step_start=$SECONDS
  printf '\n[%d/%d] %s\n' "$step_number" "$step_count" "$step_title"
}

# configure FOLDER [CMAKE ARGUMENTS]: a Ninja build tree, begun anew when its cache belongs to another place or generator.
configure() {
  local folder=$1 cache=$1/CMakeCache.txt launcher=()
  shift
  if [[ -f $cache ]] && ! { grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache" &&
    grep -qx 'CMAKE_GENERATOR:INTERNAL=Ninja' "$cache"; }; then
    echo "the build tree $folder belongs to another source folder or generator; starting it anew"
    rm -rf "$folder"
  fi
  if command -v ccache >/dev/null; then
    export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros,include_file_mtime,include_file_ctime}
    launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  mkdir -p "$folder"
  cmake -S "$root" -B "$folder" -G Ninja --log-level=WARNING "${launcher[@]}" "$@" >"$folder.configure.log" 2>&1 || {
    cat "$folder.configure.log"
    return 1
  }
}

# Compiler processes at a time: one per processor, fewer where memory is short (1 GiB each).
build_jobs() {
  local processors memory_kib jobs
  processors=$(nproc)
  memory_kib=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  jobs=$((memory_kib / 1048576))
  if ((jobs < 1)); then jobs=1; fi
  if ((jobs > processors)); then jobs=$processors; fi
  echo "${GDTSLAM_JOBS:-$jobs}"
}
