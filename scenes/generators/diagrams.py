"""Scenes as they stand in papers: a vector field and a network."""

import math

from .ray import Random, Ray, add, along, dot, length, mix, mul, ramp, sub, unit


def dipole(p):
    """The field of two opposite charges at the ends of the magnet."""
    field = (0, 0, 0)
    for sign, at in ((1, (0, 1.0, 0)), (-1, (0, -1.0, 0))):
        d = sub(p, at)
        field = add(field, mul(d, sign / max(length(d), 0.05) ** 3))
    return field


def field():
    """Arrows along the lines of a bar magnet's field; their colour and size tell its strength."""
    ray = Ray("The field of a bar magnet: arrows along its lines, coloured by strength.", "  dotray render scenes/field.ray")
    ray.camera((5.2, 5.4, 14.2), (0, 0.1, 0), 34)
    ray.background(0.96, 0.96, 0.95)
    ray.ambient(0.4, 0.4, 0.43)
    ray.area((0.56, 0.55, 0.52), (-6, 14, 9), (0, 0, 0), 2)
    ray.point((0.18, 0.18, 0.2), (9, 4, 9))
    stops = [(0.2, 0.25, 0.55), (0.15, 0.5, 0.7), (0.3, 0.72, 0.55), (0.95, 0.8, 0.3), (0.92, 0.4, 0.2)]
    palette = [ray.gloss(ramp(stops, k / 19), 0.25, 0.4) for k in range(20)]
    north = ray.gloss((0.78, 0.16, 0.15), 0.35, 0.5)
    south = ray.gloss((0.9, 0.9, 0.9), 0.35, 0.5)
    floor = ray.gloss((0.93, 0.93, 0.93), 0.1, 0.8)
    ray.box(floor, (0, -4.9, 0), (300, 0.2, 300))
    ray.comment("the magnet")
    ray.cylinder(north, (0, 0.6, 0), 0.42, 1.2)
    ray.cylinder(south, (0, -0.6, 0), 0.42, 1.2)
    ray.comment("its field")
    for shell, start in enumerate((24, 44, 66, 92, 118)):
        around = (10, 12, 14, 16, 16)[shell]
        for k in range(around):
            turn = 2 * math.pi * (k + 0.5 * (shell % 2)) / around
            polar = math.radians(start)
            p = add((0, 1.0, 0), (0.5 * math.sin(polar) * math.cos(turn), 0.5 * math.cos(polar), 0.5 * math.sin(polar) * math.sin(turn)))
            trace(ray, palette, p)
    ray.save("field.ray")


def trace(ray, palette, p):
    """Follows the field from p to the other pole and sets an arrow every so often."""
    walked, last, step = 0.0, -1.0, 0.01
    while p[1] > -4.6 and length(sub(p, (0, -1.0, 0))) > 0.42 and length(p) < 6.5:
        f = dipole(p)
        strength = length(f)
        size = 0.3 + 0.34 * min(1, length(p) / 5)
        if walked - last > size * 1.25:
            last = walked
            level = (math.log10(strength) + 1.35) / 2.15
            m = palette[min(19, max(0, int(20 * level)))]
            thick = 0.022 + 0.022 * min(1, max(0, level))
            with ray.group(along(p, add(p, mul(f, size / strength)))):
                ray.cylinder(m, (0, -0.14 * size, 0), thick, 0.7 * size)
                ray.cone(m, (0, 0.34 * size, 0), thick * 2.7, 0.34 * size)
        middle = dipole(add(p, mul(f, step / 2 / strength)))
        p = add(p, mul(middle, step / length(middle)))
        walked += step


COMMUNITIES = [(0.85, 0.33, 0.26), (0.95, 0.7, 0.25), (0.32, 0.62, 0.45), (0.24, 0.48, 0.72), (0.55, 0.38, 0.66), (0.45, 0.47, 0.5)]


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
    place = [mul(random.direction(), 3 * random.real() ** 0.33) for _ in range(people)]
    for turn in range(220):
        heat = 0.25 * (1 - turn / 220) + 0.01
        push = [mul(p, -0.035) for p in place]
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

    ray = Ray("A network: six communities, the size of a ball tells the number of its links.", "  dotray render scenes/network.ray")
    middle = mul(tuple(map(sum, zip(*place))), 1 / people)
    place = [sub(p, middle) for p in place]
    spread = sorted(length(p) for p in place)[int(people * 0.97)]
    place = [mul(p, 4.2 / spread) for p in place]
    radius = [0.1 + 0.062 * math.sqrt(d) for d in degree]
    low = min(p[1] - r for p, r in zip(place, radius))
    ray.camera((3, 3.4, 15.5), (0, -0.3, 0), 34)
    ray.background(0.13, 0.16, 0.2)
    ray.ambient(0.34, 0.35, 0.38)
    ray.area((0.66, 0.64, 0.6), (-6, 13, 9), (0, 0, 0), 2.2)
    ray.point((0.18, 0.2, 0.24), (11, 3, 8))
    balls = [ray.gloss(c, 0.3, 0.45) for c in COMMUNITIES]
    links = [ray.gloss(mix(c, (0.75, 0.75, 0.75), 0.45), 0.15, 0.4) for c in COMMUNITIES]
    bridge = ray.gloss((0.66, 0.67, 0.7), 0.15, 0.4)
    floor = ray.gloss((0.24, 0.29, 0.35), 0.2, 0.7)
    ray.box(floor, (0, low - 0.75, 0), (120, 0.5, 80))
    ray.box(floor, (0, 10, -16), (120, 60, 1))
    for p, r, c in zip(place, radius, member):
        ray.sphere(balls[c], p, r)
    for i, j in edges:
        same = member[i] == member[j]
        ray.tube(links[member[i]] if same else bridge, place[i], place[j], 0.042 if same else 0.026)
    ray.save("network.ray")


def main():
    field()
    network()
