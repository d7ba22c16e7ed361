"""A lake between hills: two trees in files of their own, placed hundreds of times."""

import math

from .ray import Random, Ray, add, mul, product, rotate, scale, translate, unit
from .textures import layers


def oak():
    """A leafy tree about 3 high: a trunk that forks, and clumps of leaves along the branches."""
    ray = Ray("A leafy tree, about 3 high, its foot at the origin.")
    bark = ray.matte((0.36, 0.27, 0.2))
    leaves = [ray.matte(c) for c in ((0.36, 0.46, 0.16), (0.44, 0.52, 0.18), (0.3, 0.41, 0.16), (0.55, 0.55, 0.2))]
    random = Random(9)
    tips = []

    def branch(start, way, size, r, depth):
        end = add(start, mul(way, size))
        ray.tube(bark, start, end, r)
        if depth == 0:
            tips.append(end)
            return
        for _ in range(3):
            turned = unit(add(way, mul(random.direction(), 0.75)))
            branch(end, unit(add(turned, (0, 0.12, 0))), size * 0.72, r * 0.62, depth - 1)
        if depth < 3:
            tips.append(end)

    branch((0, -0.2, 0), (0, 1, 0), 1.15, 0.11, 3)
    for tip in tips:
        for _ in range(4):
            p = add(tip, mul(random.direction(), 0.3 * random.real()))
            ray.sphere(leaves[int(4 * random.real())], p, random.real(0.13, 0.26))
    ray.save("parts/oak.ray")


def pine():
    """A fir about 4 high: rings of drooping boughs, each a flat ellipsoid."""
    ray = Ray("A fir, about 4 high, its foot at the origin.")
    bark = ray.matte((0.3, 0.22, 0.17))
    needles = [ray.matte(c) for c in ((0.1, 0.24, 0.17), (0.13, 0.28, 0.18), (0.17, 0.32, 0.2))]
    ray.cylinder(bark, (0, 0.6, 0), 0.09, 1.6)
    random = Random(4)
    layers_of_boughs = 13
    for k in range(layers_of_boughs):
        t = k / (layers_of_boughs - 1)
        y, reach = 0.6 + 3.1 * t, 1.05 * (1 - t) ** 0.9 + 0.1
        count = 11 - int(6 * t)
        for j in range(count):
            a = 360 * (j + random.real(0, 0.6)) / count + 40 * k
            bough = product(
                translate(0, y, 0),
                rotate((0, 1, 0), a),
                rotate((0, 0, 1), -22 - 12 * (1 - t)),
                translate(reach * 0.5, 0, 0),
                scale(reach * 0.55, 0.1, 0.19),
            )
            with ray.group(bough):
                ray.sphere(needles[int(3 * random.real())], (0, 0, 0), 1)
    ray.cone(needles[1], (0, 3.95, 0), 0.12, 0.6)
    ray.save("parts/pine.ray")


HILLS = layers(41, 5, 5, 5)


def height(x, z):
    """The land: a basin for the lake, low shores, hills behind it."""
    noise = HILLS((x / 90 + 0.5) % 1, min(max((z + 62) / 90, 0), 0.999))
    lake = math.hypot((x - 1.5) / 14, (z - 3) / 16)
    shore = 1.5 * (min(lake, 1.7) - 1) + 1.1 * (noise - 0.5)
    back = max(0.0, (-z - 9) / 40)
    return shore + back * (6.5 * noise + 6 * max(0, noise - 0.5))


