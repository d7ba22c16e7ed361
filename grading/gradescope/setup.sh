#!/usr/bin/env bash
# Gradescope runs this once, when the image is built. dotray is one program without needs of its own; put here what your
# students' programs need.
set -euo pipefail
apt-get update
apt-get install -y g++ make
