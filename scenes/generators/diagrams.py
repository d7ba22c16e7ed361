"""Scenes as they stand in papers: a vector field and a network."""

import math

from .ray import Random, Ray, add, along, dot, length, mix, mul, ramp, sub


def dipole(p):
    """The field of two opposite charges at the ends of the magnet."""
    field = (0, 0, 0)
    for sign, at in ((1, (0, 1.0, 0)), (-1, (0, -1.0, 0))):
        d = sub(p, at)
        field = add(field, mul(d, sign / max(length(d), 0.05) ** 3))
    return field


def field():
    """Arrows along the lines of a bar magnet's field; their colour and size tell its strength."""
    ray = Ray(
        "The field of a bar magnet: arrows along its lines, coloured by strength.", "  dotray render scenes/field.ray"
    )
    ray.camera((0, 4.6, 15), (0, 0.1, 0), 31.5)
    ray.background(0.06, 0.07, 0.1)
    ray.ambient(0.38, 0.38, 0.4)
    ray.area((0.6, 0.58, 0.54), (-20, 45, 30), (0, 0, 0), 6)
    ray.point((0.2, 0.2, 0.22), (0, 4.6, 15))
    stops = [(0.3, 0.34, 0.75), (0.15, 0.55, 0.78), (0.3, 0.72, 0.55), (0.95, 0.8, 0.3), (0.92, 0.4, 0.2)]
    palette = [ray.gloss(ramp(stops, k / 19), 0.25, 0.4) for k in range(20)]
    north = ray.gloss((0.78, 0.16, 0.15), 0.35, 0.5)
    south = ray.gloss((0.9, 0.9, 0.9), 0.35, 0.5)
    floor = ray.gloss((0.13, 0.15, 0.2), 0.2, 0.8)
    ray.box(floor, (0, -4.3, 0), (300, 0.2, 120))
    ray.comment("the magnet")
    ray.cylinder(north, (0, 0.7, 0), 0.42, 1.4)
    ray.cylinder(south, (0, -0.7, 0), 0.42, 1.4)
    ray.comment("its field")
    for shell, start in enumerate((22, 40, 60, 84, 110)):
        around = (8, 12, 14, 16, 16)[shell]
        for k in range(around):
            turn = 2 * math.pi * (k + 0.5 * (shell % 2)) / around
            polar = math.radians(start)
            p = add(
                (0, 1.0, 0),
                (
                    0.72 * math.sin(polar) * math.cos(turn),
                    0.72 * math.cos(polar),
                    0.72 * math.sin(polar) * math.sin(turn),
                ),
            )
            trace(ray, palette, p)
    ray.save("field.ray")


def trace(ray, palette, p):
    """Follows the field from p to the other pole and sets an arrow every so often."""
    walked, last, step = 0.0, -1.0, 0.01
    while p[1] > -4.0 and length(sub(p, (0, -1.0, 0))) > 0.72 and length(p) < 6.5:
        f = dipole(p)
        strength = length(f)
        size = 0.3 + 0.34 * min(1, length(p) / 5)
        if walked - last > size * 1.25:
            last = walked
            level = (math.log10(strength) + 1.35) / 2.15
            m = palette[min(19, max(0, int(20 * level)))]
            thick = 0.029 + 0.025 * min(1, max(0, level))
            with ray.group(along(p, add(p, mul(f, size / strength)))):
                ray.cylinder(m, (0, -0.14 * size, 0), thick, 0.7 * size)
                ray.cone(m, (0, 0.34 * size, 0), thick * 2.7, 0.34 * size)
        middle = dipole(add(p, mul(f, step / 2 / strength)))
        p = add(p, mul(middle, step / length(middle)))
        walked += step


COMMUNITIES = [
    (0.85, 0.33, 0.26),
    (0.95, 0.7, 0.25),
    (0.32, 0.62, 0.45),
    (0.24, 0.48, 0.72),
    (0.55, 0.38, 0.66),
    (0.42, 0.44, 0.47),
]


