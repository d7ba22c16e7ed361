#!/usr/bin/env bash
# Builds the wheel, installs it into an environment of its own, and runs everything that holds for the Python package:
# types, stubs, examples, tests, notebooks, many workers. Ends with one line: `N passed, N failed`.
# PYTHON names the interpreter; `run.sh -k word` and the like go to pytest.
set -euo pipefail
cd "$(dirname "$0")/../../.."

python=${PYTHON:-python3}
target=${CARGO_TARGET_DIR:-target}
venv=$target/python-venv
wheels=$target/wheels

if ! "$python" -m venv "$venv"; then
    echo "python tests: no venv; trying to install it" >&2
    apt-get update -qq && apt-get install -y -qq python3-venv python3-pip
    "$python" -m venv "$venv"
fi
bin=$PWD/$venv/bin
[ "${target#/}" = "$target" ] || bin=$venv/bin
"$bin/pip" install -q --disable-pip-version-check "maturin>=1.16,<2" numpy pytest hypothesis mypy tqdm Pillow \
    nbconvert ipykernel "distributed>=2024" "anywidget>=0.9" jupyterlab playwright
# MPI as a wheel; where it cannot be had, its test says that it is skipped.
"$bin/pip" install -q --disable-pip-version-check mpi4py mpich || echo "python tests: no MPI to be had" >&2

# So with Ray, and with pyright, which brings no Node of its own.
"$bin/pip" install -q --disable-pip-version-check "ray>=2.40" || echo "python tests: no Ray to be had" >&2
"$bin/pip" install -q --disable-pip-version-check pyright

# The viewer for notebooks is a part of the wheel.
[ -f crates/python/python/dotray/web/rayview_bg.wasm.gz ] || cargo xtask web

rm -rf "$wheels"
"$bin/maturin" build --release --locked --interpreter "$bin/python" --out "$wheels"
"$bin/pip" install -q --disable-pip-version-check --force-reinstall --no-deps "$wheels"/*.whl
# The program that must make the same pictures.
cargo build --release --locked --package dotray

passed=0
failed=0
check() {
    echo "== $*"
    if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
}

check "$bin/mypy" --python-executable "$bin/python"
check "$bin/python" -m mypy.stubtest dotray._dotray --concise --ignore-disjoint-bases

if command -v node >/dev/null; then
    check "$bin/pyright" --pythonpath "$bin/python"
else
    echo "python tests: pyright is skipped, no Node" >&2
fi

wheel=$(ls "$wheels"/*.whl)
echo "wheel: $(basename "$wheel"), $(stat -c %s "$wheel") bytes"
"$bin/python" -c "
import time
start = time.perf_counter(); import numpy; middle = time.perf_counter(); import dotray; end = time.perf_counter()
print(f'import: numpy {middle - start:.3f} s, dotray {end - middle:.3f} s more')"

log=$(mktemp)
trap 'rm -f "$log"' EXIT
export DOTRAY=${DOTRAY:-$PWD/$target/release/dotray}
"$bin/python" -m pytest -q -p no:cacheprovider -rs crates/python/tests "$@" 2>&1 | tee "$log" || true

count() { grep -oE "[0-9]+ $1" "$log" | tail -1 | cut -d' ' -f1; }
ran=$(count passed || true)
wrong=$(count "failed" || true)
errors=$(count "errors?" || true)
passed=$((passed + ${ran:-0}))
failed=$((failed + ${wrong:-0} + ${errors:-0}))
# A run that broke off has no count.
if [ -z "${ran:-}" ]; then failed=$((failed + 1)); fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
