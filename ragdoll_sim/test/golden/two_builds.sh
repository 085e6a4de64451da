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
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
package=$(cd "$here/../.." && pwd -P)
mkdir -p "$build/golden" "$(dirname "$out")"

say() { echo "two_builds.sh: $*"; }

# The last revision that changed the list; not the end of a shallow clone, which is only where
# history begins.
list_revision() {
  local revision
  revision=$(git -C "$here" log -1 --format=%H -- golden.txt 2>/dev/null) || return 1
  [ -n "$revision" ] || return 1
  (cd "$here" && grep -qsx "$revision" "$(git rev-parse --git-path shallow)") && return 1
  echo "$revision"
}

names='CMAKE_(BUILD_TYPE|PREFIX_PATH|CXX_COMPILER|CXX_COMPILER_LAUNCHER|CXX_FLAGS(_[A-Z]+)?)'
names+='|RAGDOLL_NATIVE|(Eigen3|yaml-cpp|nlohmann_json|Boost|GTest)_DIR'
mapfile -t options < <(sed -nE "s/^($names):/-D&/p" "$build/CMakeCache.txt")

if revision=$(list_revision); then
  say "the other build is revision $revision, for which the list was written"
  top=$(git -C "$here" rev-parse --show-toplevel)
  copy=$build/golden/$revision
  if [ ! -d "$copy" ]; then
    rm -rf "$copy.part" && mkdir "$copy.part"
    git -C "$top" archive "$revision" -- "${package#"$top"/}" | tar -x -C "$copy.part"
    mv "$copy.part" "$copy"
  fi
  source=$copy/${package#"$top"/}
  other=$copy/build
else
  say "no history tells which revision the list was written for:" \
    "the other build is this source with -O1"
  options+=(-DCMAKE_BUILD_TYPE=Other -DCMAKE_CXX_FLAGS_OTHER="-O1 -DNDEBUG")
  source=$package
  other=$build/golden/O1
fi

log=$other.log
say "building it takes minutes; log: $log"
cmake -S "$source" -B "$other" "${options[@]}" -DRAGDOLL_ROS=OFF >"$log" 2>&1 &&
  cmake --build "$other" --target golden_test --parallel "$(nproc)" >>"$log" 2>&1 ||
  { tail -n 30 "$log"; exit 1; }
# Its own scenes and models, not those of whoever calls.
env -u RAGDOLL_SHARE_DIR -u ROS_PACKAGE_PATH "$other/golden_test" --write "$out"
