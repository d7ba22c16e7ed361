"""Meshes with shared vertices and smooth normals: a knot of porcelain, glasses turned on a lathe."""

import math

from .ray import Ray, add, cross, mul, product, rotate, sub, translate, unit


def surface(ray, material, rows, columns, point, closed_rows=True, texture=(1, 1)):
    """Triangles of a surface point(u, v), u and v from 0 to 1, that closes along v and, if asked, along u."""
    n_rows = rows if closed_rows else rows - 1
    h = 1e-4
    first = None
    for i in range(n_rows + 1):
        for j in range(columns + 1):
            u, v = i / n_rows, j / columns
            if closed_rows:
                du = sub(point(u + h, v), point(u - h, v))
            else:
                du = sub(point(min(u + h, 1), v), point(max(u - h, 0), v))
            dv = sub(point(u, v + h), point(u, v - h))
            normal = unit(cross(du, dv))
            k = ray.vertex(point(u, v), mul(normal, 1), (u * texture[0], v * texture[1]))
            first = k if first is None else first
    for i in range(n_rows):
        for j in range(columns):
            a = first + i * (columns + 1) + j
            b, c, d = a + 1, a + columns + 1, a + columns + 2
            ray.triangle(material, a, c, d)
            ray.triangle(material, a, d, b)


def knot_point(u, v, p=2, q=3, big=2.0, small=0.85, tube=0.52):
    """A torus knot, thickened to a tube by the frame of its tangent and the way to the axis."""

    def centre(t):
        a = 2 * math.pi * t
        r = big + small * math.cos(q * a)
        return (r * math.cos(p * a), small * 1.15 * math.sin(q * a), r * math.sin(p * a))

    c = centre(u)
    tangent = unit(sub(centre(u + 1e-4), centre(u - 1e-4)))
    a = 2 * math.pi * u
    out = (math.cos(q * a) * math.cos(p * a), math.sin(q * a), math.cos(q * a) * math.sin(p * a))
    side = unit(cross(tangent, out))
    up = cross(side, tangent)
    b = 2 * math.pi * v
    return add(c, add(mul(up, tube * math.cos(b)), mul(side, tube * math.sin(b))))


def knot():
    ray = Ray(
        "A torus knot of painted porcelain: a mesh of 14,400 triangles with shared vertices and smooth normals.",
        "  dotray render scenes/knot.ray",
    )
    ray.camera((0, 5.0, 9.3), (0, -0.22, 0), 33)
    ray.background(0.2, 0.2, 0.22)
    ray.ambient(0.32, 0.32, 0.34)
    ray.area((0.62, 0.6, 0.56), (-6, 9, 6), (0, 0, 0), 1.8)
    ray.point((0.14, 0.14, 0.16), (0, 5.0, 9.3))
    painted = ray.texture("textures/porcelain.png")
    porcelain = ray.gloss((0.97, 0.97, 0.97), 0.2, 0.55, texture=painted)
    table = ray.gloss((0.4, 0.27, 0.19), 0.2, 0.6, text="wood scale=4 octaves=4 color=1,1,1 color2=.72,.64,.58")
    wall = ray.matte((0.3, 0.33, 0.35))
    window = ray.glow((1.5, 1.5, 1.45))
    ray.planks(table, -1.52, 8, -12, 24, 1.6, 7)
    ray.box(wall, (0, 10, -12), (80, 40, 1))
    ray.comment("a window that the glaze mirrors")
    with ray.group(product(translate(-7.2, 10.8, 7.2), rotate((0, 1, 0), 130), rotate((1, 0, 0), 47))):
        for x in (-1.1, 1.1):
            for y in (-1.1, 1.1):
                ray.box(window, (x, y, 0), (2, 2, 0.1))
    ray.comment("the knot")
    surface(ray, porcelain, 300, 24, lambda u, v: knot_point(u + 0.02, v), texture=(24, 3))
    ray.save("knot.ray")


def smooth_profile(points, pieces=5):
    """Catmull-Rom through the points of a profile (radius, height)."""
    out = []
    for i in range(len(points) - 1):
        a, b = points[max(i - 1, 0)], points[i]
        c, d = points[i + 1], points[min(i + 2, len(points) - 1)]
        for k in range(pieces):
            t = k / pieces
            out.append(
                tuple(
                    0.5
                    * (
                        2 * b[n]
                        + (c[n] - a[n]) * t
                        + (2 * a[n] - 5 * b[n] + 4 * c[n] - d[n]) * t**2
                        + (3 * b[n] - a[n] - 3 * c[n] + d[n]) * t**3
                    )
                    for n in (0, 1)
                )
            )
    return [*out, points[-1]]


