#!/usr/bin/env bash
# Runs the commands that README.md and the guide show.
#
#   Documentation/make-pictures.sh [--build DIR] [PAGE ...]
#       runs every block marked ```sh as it stands, in a scratch folder per page, and rewrites what
#       follows from it: the block ```text below it (what the commands printed, times left out) and the
#       pictures, which comments name: <!-- picture: FILE WIDTH IN ... --> (see small_picture). A block
#       marked ```sh fails ends with an error; its message is part of the output.
#   Documentation/make-pictures.sh --check FOLDER [--build DIR] [PAGE ...]
#       only runs them, in a new folder per page in FOLDER, on phantoms of 96 pixels (volumes: 32 voxels, mammograms: 256) and coarse meshes, and
#       changes nothing.
#
# The target `guide` builds what this needs and calls it; the tests call it with --check.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build=$root/build/release
check=
pages=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --build) build=$(cd "$2" && pwd -P); shift ;;
    --check) mkdir -p "$2"; check=$(cd "$2" && pwd -P); shift ;;
    -*) echo "usage: ${0##*/} [--check FOLDER] [--build DIR] [PAGE ...]" >&2; exit 2 ;;
    *) pages+=("$(realpath "$1")") ;;
  esac
  shift
done
if [[ ${#pages[@]} -eq 0 ]]; then pages=("$root/README.md" "$root"/Documentation/guide/*.md); fi
export PATH=$build/Applications:$build/Testing/Documentation:$PATH

scratch=$check
if [[ -z $check ]]; then
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
fi

# What the blocks call instead of the command itself.
quiet_crease='crease() { command crease "$@" --quiet; }'
small_crease='crease() {
  local arguments=() skip=
  for argument in "$@"; do
    if [[ -z $skip && $argument != --size ]]; then arguments+=("$argument"); fi
    skip=; if [[ $argument == --size ]]; then skip=1; fi
  done
  case "$*" in
    phantom*--dimension*) arguments+=(--size 32) ;;
    phantom*mammogram*) arguments+=(--size 256) ;;
    phantom*) arguments+=(--size 96) ;;
    *--mesh-size* | *--triangles* | *--transform\ *) ;;
    register*) arguments+=(--mesh-size 24) ;;
  esac
  command crease "${arguments[@]}" --quiet
}'

# run_block PAGE BLOCK WAY: leaves in `output` what the block printed.
run_block() {
  local code=0 prelude=$quiet_crease
  if [[ -n $check ]]; then prelude=$small_crease; fi
  output=$(bash -euo pipefail -c "$prelude"$'\n'"$2" 2>"$errors") || code=$?
  if [[ $3 == " fails" ]]; then
    output+=$(<"$errors")
    if [[ $code -ne 0 ]]; then code=0; else code=1; fi
  fi
  if [[ $code -ne 0 ]]; then
    printf '%s: these commands do not do what the page says:\n%s\n%s\n' "$1" "$2" \
      "$(<"$errors")" >&2
    exit 1
  fi
  output=$(sed -E 's/, [0-9.]+ s$//' <<<"$output")
}

# make_picture PAGE "FILE WIDTH IN ...": the files are named as seen from the page and the scratch folder.
make_picture() {
  local words
  read -ra words <<<"$2"
  local file=$(dirname "$1")/${words[0]}
  if [[ -n $check ]]; then file=$PWD/picture.png; fi
  mkdir -p "$(dirname "$file")"
  small_picture "${words[1]}" "$file" "${words[@]:2}"
}

# Prints the page with everything that follows from its commands renewed; makes its pictures in the end.
renewed() {
  local page=$1 line state=prose block='' way='' output='' fresh='' pictures=()
  while IFS= read -r line; do
    case $state in
      prose)
        case $line in
          '```sh'*) state=commands block='' way=${line#'```sh'} ;;
          '```text') if [[ -n $fresh ]]; then state=output line+=$'\n'$output; fi ;;
          '```'*) state=verbatim ;;
          '<!-- picture: '*' -->') pictures+=("${line#'<!-- picture: '}") ;;
        esac
        if [[ -n $line ]]; then fresh=; fi
        ;;
      commands)
        if [[ $line == '```' ]]; then
          run_block "$page" "$block" "$way"
          state=prose fresh=1
        else
          block+=$line$'\n'
        fi
        ;;
      output) if [[ $line == '```' ]]; then state=prose; else continue; fi ;;
      verbatim) if [[ $line == '```' ]]; then state=prose; fi ;;
    esac
    printf '%s\n' "$line"
  done <"$page"
  for line in "${pictures[@]}"; do make_picture "$page" "${line%' -->'}"; done
}

for page in "${pages[@]}"; do
  name=$(basename "$page" .md) errors=$scratch/$name.errors
  rm -rf "${scratch:?}/$name"
  mkdir -p "$scratch/$name"
  if [[ -z $check ]]; then echo "$name"; fi
  (cd "$scratch/$name" && renewed "$page") >"$scratch/$name.md"
  if [[ -z $check ]] && ! cmp -s "$scratch/$name.md" "$page"; then cp "$scratch/$name.md" "$page"; fi
done
