#!/usr/bin/env python3
"""Writes the scenes that are too long to write by hand, and the textures of all: python3 scenes/generate.py [NAME…]

Standard library only. The same bytes come out every time. The scenes of the slides and hello.ray are written by hand.
"""

import sys

from generators import chess, diagrams, lands, meshes, molecules, rooms, solids, textures

GENERATORS = [textures, molecules, solids, diagrams, rooms, chess, meshes, lands]


def main(names):
    known = {g.__name__.rpartition(".")[2]: g for g in GENERATORS}
    wrong = [n for n in names if n not in known]
    if wrong:
        sys.exit(f"no generator is named {wrong[0]}; there are {', '.join(known)}")
    for name in names or known:
        known[name].main()


if __name__ == "__main__":
    main(sys.argv[1:])
