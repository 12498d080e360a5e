#!/usr/bin/env bash
# cmake/build.sh PRESET [TARGET ...]: installs what is missing, configures build/PRESET if that has
# not been done, and builds the targets (default: all) as far as something changed. What the tools say
# goes to build/PRESET.log; progress, and the end of the log after a failure, to the terminal.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
preset=${1:?usage: cmake/build.sh PRESET [TARGET ...]}
shift
build=$root/build/$preset
log=$build.log

"$root/cmake/install-packages.sh"
mkdir -p "$root/build"
cd "$root"

# Ninja configures again by itself when a CMakeLists.txt changed; a tree that was moved or whose
# presets changed starts afresh.
if [[ ! -f $build/build.ninja || CMakePresets.json -nt $build/build.ninja ]] ||
    ! grep -qFx "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
  echo "Configuring build/$preset"
  if ! cmake --fresh --preset "$preset" >"$log" 2>&1; then
    echo "Configuring failed; the end of $log:" >&2
    tail -n 30 "$log" >&2
    exit 1
  fi
fi

# The largest source files take 1.6 GB to compile.
cores=$(nproc)
jobs=$(awk -v cores="$cores" '/^MemAvailable:/ { n = int($2 / 1600000); print n < 1 ? 1 : n < cores ? n : cores }' \
  /proc/meminfo)

# Reads ninja's lines "[done/total] what" and shows how far it is: one moving line on a terminal,
# a line per tenth elsewhere.
show_progress() {
  local line tenth shown=-1
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$log"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\]\ (.*) ]] || continue
    if [[ -t 1 ]]; then
      printf '\r\033[K%.*s' "${COLUMNS:-80}" "[${BASH_REMATCH[1]}/${BASH_REMATCH[2]}] ${BASH_REMATCH[3]}"
    else
      tenth=$((10 * BASH_REMATCH[1] / BASH_REMATCH[2]))
      if ((tenth > shown)); then
        echo "Building: ${BASH_REMATCH[1]} of ${BASH_REMATCH[2]} steps"
        shown=$tenth
      fi
    fi
  done
  if [[ -t 1 ]]; then printf '\r\033[K'; fi
}

started=$SECONDS
: >"$log"
if ! NINJA_STATUS='[%f/%t] ' ninja -C "$build" -j "${jobs:-$cores}" "$@" 2>&1 | show_progress; then
  echo "Building failed; from $log:" >&2
  sed -n '/^FAILED:\|error:\|Error/,$p' "$log" | head -n 60 >&2
  exit 1
fi
echo "build/$preset is up to date ($((SECONDS - started)) s)."
