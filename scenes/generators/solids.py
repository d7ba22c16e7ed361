"""Scenes of many spheres and many groups: a sphereflake, a shell of nested groups, a room of mirrors."""

import math

from .ray import Random, Ray, add, cross, mul, product, ramp, rotate, scale, translate, unit


def sphereflake(levels=4):
    """Haines' sphereflake: each ball carries nine of a third of its size, six around its waist and three on top."""
    ray = Ray(
        "Sphereflake after Eric Haines: 7381 balls, each with nine of a third of its size.",
        "  dotray render scenes/sphereflake.ray --recursion 6",
    )
    ray.camera((1.3, 1.2, 5.5), (0, 0.12, 0), 36.5)
    ray.background(0.4, 0.45, 0.52)
    ray.ambient(0.3, 0.3, 0.33)
    ray.point((0.85, 0.78, 0.66), (14, 16, 14))
    sky = ray.texture("textures/sky.png")
    stops = [(0.86, 0.87, 0.9), (0.94, 0.86, 0.72), (0.97, 0.84, 0.6), (0.97, 0.8, 0.54), (0.96, 0.76, 0.5)]
    gold = [ray.metal(stops[k], 0.2, 0.84) for k in range(levels + 1)]
    board = ray.gloss((0.75, 0.75, 0.78), 0.3, 0.6, text="checker scale=.5 color=.95,.93,.9 color2=.26,.3,.38")
    dome = ray.material((3.5, 3.4, 3.2), (0, 0, 0), texture=sky)
    with ray.group(rotate((0, 1, 0), 60)):
        ray.sphere(dome, (0, 0, 0), 60)
    ray.box(board, (0, -1.72, 0), (120, 0.1, 120))

    waist = [(math.cos(math.radians(60 * k)), 0, math.sin(math.radians(60 * k))) for k in range(6)]
    lift = math.radians(54.7356)
    top = [
        (
            math.cos(lift) * math.cos(math.radians(30 + 120 * k)),
            math.sin(lift),
            math.cos(lift) * math.sin(math.radians(30 + 120 * k)),
        )
        for k in range(3)
    ]

    def grow(level, centre, r, axis):
        ray.sphere(gold[level], centre, r)
        if level == levels:
            return
        x = unit(cross(axis, (0.31, 0.2, 1) if abs(axis[2]) < 0.9 else (1, 0.2, 0.31)))
        z = cross(x, axis)
        for d in waist + top:
            way = add(add(mul(x, d[0]), mul(axis, d[1])), mul(z, d[2]))
            grow(level + 1, add(centre, mul(way, r * 4 / 3)), r / 3, way)

    with ray.group(rotate((0, 1, 0), 18)):
        grow(0, (0, 0, 0), 1, (0, 1, 0))
    ray.save("sphereflake.ray")


def nautilus(chambers=150):
    """A shell: every chamber stands in the group of the one before it, turned and shrunk."""
    ray = Ray(
        "A shell of nested groups: every chamber stands inside the group of the one before it,",
        "turned by 9 degrees and shrunk by 2.2 percent, 150 groups deep.",
        "  dotray render scenes/nautilus.ray",
    )
    ray.camera((-0.8, 2.7, 9.6), (0.1, 1.5, 0), 33)
    ray.background(0.5, 0.6, 0.66)
    ray.ambient(0.34, 0.34, 0.36)
    ray.area((0.72, 0.66, 0.55), (-14, 17, 14), (0, 0, 0), 2)
    ray.point((0.14, 0.15, 0.17), (-0.8, 2.7, 9.6))
    sky = ray.texture("textures/sky.png")
    dome = ray.material((2.5, 2.5, 2.3), (0, 0, 0), texture=sky)
    sea = ray.material(
        (0.12, 0.3, 0.36), (0.1, 0.25, 0.3), (0.6, 0.62, 0.64), ks=0.7, text="bump scale=.7 octaves=3 height=.006"
    )
    stops = [
        (0.93, 0.87, 0.78),
        (0.9, 0.7, 0.52),
        (0.8, 0.42, 0.28),
        (0.55, 0.22, 0.2),
        (0.82, 0.5, 0.36),
        (0.95, 0.9, 0.84),
    ]
    skin = [
        ray.gloss(ramp(stops, (0.5 - 0.5 * math.cos(2 * math.pi * k / 12)) * (0.75 if k % 2 else 1)), 0.3, 0.5)
        for k in range(12)
    ]
    sand = ray.matte(
        (0.86, 0.76, 0.6),
        text="noise scale=3 octaves=6 color=1,1,1 color2=.8,.77,.72; bump scale=3 octaves=4 height=.025",
    )
    with ray.group(rotate((0, 1, 0), 30)):
        ray.sphere(dome, (0, 0, 0), 120)
    ray.comment("a beach that falls a little towards the sea")
    with ray.group(rotate((1, 0, 0), -1.2)):
        ray.box(sand, (0, -0.5, 0), (120, 1, 60))
    ray.box(sea, (0, -0.72, -60), (240, 1, 110))
    pebbles = [
        ray.gloss(c, 0.2, 0.4, text="noise scale=6 color=1,1,1 color2=.55,.5,.5")
        for c in ((0.5, 0.5, 0.52), (0.62, 0.52, 0.45), (0.75, 0.74, 0.7))
    ]
    random = Random(3)
    ray.comment("pebbles")
    for k in range(46):
        x, z = random.real(-6.5, 6.5), random.real(-5, 4.2)
        if x * x + z * z * 2 < 13:
            continue
        r = random.real(0.07, 0.26)
        turn = product(translate(x, r * 0.4, z), rotate((0, 1, 0), random.real(0, 180)), scale(1.3, 0.6, 1))
        with ray.group(turn):
            ray.sphere(pebbles[k % 3], (0, 0, 0), r)
    ray.comment("the shell")
    step = product(rotate((0, 0, 1), 9), scale(0.978))
    start = product(translate(0.4, 1.62, 0), rotate((0, 1, 0), -24), rotate((1, 0, 0), -20), rotate((0, 0, 1), -62))
    with ray.group(start):
        opened = 0
        for k in range(chambers):
            with_matrix = step if k else scale(1)
            ray.line(
                "#group_begin " + "  ".join(" ".join(f"{c:.6g}" for c in row) for row in with_matrix) + "  0 0 0 1"
            )
            opened += 1
            ray.depth = min(opened, 12)
            with ray.group(product(translate(1.55, 0, 0), scale(0.62, 0.3, 0.95))):
                ray.sphere(skin[k % 12], (0, 0, 0), 1)
        ray.depth = 0
        for _ in range(opened):
            ray.line("#group_end")
        ray.depth = 1
    ray.save("nautilus.ray")


