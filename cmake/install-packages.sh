#!/usr/bin/env bash
# Installs the Debian packages that crease is built from, those that are missing only.
# A call that finds everything in place takes some hundredths of a second.
#
#   cmake/install-packages.sh           installs what is missing (as root, or through sudo)
#   cmake/install-packages.sh --list    prints the names of all packages needed
#
# Packages of later chapters (FFTW) join the list with the code that uses them.
set -euo pipefail

packages=(
  build-essential          # compiler
  cmake                    # configuration
  ninja-build              # build
  pkg-config               # finds GSL
  libeigen3-dev            # vectors
  libtbb-dev               # threads
  libinsighttoolkit5-dev   # image files
  libhdf5-dev              # HDF5 transform files of ITK (ITK brings it too)
  libopencv-dev            # filters
  libcgal-dev              # triangulation
  libboost-dev             # exact fractions in tests (CGAL brings it too)
  libsuitesparse-dev       # sparse factors
  libopenblas-dev          # their BLAS
  libgsl-dev               # minimisers by values
  libceres-dev             # minimisers by gradients
  libcli11-dev             # command line
  libtomlplusplus-dev      # configuration files
  nlohmann-json3-dev       # results
  libspdlog-dev            # messages
  libfmt-dev               # their format
  zlib1g-dev               # compressed files
  libjpeg-dev              # JPEG files
  libgtest-dev             # tests
  libgmock-dev             # matchers
  libbenchmark-dev         # benchmarks
  chromium                 # tests of report.html as a user sees it
)

if [[ ${1:-} == --list ]]; then
  printf '%s\n' "${packages[@]}"
  exit 0
elif [[ $# -gt 0 ]]; then
  echo "usage: ${0##*/} [--list]" >&2
  exit 2
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "This is not a Debian system: make sure that the equivalents of these packages are installed:" >&2
  printf '  %s\n' "${packages[*]}" >&2
  exit 0  # configuring names the first one that is not
fi

# dpkg-query exits with 1 when it does not know one of the names; what it knows it prints all the same.
installed=$'\n'$(dpkg-query --show --showformat '${Package} ${db:Status-Status}\n' "${packages[@]}" \
  2>/dev/null || true)$'\n'
missing=()
for package in "${packages[@]}"; do
  [[ $installed == *$'\n'"$package installed"$'\n'* ]] || missing+=("$package")
done

# Tests alone need a browser, and are skipped without one: where the distribution has none of that name, go on.
leave_out_unknown_browser() {
  local package kept=()
  for package in "${missing[@]}"; do
    if [[ $package == chromium ]] && apt-cache show cmake >/dev/null 2>&1 &&
      ! apt-cache show chromium >/dev/null 2>&1; then
      continue
    fi
    kept+=("$package")
  done
  missing=("${kept[@]}")
}
leave_out_unknown_browser
if [[ ${#missing[@]} -eq 0 ]]; then exit 0; fi

install=(apt-get install --yes --no-install-recommends "${missing[@]}")
if [[ $(id -u) -eq 0 ]]; then
  as_root=(env)
elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
  as_root=(sudo -n env)
else
  cat >&2 <<MESSAGE
These Debian packages are missing, and installing them takes root's rights:
  ${missing[*]}
Call this once, then try again:
  sudo apt-get update && sudo ${install[*]}
(without sudo: the same two commands as root)
MESSAGE
  exit 1
fi

root_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
log=$root_dir/build/packages.log
mkdir -p "${log%/*}"
: >"$log"
run() {
  "${as_root[@]}" DEBIAN_FRONTEND=noninteractive "$@" -o Acquire::Retries=3 \
    -o DPkg::Lock::Timeout=300 </dev/null >>"$log" 2>&1
}

echo "Installing what is missing, with what it needs (up to 2 GB; minutes at first): ${missing[*]}"
started=$SECONDS
if ! run apt-get update; then
  echo "apt-get update failed (see $log); trying with the package lists at hand." >&2
fi
leave_out_unknown_browser
install=(apt-get install --yes --no-install-recommends "${missing[@]}")
if ! run "${install[@]}"; then
  echo "\"${install[*]}\" failed; the end of $log:" >&2
  tail -n 20 "$log" >&2
  echo "Mend that (network, disk space, /etc/apt/sources.list) and try again." >&2
  exit 1
fi
echo "Installed in $((SECONDS - started)) s."
