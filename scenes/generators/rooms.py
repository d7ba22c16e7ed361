"""Rooms: a box with one lamp, a still life on a desk, glass in front of tiles."""

import math

from .ray import Random, Ray, product, rotate, scale, translate


def cornell():
    """The classic test room, widened; faint lamps at the walls stand for the light that they would throw back."""
    ray = Ray(
        "A room with one lamp in its ceiling: soft shadows, a mirror and glass.",
        "Three faint lamps stand for the light that the coloured walls and the floor throw back.",
        "  dotray render scenes/cornell.ray --recursion 8 --cutoff 0.01",
    )
    ray.camera((0, 1.0, 4.75), (0, 0.99, 0), 30.5)
    ray.background(0, 0, 0)
    ray.ambient(0.16, 0.155, 0.15)
    ray.area((1, 0.95, 0.85), (0, 1.965, 0), (0, 0, 0), 0.32, (0.62, 0.16, 0.12))
    ray.area((0.17, 0.055, 0.04), (-1.49, 1, 0), (0, 1, 0), 0.7, (0.6, 0.5, 0.5))
    ray.area((0.04, 0.11, 0.14), (1.49, 1, 0), (0, 1, 0), 0.7, (0.6, 0.5, 0.5))
    ray.area((0.46, 0.44, 0.4), (0, 0.01, 0.2), (0, 1, 0.2), 1.1, (1, 0.1, 0.1))
    white, red, blue = (ray.matte(c) for c in ((0.82, 0.8, 0.76), (0.72, 0.16, 0.13), (0.14, 0.4, 0.52)))
    floor = ray.gloss((0.82, 0.8, 0.76), 0.09, 0.7)
    panel = ray.glow((1, 0.97, 0.9))
    frame = ray.metal((0.5, 0.5, 0.5), 0.4, 0.3)
    mirror = ray.material((0.02,) * 3, (0.03,) * 3, (0.9, 0.91, 0.92), ks=1)
    glass = ray.glass((1, 1, 1), 1.5, 0.1, 0.9)
    brass = ray.metal((0.9, 0.7, 0.35), 0.3, 0.6)
    ray.comment("walls: boxes with one edge of 0")
    ray.box(floor, (0, 0, 2), (3, 0, 6.4))
    ray.box(white, (0, 2, 2), (3, 0, 6.4))
    ray.box(white, (0, 1, -1.2), (3, 2, 0))
    ray.box(white, (0, 1, 5.2), (3, 2, 0))
    ray.box(red, (-1.5, 1, 2), (0, 2, 6.4))
    ray.box(blue, (1.5, 1, 2), (0, 2, 6.4))
    ray.comment("the lamp: a disc that glows above the one that shines")
    ray.cylinder(frame, (0, 1.99, 0), 0.36, 0.02)
    ray.cylinder(panel, (0, 1.98, 0), 0.32, 0.02)
    ray.comment("what stands in the room")
    with ray.group(product(translate(-0.66, 0.62, -0.5), rotate((0, 1, 0), 36))):
        ray.box(mirror, (0, 0, 0), (0.62, 1.24, 0.62))
    with ray.group(product(translate(0.66, 0.2, -0.1), rotate((0, 1, 0), -17))):
        ray.box(white, (0, 0, 0), (0.76, 0.4, 0.76))
    ray.sphere(glass, (0.66, 0.74, -0.1), 0.34)
    ray.sphere(brass, (-0.12, 0.17, 0.42), 0.17)
    ray.cone(blue, (-0.85, 0.2, 0.45), 0.15, 0.4)
    ray.save("cornell.ray")


def book(ray, cover, paper, at, turn, size):
    """A closed book that lies flat: two covers, a back, the pages between them."""
    w, h, d = size
    with ray.group(product(translate(*at), rotate((0, 1, 0), turn))):
        ray.box(cover, (0, 0.02, 0), (w, 0.04, d))
        ray.box(cover, (0, h - 0.02, 0), (w, 0.04, d))
        ray.box(paper, (0.03, h / 2, 0), (w - 0.1, h - 0.08, d - 0.08))
        with ray.group(product(translate(-w / 2, h / 2, 0), rotate((1, 0, 0), 90), scale(0.25, 1, 1))):
            ray.cylinder(cover, (0, 0, 0), h / 2, d)


