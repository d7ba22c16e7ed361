#!/usr/bin/env bash
# What `dotray check --format sarif` says of every file of messages, against the JSON schema of SARIF 2.1.0, which an
# npm package carries. Usage: sarif.sh PATH-OF-DOTRAY
set -euo pipefail
dotray=$(realpath "$1")
root=$(cd "$(dirname "$0")/../../.." && pwd)
if ! command -v npm >/dev/null; then
    apt-get update -qq && apt-get install -y -qq --no-install-recommends nodejs npm
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$work" && npm init -y >/dev/null && npm install --silent --no-audit --no-fund --ignore-scripts \
    @microsoft/jest-sarif@1.0.0-beta.0 ajv@6)

cd "$root"
"$dotray" check --format sarif crates/scene/tests/messages/*.ray crates/scene/tests/messages/missing.ray \
    scenes/slides-as-printed.ray >"$work/faults.sarif" || [ $? -eq 1 ]
"$dotray" check --format sarif scenes/hello.ray >"$work/none.sarif"

cd "$work"
cat >validate.cjs <<'END'
const fs = require("fs");
const Ajv = require("ajv");
const schema = JSON.parse(fs.readFileSync("node_modules/@microsoft/jest-sarif/lib/schemas/sarif-2.1.0-rtm.5.json"));
const ajv = new Ajv({ schemaId: "id", allErrors: true });
ajv.addMetaSchema(require("ajv/lib/refs/json-schema-draft-04.json"));
const valid = ajv.compile(schema);
const read = (name) => JSON.parse(fs.readFileSync(name));
const faults = (log) => (valid(log) ? [] : valid.errors);
const results = (log) => log.runs[0].results.length;

for (const name of ["faults.sarif", "none.sarif"]) {
  const log = read(name);
  for (const fault of faults(log)) console.error(`${name}${fault.dataPath}: ${fault.message}`);
  if (faults(log).length > 0) process.exitCode = 1;
  console.log(`sarif: ${name} holds ${results(log)} results`);
}
// The schema must be able to say no.
const broken = read("faults.sarif");
delete broken.runs[0].results[0].message;
if (results(broken) < 100 || faults(broken).length === 0) {
  console.error("sarif: the check has no teeth");
  process.exitCode = 1;
}
END
node validate.cjs
