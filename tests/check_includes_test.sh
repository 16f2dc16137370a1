#!/usr/bin/env bash
# check_includes.sh must find each way to break a module's law in a copy of the source.
#
#   check_includes_test.sh SCRATCH_FOLDER
set -euo pipefail
source_folder=$(cd "$(dirname "$0")/.." && pwd)
scratch=$1

# expect_failure WHAT_IS_SAID COMMAND … : the command breaks the copy it is run in.
expect_failure() {
  local said=$1 output
  shift
  rm -rf "$scratch" && mkdir -p "$scratch"
  cp -r "$source_folder"/{CONTRIBUTING.md,core,lod,io,tools} "$scratch"
  (cd "$scratch" && "$@")
  if output=$("$source_folder/tests/check_includes.sh" "$scratch" 2>&1); then
    echo "not found: $said" >&2
    return 1
  fi
  grep -qF "$said" <<<"$output" || { echo "expected '$said' in: $output" >&2; return 1; }
}

expect_failure "simplify may not use fit" sed -i '1i #include "fit/face_guard.h"' lod/simplify/locks.cpp
expect_failure "core may not use distance" sed -i '1i #include <lodestone/lod/deviation.h>' core/src/mesh.cpp
expect_failure "a header of no module" sed -i '1i #include <lodestone/lod/nowhere.h>' core/src/mesh.cpp
expect_failure "belongs to no module" touch io/stray.h
expect_failure "does not stand above it" sed -i 's/^| core |\(.*\)|[^|]*|$/| core |\1| scene |/' CONTRIBUTING.md
rm -rf "$scratch"