def desk():
    """A globe, books, a glass ball and a mirror ball in the light of a window."""
    ray = Ray(
        "On a desk: a globe, books, pencils, a ball of glass and one of steel in the light of a window.",
        "  dotray render scenes/desk.ray --recursion 8 --cutoff 0.01",
    )
    ray.camera((0.35, 2.75, 7.6), (0.1, 1.12, 0), 34)
    ray.background(0.5, 0.47, 0.43)
    ray.ambient(0.27, 0.27, 0.3)
    ray.area((0.82, 0.78, 0.7), (-7, 7.5, 4.5), (0.5, 0.6, 0), 1.5)
    ray.point((0.16, 0.17, 0.2), (0.35, 2.75, 7.6))
    globe_map, cloth = ray.texture("textures/globe.png"), ray.texture("textures/cloth.png")
    desk_top = ray.gloss((0.72, 0.47, 0.28), 0.16, 0.6, text="wood scale=6 octaves=4 color=1,.98,.94 color2=.78,.7,.62")
    wall = ray.matte(
        (0.6, 0.66, 0.62),
        text="noise scale=.7 octaves=5 color=1,1,1 color2=.86,.87,.86; bump scale=6 octaves=3 height=.006",
    )
    ocean = ray.gloss((1, 1, 1), 0.22, 0.5, texture=globe_map)
    brass = ray.metal((0.88, 0.68, 0.34), 0.35, 0.6)
    walnut = ray.gloss((0.42, 0.25, 0.15), 0.2, 0.5, text="wood scale=7 octaves=4 color=1,1,1 color2=.6,.5,.45")
    woven = ray.matte((1, 1, 1), texture=cloth)
    green, ochre = ray.matte((0.16, 0.3, 0.24), text="bump scale=40 octaves=2 height=.004"), ray.matte((0.72, 0.5, 0.2))
    paper = ray.matte((0.9, 0.86, 0.76))
    glass = ray.glass((1, 1, 1), 1.5, 0.1, 0.9)
    steel = ray.metal((0.9, 0.91, 0.93), 0.04, 0.95)
    lacquer = [ray.gloss(c, 0.3, 0.45) for c in ((0.85, 0.62, 0.1), (0.2, 0.36, 0.6), (0.65, 0.15, 0.15))]
    cedar, lead = ray.matte((0.85, 0.66, 0.45)), ray.gloss((0.15, 0.15, 0.17), 0.3, 0.2)
    window = ray.glow((1.5, 1.45, 1.35))

    ray.comment("desk and wall")
    ray.planks(desk_top, 0, 9, -4.2, 8, 1.3, 6)
    ray.box(wall, (0, 5, -4.2), (40, 20, 0.4))
    ray.comment("the window, behind the lamp; it is seen in the mirror ball and in the glass")
    with ray.group(product(translate(-9, 9, 5.2), rotate((0, 1, 0), 57), rotate((1, 0, 0), 38))):
        for x in (-0.8, 0.8):
            for y in (-0.8, 0.8):
                ray.box(window, (x, y, 0), (1.5, 1.5, 0.05))
    ray.comment("the globe on its stand")
    with ray.group(translate(1.75, 0, -0.9)):
        ray.cylinder(walnut, (0, 0.07, 0), 0.85, 0.14)
        ray.cylinder(walnut, (0, 0.2, 0), 0.6, 0.12)
        ray.cone(brass, (0, 0.52, 0), 0.26, 0.6)
        with ray.group(product(translate(0, 1.98, 0), rotate((0, 0, 1), -23.4))):
            with ray.group(rotate((0, 1, 0), 205)):
                ray.sphere(ocean, (0, 0, 0), 1.2)
            ray.cylinder(brass, (0, 0, 0), 0.03, 2.9)
            ray.sphere(brass, (0, 1.45, 0), 0.08)
            ray.comment("the arc")
            for k in range(-31, 32):
                a = math.radians(k * 90 / 31)
                ray.sphere(brass, (1.38 * math.cos(a), 1.38 * math.sin(a), 0), 0.065)
    ray.comment("books")
    book(ray, green, paper, (-1.9, 0, -1.5), 12, (2.7, 0.46, 1.9))
    book(ray, woven, paper, (-1.85, 0.46, -1.5), -6, (2.4, 0.4, 1.7))
    book(ray, ochre, paper, (-1.95, 0.86, -1.55), 21, (2.0, 0.3, 1.45))
    ray.comment("balls")
    ray.sphere(steel, (-1.9, 1.68, -1.45), 0.52)
    ray.cylinder(brass, (0.05, 0.04, 0.75), 0.3, 0.08)
    ray.sphere(glass, (0.05, 0.68, 0.75), 0.62)
    ray.comment("pencils")
    for k, (x, z, turn) in enumerate(((-2.35, 1.25, 8), (-2.15, 1.6, -14), (1.95, 1.35, 28))):
        with ray.group(product(translate(x, 0.075, z), rotate((0, 1, 0), turn), rotate((0, 0, 1), -90))):
            ray.cylinder(lacquer[k], (0, 0, 0), 0.075, 1.7)
            ray.cone(cedar, (0, 0.975, 0), 0.075, 0.25)
            ray.cone(lead, (0, 1.06, 0), 0.026, 0.085)
            ray.cylinder(brass, (0, -0.88, 0), 0.078, 0.12)
    ray.save("desk.ray")


