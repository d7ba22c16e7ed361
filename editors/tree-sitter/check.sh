#!/usr/bin/env bash
# Generates the parser of grammar.js, runs the tests in test/corpus, and parses every scene of the repository, and
# others named on the command line, without a fault. Needs Node; installs tree-sitter's program where it is missing.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
version=0.25.10
tools=${TREE_SITTER_TOOLS:-$root/target/tree-sitter}

if ! command -v node >/dev/null; then
    apt-get update -qq && apt-get install -y -qq --no-install-recommends nodejs
fi
if ! "$tools/bin/tree-sitter" --version 2>/dev/null | grep -qF "$version"; then
    # Without optimisation: it is built in a third of the time, and the scenes are small.
    CARGO_TARGET_DIR="$tools/build" cargo install --quiet --debug --locked --root "$tools" \
        tree-sitter-cli --version "$version"
    rm -rf "$tools/build"
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -R "$here/." "$work"
# Neither the settings nor the parsers of whoever runs this.
export HOME=$work XDG_CACHE_HOME=$work/cache XDG_CONFIG_HOME=$work/config
cd "$work"
"$tools/bin/tree-sitter" generate
"$tools/bin/tree-sitter" test

find "$root/scenes" "$root/tests/conformance" "$root/grading" \
    \( -name '*.ray' -o -name '*.scene' \) -print >"$work/scenes.txt"
printf '%s\n' "$@" | sed '/^$/d' >>"$work/scenes.txt"
count=$(wc -l <"$work/scenes.txt")
"$tools/bin/tree-sitter" parse --quiet --paths "$work/scenes.txt"
for query in queries/*.scm; do
    "$tools/bin/tree-sitter" query --quiet "$query" "$(head -n 1 "$work/scenes.txt")"
done
echo "tree-sitter: $count scenes parsed"
