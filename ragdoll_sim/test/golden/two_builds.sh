#!/bin/bash
# Writes the golden list of another build, for golden_test to compare its own with.
# Usage: two_builds.sh BUILD_FOLDER OUT
#   BUILD_FOLDER  of this build: the other one takes compiler and flags from its CMakeCache.txt and
#                 lies in its golden/, where it stays, so that a second time takes no time
#   OUT           the list
# The other build is that of the revision that golden.txt was written for; without a history it is
# this source with -O1.
set -euo pipefail
build=$(cd "$1" && pwd)
out=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
package=$(cd "$here/../.." && pwd)
mkdir -p "$build/golden" "$(dirname "$out")"

say() { echo "two_builds.sh: $*"; }

# The last revision that changed the list; not the end of a shallow clone, which is only where
# history begins.
list_revision() {
  local revision
  revision=$(git -C "$here" log -1 --format=%H -- golden.txt 2>/dev/null) || return 1
  [ -n "$revision" ] || return 1
  grep -qsx "$revision" "$(git -C "$here" rev-parse --absolute-git-dir)/shallow" && return 1
  echo "$revision"
}

if revision=$(list_revision); then
  say "the other build is revision $revision, for which the list was written"
  source=$build/golden/$revision
  flags=()
  if [ ! -d "$source" ]; then
    top=$(git -C "$here" rev-parse --show-toplevel)
    mkdir -p "$source.part"
    git -C "$top" archive "$revision" -- "${package#"$top"/}" | tar -x -C "$source.part"
    mv "$source.part" "$source"
  fi
  source=$source/${package#"$(git -C "$here" rev-parse --show-toplevel)"/}
else
  say "there is no history to take the list's revision from: the other build is this source with -O1"
  source=$package
  flags=(-DCMAKE_BUILD_TYPE=Other -DCMAKE_CXX_FLAGS_OTHER="-O1 -DNDEBUG")
fi

# name:type=value, as cmake -D takes them
mapfile -t cache < <(sed -nE \
  '/^(CMAKE_BUILD_TYPE|CMAKE_CXX_COMPILER|CMAKE_CXX_COMPILER_LAUNCHER|CMAKE_CXX_FLAGS(_[A-Z]+)?|RAGDOLL_NATIVE):/s/^/-D/p' \
  "$build/CMakeCache.txt")
other=$source/golden_build
[ "$source" = "$package" ] && other=$build/golden/O1
cmake -S "$source" -B "$other" "${cache[@]}" -DRAGDOLL_ROS=OFF "${flags[@]}" >"$other.log" 2>&1 ||
  { tail -n 20 "$other.log"; exit 1; }
cmake --build "$other" --target golden_test --parallel "$(nproc)" >>"$other.log" 2>&1 ||
  { tail -n 20 "$other.log"; exit 1; }
# Its own scenes and models, not those of whoever calls.
env -u RAGDOLL_SHARE_DIR -u ROS_PACKAGE_PATH "$other/golden_test" --write "$out" >>"$other.log"