def lamp(ray, rgb):
    """A paper lantern: it glows, and a little more where it faces the viewer."""
    return ray.material((0, 0, 0), mul(rgb, 2.2), emissive=mul(rgb, 0.6))


def mirrors():
    """A closed room whose walls, floor and ceiling are mirrors, full of lamps."""
    ray = Ray(
        "A closed room of mirrors: every wall repeats every lamp.",
        "  dotray render scenes/mirrors.ray --recursion 40 --cutoff 0.01",
    )
    ray.camera((1.55, 1.5, 2.2), (-0.9, 1.28, -1.5), 66)
    ray.background(0, 0, 0)
    ray.ambient(0.12, 0.12, 0.15)
    ray.point((0.2, 0.2, 0.2), (1.55, 1.5, 2.2))
    wall = ray.material((0, 0, 0), (0, 0, 0), (0.8, 0.83, 0.88), ks=1)
    floor = ray.material((0, 0, 0), (0, 0, 0), (0.5, 0.54, 0.6), ks=1)
    frame = ray.metal((0.35, 0.33, 0.3), 0.3, 0.4)
    wire = ray.glow((0.1, 0.1, 0.11))
    ball = ray.metal((0.92, 0.93, 0.95), 0.05, 1)
    stops = [
        (1.0, 0.42, 0.2),
        (1.0, 0.68, 0.3),
        (0.98, 0.9, 0.66),
        (0.45, 0.75, 0.95),
        (0.35, 0.45, 0.95),
        (0.85, 0.35, 0.75),
    ]
    lamps = [lamp(ray, ramp(stops, k / 11)) for k in range(12)]
    w, h, d = 4.4, 3.0, 5.2
    ray.comment("mirrors: boxes with one edge of 0")
    ray.box(floor, (0, 0, 0), (w, 0, d))
    ray.box(wall, (0, h, 0), (w, 0, d))
    for s in (-1, 1):
        ray.box(wall, (s * w / 2, h / 2, 0), (0, h, d))
        ray.box(wall, (0, h / 2, s * d / 2), (w, h, 0))
    ray.comment("thin frames in the corners")
    for sx in (-1, 1):
        for sz in (-1, 1):
            ray.cylinder(frame, (sx * w / 2, h / 2, sz * d / 2), 0.025, h)
    ray.comment("lamps on wires")
    random = Random(21)
    placed = []
    while len(placed) < 17:
        p = (random.real(-1.9, 1.9), random.real(0.45, 2.55), random.real(-2.3, 2.3))
        if (p[0] - 1.55) ** 2 + (p[2] - 2.2) ** 2 < 1.7 or p[0] ** 2 + (p[1] - 0.9) ** 2 + p[2] ** 2 < 0.9:
            continue
        if all(math.dist(p, q) > 0.75 for q in placed):
            placed.append(p)
    for k, p in enumerate(placed):
        r = 0.1 + 0.1 * random.real()
        ray.sphere(lamps[k % 12], p, r)
        ray.cylinder(wire, (p[0], (p[1] + h) / 2, p[2]), 0.006, h - p[1])
    ray.comment("a mirror ball in the middle")
    ray.sphere(ball, (-0.15, 0.72, -0.25), 0.5)
    ray.cone(frame, (-0.15, 0.12, -0.25), 0.34, 0.24)
    ray.save("mirrors.ray")


def main():
    sphereflake()
    nautilus()
    mirrors()