def network(people=190):
    """Six communities, laid out in space by springs and repulsion."""
    random = Random(17)
    member = [k % 6 for k in range(people)]
    edges = set()
    for k in range(6, people):
        for _ in range(2 if random.real() < 0.7 else 3):
            near = random.real() < 0.9
            pool = [j for j in range(k) if (member[j] == member[k]) == near]
            popular = min(int(random.real() ** 1.9 * len(pool)), len(pool) - 1)
            edges.add((pool[popular], k))
    edges |= {(a, b) for a in range(6) for b in range(a)}
    edges = sorted((min(e), max(e)) for e in edges)
    edges = sorted(set(edges))
    homes = [
        (3.2 * math.cos(a), 2.9 * math.sin(a), 0.8 * math.sin(2.3 * a)) for a in (0.31, 1.57, 2.83, 4.08, 5.34)
    ] + [(0, 0, 0)]
    place = [add(homes[m], mul(random.direction(), 1.2)) for m in member]
    for turn in range(220):
        heat = 0.25 * (1 - turn / 220) + 0.01
        push = [add(mul(p, -0.03), mul(sub(homes[m], p), 0.05)) for p, m in zip(place, member)]
        for i in range(people):
            for j in range(i):
                d = sub(place[i], place[j])
                r2 = dot(d, d) + 0.01
                if r2 < 9:
                    f = mul(d, 0.16 / (r2 * math.sqrt(r2)))
                    push[i], push[j] = add(push[i], f), sub(push[j], f)
        for i, j in edges:
            d = sub(place[j], place[i])
            pull = 0.22 if member[i] == member[j] else 0.05
            f = mul(d, pull * (length(d) - 0.5) / max(length(d), 0.01))
            push[i], push[j] = add(push[i], f), sub(push[j], f)
        place = [add(p, mul(f, min(1, heat / max(length(f), 1e-9)))) for p, f in zip(place, push)]
    degree = [0] * people
    for i, j in edges:
        degree[i] += 1
        degree[j] += 1

    ray = Ray(
        "A network: six communities, the size of a ball tells the number of its links.",
        "  dotray render scenes/network.ray",
    )
    middle = mul(tuple(map(sum, zip(*place))), 1 / people)
    place = [sub(p, middle) for p in place]
    spread = sorted(length(p) for p in place)[int(people * 0.97)]
    place = [mul(p, 4.2 / spread) for p in place]
    radius = [0.1 + 0.062 * math.sqrt(d) for d in degree]
    low = min(p[1] - r for p, r in zip(place, radius))
    ray.camera((0, 3.2, 15.5), (0, -0.3, 0), 35)
    ray.background(0.9, 0.9, 0.88)
    ray.ambient(0.42, 0.42, 0.43)
    ray.area((0.5, 0.49, 0.47), (-16, 42, 26), (0, 0, 0), 6)
    ray.point((0.14, 0.14, 0.15), (0, 3.2, 15.5))
    balls = [ray.gloss(c, 0.3, 0.45) for c in COMMUNITIES]
    links = [ray.gloss(mix(c, (0.75, 0.75, 0.75), 0.45), 0.15, 0.4) for c in COMMUNITIES]
    bridge = ray.gloss((0.66, 0.67, 0.7), 0.15, 0.4)
    floor = ray.gloss((0.92, 0.92, 0.9), 0.1, 0.8)
    ray.box(floor, (0, low - 0.75, 0), (120, 0.5, 80))
    ray.box(floor, (0, 10, -26), (160, 60, 1))
    for p, r, c in zip(place, radius, member):
        ray.sphere(balls[c], p, r)
    for i, j in edges:
        same = member[i] == member[j]
        ray.tube(links[member[i]] if same else bridge, place[i], place[j], 0.042 if same else 0.026)
    ray.save("network.ray")


def main():
    field()
    network()