def lenses():
    """What glass of each shape does to a pattern behind it."""
    ray = Ray(
        "Ball, rod, cone, block and a row of drops: what glass of each shape does to the tiles behind it.",
        "  dotray render scenes/lenses.ray --recursion 10 --cutoff 0.01",
    )
    ray.camera((0, 2.1, 9.2), (0, 1.42, 0), 31)
    ray.background(0.62, 0.66, 0.7)
    ray.ambient(0.42, 0.42, 0.44)
    ray.area((0.5, 0.48, 0.44), (-5, 9, 7), (0, 0.8, -1), 1.6)
    ray.point((0.12, 0.12, 0.13), (0, 2.1, 9.2))
    tiles = ray.texture("textures/tiles.png")
    wall = ray.gloss((0.98, 0.98, 0.98), 0.08, 0.8, texture=tiles)
    shelf = ray.gloss((0.85, 0.83, 0.8), 0.16, 0.7, text="marble scale=.45 octaves=6 color=1,.99,.97 color2=.62,.6,.6")
    clear = ray.glass((1, 1, 1), 1.5, 0.1, 0.9)
    rose = ray.glass((1, 0.87, 0.84), 1.3, 0.1, 0.95)
    sea = ray.glass((0.84, 0.97, 0.95), 1.5, 0.1, 0.95)
    honey = ray.glass((1, 0.86, 0.55), 1.5, 0.1, 0.95)
    thin = ray.glass((1, 0.97, 0.9), 1.3, 0.1, 0.9)
    bubble = ray.glass((1, 1, 1), 1 / 1.3, 0.1, 0.9)
    lamp = ray.glow((1.6, 1.55, 1.45))

    ray.comment("the wall: two triangles, so that each tile repeats")
    ray.line("#shape_triangle %d  -8 0 -2  8 0 -2  8 6 -2  0 0 1  0 0 1  0 0 1  0 6  16 6  16 0" % wall)
    ray.line("#shape_triangle %d  -8 0 -2  8 6 -2  -8 6 -2  0 0 1  0 0 1  0 0 1  0 6  16 0  0 0" % wall)
    ray.box(shelf, (0, -0.25, 2), (18, 0.5, 8))
    ray.comment("a lamp that the glass mirrors")
    with ray.group(product(translate(-5.6, 9.6, 8), rotate((0, 1, 0), -35), rotate((1, 0, 0), 45))):
        ray.box(lamp, (0, 0, 0), (2.6, 2.6, 0.05))
    ray.comment("ball")
    ray.sphere(clear, (-0.72, 1.1, 0.7), 1.1)
    ray.comment("rod")
    ray.cylinder(sea, (-2.72, 1.3, 0.1), 0.58, 2.6)
    ray.comment("cone")
    ray.cone(rose, (1.35, 1.3, -0.2), 0.9, 2.6)
    ray.comment("block, with a bubble of air in it")
    with ray.group(product(translate(2.72, 0.65, 0.5), rotate((0, 1, 0), -24))):
        ray.box(thin, (0, 0, 0), (1.15, 1.3, 1.15))
        ray.sphere(bubble, (0, 0.05, 0), 0.4)
    ray.comment("drops")
    random = Random(8)
    for k in range(9):
        x = -2.35 + 0.6 * k
        r = 0.15 + 0.08 * random.real()
        squeeze = product(translate(x, r * 0.8, 2.55 + 0.3 * math.sin(k * 1.7)), scale(1, 0.8, 1))
        with ray.group(squeeze):
            ray.sphere((clear, honey, sea, rose)[k % 4], (0, 0, 0), r)
    ray.save("lenses.ray")


def main():
    cornell()
    desk()
    lenses()