def lathe(ray, material, profile, around=56, start=0):
    """Turns a profile, given from the axis outwards and up, around the y axis."""
    n = len(profile)
    rings = []
    for i, (r, y) in enumerate(profile):
        r0, y0 = profile[max(i - 1, 0)]
        r1, y1 = profile[min(i + 1, n - 1)]
        nr, ny = (y1 - y0), -(r1 - r0)
        if r < 1e-9:
            nr, ny = 0, (-1 if r1 > r0 else 1) if r0 < 1e-9 or r1 < 1e-9 else ny
        size = math.hypot(nr, ny) or 1
        ring = []
        for k in range(1 if r < 1e-9 else around):
            a = 2 * math.pi * k / around
            c, s = math.cos(a), math.sin(a)
            ring.append(ray.vertex((r * c, y, r * s), (nr / size * c, ny / size, nr / size * s)))
        rings.append(ring)
    for low, high in zip(rings, rings[1:]):
        for k in range(around):
            a, b = low[k % len(low)], low[(k + 1) % len(low)]
            c, d = high[k % len(high)], high[(k + 1) % len(high)]
            if a != b:
                ray.triangle(material, a, c, b) if c == d else ray.triangle(material, a, d, b)
            if c != d:
                ray.triangle(material, a, c, d)


FOOT = [
    (0, 0),
    (0.3, 0.0),
    (0.62, 0.0),
    (0.66, 0.025),
    (0.6, 0.055),
    (0.3, 0.1),
    (0.1, 0.2),
    (0.065, 0.45),
    (0.06, 0.9),
    (0.085, 1.15),
]
BOWL_OUT = [(0.3, 1.32), (0.58, 1.62), (0.68, 2.0), (0.62, 2.45), (0.52, 2.85)]
BOWL_IN = [(0.5, 2.87), (0.485, 2.84), (0.585, 2.45), (0.645, 2.0), (0.545, 1.64), (0.28, 1.37), (0, 1.3)]
WINE = [(0, 1.305), (0.277, 1.377), (0.541, 1.645), (0.635, 1.95), (0.632, 1.955), (0.3, 1.955), (0, 1.955)]


def parts_glass():
    ray = Ray("An empty wine glass of one closed surface; its foot stands at y = 0.")
    glass = ray.glass((1, 1, 1), 1.5, 0.1, 0.9)
    lathe(ray, glass, smooth_profile(FOOT + BOWL_OUT + BOWL_IN, 4), 56)
    ray.save("parts/glass.ray")


def parts_wine():
    ray = Ray("The wine of one glass: a closed surface just inside the bowl.")
    wine = ray.glass((0.82, 0.1, 0.12), 1.33, 0.05, 0.9)
    lathe(ray, wine, WINE[:1] + smooth_profile(WINE[:4], 5)[1:] + WINE[4:], 56)
    ray.save("parts/wine.ray")


def glasses():
    parts_glass()
    parts_wine()
    ray = Ray(
        "Wine glasses in front of a lit screen: one mesh, placed three times.",
        "  dotray render scenes/glasses.ray --recursion 10 --cutoff 0.01",
    )
    ray.camera((0.25, 2.35, 8.3), (0.05, 1.42, 0), 27)
    ray.background(0.02, 0.02, 0.03)
    ray.ambient(0.14, 0.14, 0.16)
    ray.spot((0.72, 0.68, 0.61), (0, 3.2, -1.6), (0, 1.6, -6), 80, 0.006)
    ray.area((0.6, 0.58, 0.55), (-4, 7, 4), (0, 0.5, 0), 1.0)
    glass, wine = ray.include("parts/glass.ray"), ray.include("parts/wine.ray")
    table = ray.gloss((0.2, 0.17, 0.16), 0.28, 0.75)
    screen = ray.matte((0.85, 0.8, 0.72))
    strip = ray.glow((1.5, 1.5, 1.55))
    grape = ray.gloss((0.45, 0.6, 0.18), 0.25, 0.45)
    ray.box(table, (0, -0.25, 0), (40, 0.5, 16))
    ray.box(screen, (0, 8, -6), (60, 30, 0.2))
    ray.comment("two strips of light that edge the glasses")
    for s in (-1, 1):
        with ray.group(product(translate(5.2 * s, 3.2, 3.4), rotate((0, 1, 0), -55 * s))):
            ray.box(strip, (0, 0, 0), (0.8, 5.5, 0.05))
    for x, z, turn, full in ((-1.75, -0.3, 0, True), (0.15, 0.45, 40, True), (1.85, -0.5, 10, False)):
        with ray.group(product(translate(x, 0, z), rotate((0, 1, 0), turn))):
            ray.instance(glass)
            if full:
                ray.instance(wine)
    ray.comment("grapes")
    for x, z, y in ((-0.75, 1.15, 0), (-0.5, 1.05, 0), (-0.63, 1.3, 0), (-0.62, 1.15, 0.19), (0.95, 1.3, 0)):
        ray.sphere(grape, (x, 0.13 + y, z), 0.13)
    ray.save("glasses.ray")


def main():
    knot()
    glasses()
