"""Scenes of atoms: one molecule, a sponge cut from a lattice, the shell of a virus."""

import math

from .ray import (
    Random,
    Ray,
    add,
    apply,
    cross,
    dot,
    length,
    mix,
    mul,
    product,
    ramp,
    rotate,
    scale,
    sub,
    translate,
    unit,
)

CAFFEINE = """
O 0.4700 2.5688 0.0006    O -3.1271 -0.4436 -0.0003  N -0.9686 -1.3125 0.0000   N 2.2182 0.1412 -0.0003
N -1.3477 1.0797 -0.0001  N 1.4119 -1.9372 0.0002    C 0.8579 0.2592 -0.0008    C 0.3897 -1.0264 -0.0004
C 0.0307 1.4220 -0.0006   C -1.9061 -0.2495 -0.0004  C 2.5032 -1.1998 0.0003    C -1.4276 -2.6960 0.0008
C 3.1926 1.2061 0.0003    C -2.2969 2.1881 0.0007    H 3.5163 -1.5787 0.0008    H -1.0451 -3.1973 -0.8937
H -2.5186 -2.7596 0.0011  H -1.0447 -3.1963 0.8957   H 4.1992 0.7801 0.0002     H 3.0468 1.8092 -0.8992
H 3.0466 1.8083 0.9004    H -1.8087 3.1651 -0.0003   H -2.9322 2.1027 0.8881    H -2.9346 2.1021 -0.8849
"""
RADIUS = {"C": 0.42, "N": 0.41, "O": 0.4, "H": 0.27}
BOND = {"CH": 1.2, "CN": 1.55, "CO": 1.35, "CC": 1.6}


def caffeine():
    """Ball and stick; bonds follow from the distances, double bonds from their lengths."""
    ray = Ray("Caffeine, C8H10N4O2: balls and sticks, coordinates in angstroms.", "  dotray render scenes/caffeine.ray")
    ray.camera((0, 3.0, 15), (0, 0.2, 0), 29)
    ray.background(0.1, 0.12, 0.16)
    ray.ambient(0.34, 0.36, 0.4)
    ray.area((0.76, 0.74, 0.7), (-7, 13, 8), (0, 0, 0), 2.4)
    ray.point((0.26, 0.28, 0.32), (0, 3.0, 15))
    m = {
        "C": ray.gloss((0.2, 0.21, 0.23), 0.4, 0.5),
        "N": ray.gloss((0.16, 0.34, 0.82), 0.4, 0.45),
        "O": ray.gloss((0.85, 0.14, 0.12), 0.4, 0.45),
        "H": ray.gloss((0.88, 0.88, 0.86), 0.3, 0.5),
    }
    stick = ray.gloss((0.62, 0.63, 0.65), 0.5, 0.5)
    floor = ray.gloss((0.3, 0.42, 0.5), 0.3, 0.55)
    wall = ray.matte((0.3, 0.42, 0.5))

    words = CAFFEINE.split()
    atoms = [(words[i], tuple(map(float, words[i + 1 : i + 4]))) for i in range(0, len(words), 4)]
    pose = product(translate(0.3, 0.35, 0), rotate((0, 1, 0), -28), rotate((1, 0, 0), -14), rotate((0, 0, 1), 12))
    low = min(apply(pose, p)[1] - RADIUS[e] for e, p in atoms)
    ray.comment("the table and the wall")
    ray.box(floor, (0, low - 0.55, 0), (80, 0.5, 40))
    ray.box(wall, (0, 10, -13), (80, 40, 1))
    with ray.group(pose):
        ray.comment("atoms")
        for element, p in atoms:
            ray.sphere(m[element], p, RADIUS[element])
        ray.comment("bonds")
        for i, (a, p) in enumerate(atoms):
            for b, q in atoms[i + 1 :]:
                pair, d = "".join(sorted(a + b)), length(sub(p, q))
                if d > BOND.get(pair, 0):
                    continue
                double = (pair == "CO") or (pair == "CC" and d < 1.38) or (pair == "CN" and d < 1.32)
                across = mul(unit(cross(sub(q, p), (0, 0, 1))), 0.13)
                for side in (across, mul(across, -1)) if double else ((0, 0, 0),):
                    ray.tube(stick, add(p, side), add(q, side), 0.08 if double else 0.12)
    ray.save("caffeine.ray")


def gyroid():
    """Atoms of a face-centred lattice near a gyroid, in a cube."""
    ray = Ray(
        "A sponge of atoms: the points of a lattice near the surface sin x cos y + sin y cos z + sin z cos x = 0.",
        "  dotray render scenes/gyroid.ray",
    )
    ray.camera((13.5, 10.5, 20), (0.1, -0.8, 0), 32)
    ray.background(0.93, 0.93, 0.91)
    ray.ambient(0.36, 0.37, 0.4)
    ray.area((0.56, 0.55, 0.52), (30, 90, 60), (0, 0, 0), 14)
    ray.point((0.16, 0.16, 0.17), (13.5, 10.5, 20))
    stops = [(0.16, 0.18, 0.42), (0.13, 0.42, 0.56), (0.25, 0.66, 0.56), (0.93, 0.78, 0.36), (0.9, 0.42, 0.25)]
    palette = [ray.gloss(ramp(stops, k / 15), 0.22, 0.45) for k in range(16)]
    floor = ray.gloss((0.9, 0.9, 0.88), 0.12, 0.7)
    half, step = 5.0, 0.2
    ray.box(floor, (0, -half - 0.45, 0), (400, 0.5, 400))
    n = round(half / step)
    for i in range(-n, n + 1):
        for j in range(-n, n + 1):
            for k in range(-n, n + 1):
                if (i + j + k) % 2:
                    continue
                x, y, z = i * step, j * step, k * step
                w = 2 * math.pi / 5
                g = (
                    math.sin(w * x) * math.cos(w * y)
                    + math.sin(w * y) * math.cos(w * z)
                    + math.sin(w * z) * math.cos(w * x)
                )
                if abs(g) > 0.28:
                    continue
                t = (y + half) / (2 * half)
                ray.sphere(palette[min(15, int(16 * t))], (x, y, z), 0.145)
    ray.save("gyroid.ray")