def lake():
    oak()
    pine()
    ray = Ray(
        "A lake between hills: about 230 trees, each an instance of one of two files.",
        "  dotray render scenes/lake.ray",
    )
    ray.camera((-1.2, 2.5, 16.2), (0.2, 1.75, 0), 36)
    ray.background(0.8, 0.74, 0.66)
    ray.ambient(0.36, 0.38, 0.44)
    ray.point((0.92, 0.8, 0.6), (-120, 75, 60))
    oak_file, pine_file = ray.include("parts/oak.ray"), ray.include("parts/pine.ray")
    sky = ray.texture("textures/sky.png")
    dome = ray.material((2.75, 2.62, 2.3), (0, 0, 0), texture=sky)
    grass = ray.matte((0.44, 0.47, 0.25), text="noise scale=.9 octaves=6 color=1.1,1.08,1 color2=.62,.66,.55")
    water = ray.material(
        (0.05, 0.08, 0.09), (0.03, 0.06, 0.07), (0.78, 0.82, 0.85), ks=0.85, text="bump scale=1.6 octaves=3 height=.012"
    )
    stone = ray.matte((0.55, 0.53, 0.5), text="noise scale=5 color=1,1,1 color2=.6,.6,.6; bump scale=5 height=.06")
    wall, roof = ray.matte((0.62, 0.24, 0.18)), ray.matte((0.28, 0.27, 0.28))
    white, pane, plank = ray.matte((0.9, 0.88, 0.84)), ray.glow((0.95, 0.8, 0.45)), ray.matte((0.5, 0.4, 0.3))
    with ray.group(rotate((0, 1, 0), 75)):
        ray.sphere(dome, (0, 0, 0), 260)
    ray.comment("mountains, pale with distance")
    far = [ray.material(mul(c, 1.6), mul(c, 0.35)) for c in ((0.68, 0.74, 0.8), (0.54, 0.62, 0.68), (0.4, 0.5, 0.5))]
    for m, x, z, wide, high in (
        (0, -70, -190, 80, 44),
        (0, 60, -200, 70, 38),
        (0, 5, -210, 60, 34),
        (1, -115, -150, 60, 30),
        (1, 110, -150, 62, 33),
        (1, 28, -160, 52, 24),
        (2, -42, -120, 48, 15),
        (2, 62, -118, 40, 14),
    ):
        with ray.group(product(translate(x, -2, z), scale(wide, high, 20))):
            ray.cone(far[m], (0, 0.5, 0), 1, 1)
    ray.comment("water")
    ray.box(water, (0, -0.5, 0), (80, 1, 60))
    ray.comment("land")
    nx, nz, x0, z0, step = 88, 62, -52.0, -62.0, 1.2
    for j in range(nz + 1):
        for i in range(nx + 1):
            x, z = x0 + i * step, z0 + j * step
            dx = height(x + 0.3, z) - height(x - 0.3, z)
            dz = height(x, z + 0.3) - height(x, z - 0.3)
            ray.vertex((x, height(x, z), z), unit((-dx, 0.6, -dz)))
    for j in range(nz):
        for i in range(nx):
            a = j * (nx + 1) + i
            corners = (a, a + 1, a + nx + 1, a + nx + 2)
            z = z0 + j * step
            if max(height(x0 + (i + di) * step, z + dj * step) for di in (0, 1) for dj in (0, 1)) < -0.1:
                continue
            ray.triangle(grass, corners[0], corners[2], corners[1])
            ray.triangle(grass, corners[1], corners[2], corners[3])

    hut_x, hut_z = 5.4, -15.2
    ray.comment("the house")
    with ray.group(product(translate(hut_x, height(hut_x, hut_z) - 0.05, hut_z), rotate((0, 1, 0), -18))):
        house(ray, wall, roof, white, pane)
    ray.comment("the jetty")
    for k in range(9):
        ray.box(plank, (4.3 - 0.1 * k, 0.24, -13.0 + 0.42 * k), (1.0, 0.06, 0.36))
    for k in (2, 5, 8):
        for s in (-0.42, 0.42):
            ray.cylinder(plank, (4.3 - 0.1 * k + s, 0.1, -13.0 + 0.42 * k), 0.05, 0.8)
    random = Random(12)
    ray.comment("stones")
    for _ in range(60):
        x, z = random.real(-14, 15), random.real(-15, 6)
        h = height(x, z)
        if -0.25 < h < 0.18:
            size = random.real(0.12, 0.5)
            with ray.group(
                product(translate(x, h, z), rotate((0, 1, 0), random.real(0, 180)), scale(size * 1.3, size * 0.7, size))
            ):
                ray.sphere(stone, (0, 0, 0), 1)
    ray.comment("trees")
    planted = []
    tries = 0
    while len(planted) < 230 and tries < 20000:
        tries += 1
        x, z = random.real(-34, 34), random.real(-46, 6)
        h = height(x, z)
        if h < 0.35 or math.hypot(x - hut_x, z - hut_z) < 3.0 or abs(x) > 9 + (16 - z) * 0.62:
            continue
        if abs(x - 4) < 2.2 and -15 < z < -6:
            continue
        if any(math.hypot(x - a, z - b) < 1.15 for a, b in planted):
            continue
        planted.append((x, z))
        fir = h > 1.7 if random.real() < 0.8 else random.real() < 0.5
        size = random.real(0.7, 1.15) * (1.0 if fir else 1.1)
        place = product(
            translate(x, h - 0.05, z),
            rotate((0, 1, 0), random.real(0, 360)),
            scale(size * random.real(0.9, 1.1), size, size),
        )
        with ray.group(place):
            ray.instance(pine_file if fir else oak_file)
    ray.save("lake.ray")


def house(ray, wall, roof, white, pane):
    """A red house with a gable: the roof is two sheared boxes, the gables are triangles."""
    ray.box(wall, (0, 0.7, 0), (2.4, 1.4, 1.8))
    for s in (-1, 1):
        slope = ((1, 0, 0, 0), (0, 1, -0.8 * s, 1.82), (0, 0, 1, 0.53 * s))
        with ray.group(slope):
            ray.box(roof, (0, 0, 0), (2.8, 0.1, 1.08))
        x = 1.2 * s
        ray.line(f"#shape_triangle {wall}  {x} 1.4 -0.9  {x} 1.4 0.9  {x} 2.12 0  0 0 0  0 0 0  0 0 0  0 0  0 0  0 0")
    ray.box(white, (0.75, 2.1, -0.3), (0.3, 0.8, 0.3))
    for x in (-0.75, 0.7):
        ray.box(white, (x, 0.85, 0.9), (0.5, 0.6, 0.06))
        ray.box(pane, (x, 0.85, 0.92), (0.4, 0.5, 0.06))
        ray.box(white, (x, 0.85, 0.94), (0.04, 0.5, 0.06))
        ray.box(white, (x, 0.85, 0.94), (0.4, 0.04, 0.06))
    ray.box(white, (0, 0.5, 0.9), (0.55, 1.0, 0.06))


def main():
    lake()
