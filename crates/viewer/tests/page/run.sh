#!/usr/bin/env bash
# Drives the page in a headless Chromium: dropped files, and what `rayview --serve` serves. Needs the page
# (`cargo xtask web`) and a rayview with it; `run.sh -k word` and the like go to pytest.
set -euo pipefail
cd "$(dirname "$0")/../../../.."

target=$PWD/${CARGO_TARGET_DIR:-target}
case ${CARGO_TARGET_DIR:-} in /*) target=$CARGO_TARGET_DIR ;; esac
venv=$target/page-venv
export DOTRAY=${DOTRAY:-$target/release/dotray}
export RAYVIEW=${RAYVIEW:-$target/screen/rayview}
export CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome)}

if ! python3 -m venv "$venv"; then
    echo "page tests: no venv; trying to install it" >&2
    apt-get update -qq && apt-get install -y -qq python3-venv python3-pip
    python3 -m venv "$venv"
fi
"$venv/bin/pip" install -q --disable-pip-version-check playwright pytest numpy Pillow
"$venv/bin/python" -m pytest -q -p no:cacheprovider crates/viewer/tests/page "$@"