def rotations_of_the_icosahedron():
    """The 60 turns that map the icosahedron on itself, as products of two of its generators."""
    golden = (1 + math.sqrt(5)) / 2
    five, three = rotate((0, 1, golden), 72), rotate((1, 1, 1), 120)
    found = [rotate((1, 0, 0), 0)]
    for m in found:
        for g in (five, three):
            new = product(g, m)
            if all(max(abs(new[r][c] - f[r][c]) for r in range(3) for c in range(3)) > 1e-6 for f in found):
                found.append(new)
    return found


def protein():
    """One subunit: a clump of spheres grown at random, three colours for its domains."""
    ray = Ray("One subunit of the shell in virus.ray: about a hundred spheres around the origin, outwards is +z.")
    m = [
        ray.gloss((0.86, 0.5, 0.36), 0.18, 0.35),
        ray.gloss((0.93, 0.74, 0.5), 0.18, 0.35),
        ray.gloss((0.75, 0.36, 0.38), 0.18, 0.35),
    ]
    random = Random(5)
    balls = []
    while len(balls) < 110:
        d, r = random.direction(), random.real() ** 0.4
        p = (d[0] * r * 0.95, d[1] * r * 0.95, d[2] * r * 0.72)
        if all(length(sub(p, q)) > 0.235 for q in balls):
            balls.append(p)
    for p in balls:
        domain = 0 if p[2] > 0.25 else 1 if p[0] + 0.5 * p[1] > 0 else 2
        ray.sphere(m[domain], p, 0.25)
    ray.sphere(m[1], (0, 0, 0), 0.55)
    ray.save("parts/protein.ray")


def virus():
    """A T=3 shell: three proteins for each turn of the icosahedron, a window in it, and the strand inside."""
    ray = Ray(
        "The shell of a small virus: one protein at 161 of the 180 places that the turns of the icosahedron give.",
        "The others are left out, so that the strand inside shows.",
        "  dotray render scenes/virus.ray",
    )
    ray.camera((0, 4, 29), (0, 0, 0), 32)
    ray.background(0.09, 0.12, 0.16)
    ray.ambient(0.32, 0.33, 0.36)
    ray.area((0.74, 0.71, 0.66), (-12, 18, 22), (0, 0, 0), 5)
    ray.area((0.3, 0.4, 0.55), (24, -10, -14), (0, 0, 0), 4)
    ray.point((0.2, 0.2, 0.22), (0, 4, 29))
    subunit = ray.include("parts/protein.ray")
    strand = ray.gloss((0.35, 0.68, 0.72), 0.25, 0.4)
    strand2 = ray.gloss((0.62, 0.82, 0.7), 0.25, 0.4)

    golden = (1 + math.sqrt(5)) / 2
    v0 = unit((0, 1, golden))
    v1, v2 = unit((0, -1, golden)), unit((golden, 0, 1))
    face = unit(add(v0, add(v1, v2)))
    mid1, mid2 = unit(add(v0, v1)), unit(add(v0, v2))
    places = [unit(mix(v0, face, 0.42)), unit(mix(face, mid1, 0.52)), unit(mix(face, mid2, 0.52))]
    pose = product(rotate((0, 1, 0), 14), rotate((1, 0, 0), 24))
    eye = unit((3.2, 2.2, 8.5))
    with ray.group(pose):
        ray.comment("the shell")
        for turn in rotations_of_the_icosahedron():
            for kind, place in enumerate(places):
                out = unit(apply(turn, place))
                if dot(apply(pose, out), eye) > 0.79:
                    continue
                x = unit(apply(turn, cross(place, v0)))
                y = cross(out, x)
                at = mul(out, 6.6)
                frame = tuple((x[i], y[i], out[i], at[i]) for i in range(3))
                tilt = (0, 8, -8)[kind]
                with ray.group(product(frame, rotate((1, 0, 0), tilt), scale(1.02, 1.02, 1.0))):
                    ray.instance(subunit)
    ray.comment("the strand")
    count = 900
    for k in range(count):
        t = k / count
        a, b = 2 * math.pi * 23 * t, math.pi * (0.06 + 0.88 * t)
        r = 4.0 + 0.55 * math.sin(2 * math.pi * 97 * t)
        p = (r * math.sin(b) * math.cos(a), r * math.cos(b), r * math.sin(b) * math.sin(a))
        ray.sphere(strand2 if k % 9 == 0 else strand, p, 0.34)
    ray.save("virus.ray")


def main():
    caffeine()
    gyroid()
    protein()
    virus()
