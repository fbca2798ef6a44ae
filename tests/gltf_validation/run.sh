#!/usr/bin/env bash
# run.sh SAMPLES_PROGRAM WORK_FOLDER: writes sample files and validates them. Exit code 77 (skipped) where Node, npm or
# the validator package is not available.
set -euo pipefail
samples=$1
work=$2
here=$(cd "$(dirname "$0")" && pwd)
skip() { echo "skipped: $1"; exit 77; }
command -v node >/dev/null || skip "node is not installed"
command -v npm >/dev/null || skip "npm is not installed"

mkdir -p "$work"
if ! cmp -s "$here/package.json" "$work/package.json" || [ ! -d "$work/node_modules/gltf-validator" ]; then
  cp "$here/package.json" "$work/package.json"
  npm install --prefix "$work" --no-audit --no-fund --no-package-lock >"$work/npm.log" 2>&1 ||
    { rm -f "$work/package.json"; skip "npm could not install gltf-validator, see $work/npm.log"; }
fi

rm -rf "$work/files"
mkdir "$work/files"
"$samples" "$work/files"
node "$here/validate.mjs" "$work/node_modules" "$work"/files/*.glb
# The check must be able to fail: a file with a broken normal is an error.
if node "$here/validate.mjs" "$work/node_modules" "$work"/files/broken.bin >/dev/null; then
  echo "the validator accepted a broken file"
  exit 1
fi
