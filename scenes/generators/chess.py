"""A chess board: pieces from spheres, cones, cylinders and boxes, in marble and wood."""

import math

from .ray import Ray, product, rotate, scale, translate

# Morphy against two allies, Paris 1858, after the last move.
POSITION = "1n1Rkb1r/p4ppp/4q3/4p1B1/4P3/8/PPP2PPP/2K5"


class Piece:
    """Writes the parts of one piece; heights are counted from the board."""

    def __init__(self, ray, material, x, z, turn):
        self.ray, self.m, self.x, self.z, self.turn = ray, material, x, z, turn

    def disc(self, y, r, h):
        self.ray.cylinder(self.m, (self.x, y + h / 2, self.z), r, h)

    def ball(self, y, r):
        self.ray.sphere(self.m, (self.x, y, self.z), r)

    def egg(self, y, r, flat):
        with self.ray.group(product(translate(self.x, y, self.z), scale(1, flat, 1))):
            self.ray.sphere(self.m, (0, 0, 0), r)

    def spire(self, y, r, h):
        self.ray.cone(self.m, (self.x, y + h / 2, self.z), r, h)

    def foot(self, r):
        self.disc(0, r, 0.09)
        self.egg(0.1, r * 0.97, 0.35)
        self.egg(0.2, r * 0.8, 0.4)
        self.disc(0.24, r * 0.62, 0.05)

    def collar(self, y, r):
        self.egg(y, r, 0.28)
        self.egg(y + 0.07, r * 0.78, 0.3)

    def pawn(self):
        self.foot(0.31)
        self.spire(0.22, 0.22, 0.72)
        self.disc(0.2, 0.1, 0.5)
        self.collar(0.62, 0.19)
        self.ball(0.81, 0.17)

    def rook(self):
        self.foot(0.35)
        self.spire(0.22, 0.29, 0.74)
        self.disc(0.25, 0.18, 0.62)
        self.collar(0.8, 0.25)
        self.disc(0.86, 0.26, 0.14)
        for k in range(8):
            a = math.radians(45 * k)
            at = product(translate(self.x, 1.06, self.z), rotate((0, 1, 0), math.degrees(a)), translate(0.21, 0, 0))
            with self.ray.group(at):
                self.ray.box(self.m, (0, 0, 0), (0.1, 0.14, 0.11))

    def bishop(self):
        self.foot(0.34)
        self.spire(0.22, 0.26, 1.05)
        self.disc(0.25, 0.12, 0.6)
        self.collar(0.84, 0.22)
        self.egg(1.12, 0.18, 1.45)
        self.ball(1.41, 0.06)

    def knight(self):
        self.foot(0.35)
        with self.ray.group(product(translate(self.x, 0, self.z), rotate((0, 1, 0), self.turn))):
            part = self.ray
            with part.group(product(translate(-0.06, 0.6, 0), rotate((0, 0, 1), 12), scale(0.75, 1.5, 0.6))):
                part.sphere(self.m, (0, 0, 0), 0.31)
            with part.group(product(translate(-0.05, 0.92, 0), rotate((0, 0, 1), -24), scale(0.8, 1.25, 0.55))):
                part.sphere(self.m, (0, 0, 0), 0.25)
            with part.group(product(translate(0.13, 1.02, 0), rotate((0, 0, 1), -28), scale(1.5, 0.75, 0.62))):
                part.sphere(self.m, (0, 0, 0), 0.2)
            with part.group(product(translate(0.33, 0.9, 0), rotate((0, 0, 1), -30), scale(1, 0.8, 0.75))):
                part.sphere(self.m, (0, 0, 0), 0.12)
            for side in (-1, 1):
                with part.group(
                    product(translate(-0.05, 1.24, 0.07 * side), rotate((0, 0, 1), 10), scale(0.8, 1, 0.6))
                ):
                    part.cone(self.m, (0, 0, 0), 0.08, 0.22)
            for k in range(6):
                a = math.radians(100 + 17 * k)
                part.sphere(self.m, (-0.02 + 0.3 * math.cos(a), 0.86 + 0.34 * math.sin(a), 0), 0.065)

    def queen(self):
        self.foot(0.38)
        self.spire(0.22, 0.29, 1.3)
        self.disc(0.25, 0.13, 0.9)
        self.collar(1.12, 0.25)
        self.egg(1.34, 0.2, 1.1)
        self.disc(1.42, 0.235, 0.06)
        for k in range(9):
            a = 2 * math.pi * k / 9
            self.ray.sphere(self.m, (self.x + 0.2 * math.cos(a), 1.52, self.z + 0.2 * math.sin(a)), 0.065)
        self.egg(1.48, 0.16, 0.8)
        self.ball(1.66, 0.075)

    def king(self):
        self.foot(0.39)
        self.spire(0.22, 0.3, 1.4)
        self.disc(0.25, 0.14, 1.0)
        self.collar(1.22, 0.26)
        self.egg(1.43, 0.21, 1.05)
        self.disc(1.55, 0.24, 0.07)
        self.egg(1.62, 0.2, 0.5)
        self.ray.box(self.m, (self.x, 1.84, self.z), (0.08, 0.3, 0.08))
        self.ray.box(self.m, (self.x, 1.87, self.z), (0.24, 0.08, 0.08))


NAMES = {"p": "pawn", "r": "rook", "n": "knight", "b": "bishop", "q": "queen", "k": "king"}


def main():
    ray = Ray(
        "The end of a game at the opera, Paris 1858: white has just moved the rook.",
        "Marble, wood and a checkered board are 3-D textures from the materials' strings.",
        "  dotray render scenes/chess.ray",
    )
    ray.camera((-6.0, 4.6, 7.9), (-0.35, 0.1, -0.2), 32)
    ray.background(0.2, 0.17, 0.15)
    ray.ambient(0.24, 0.235, 0.24)
    ray.area((0.95, 0.9, 0.8), (-9, 11, -4), (0, 0, 0), 1.8)
    ray.point((0.2, 0.2, 0.22), (-6.0, 4.6, 7.9))
    light = ray.gloss(
        (0.93, 0.9, 0.84), 0.22, 0.45, text="marble scale=1.6 octaves=5 color=1,.99,.96 color2=.74,.7,.66"
    )
    dark = ray.gloss((0.2, 0.27, 0.25), 0.32, 0.45, text="marble scale=1.9 octaves=6 color=1,1.02,1 color2=.28,.3,.3")
    fields = ray.gloss(
        (0.92, 0.88, 0.8),
        0.22,
        0.65,
        text="checker scale=1 color=.95,.92,.86 color2=.3,.2,.16; marble scale=.8 octaves=6 color2=.72,.7,.68",
    )
    frame = ray.gloss((0.42, 0.24, 0.14), 0.22, 0.55, text="wood scale=3 octaves=5 color=1,1,1 color2=.66,.58,.52")
    table = ray.gloss((0.5, 0.33, 0.21), 0.14, 0.6, text="wood scale=5 octaves=4 color=1,1,1 color2=.75,.68,.62")
    line = ray.metal((0.85, 0.68, 0.38), 0.4, 0.4)
    ray.comment("table and board")
    with ray.group(rotate((0, 1, 0), 18)):
        ray.planks(table, -0.5, 20, -30, 40, 2.2, 3)
    ray.box(fields, (0, -0.2, 0), (8, 0.4, 8))
    for s in (-1, 1):
        ray.box(line, (0, -0.2, 4.03 * s), (8.12, 0.402, 0.06))
        ray.box(line, (4.03 * s, -0.2, 0), (0.06, 0.402, 8))
        for turn in (0, 90):
            # The wood's rings run along each bar, stretched nine times.
            axis = product(
                rotate((0, 1, 0), turn), translate(0.9, -0.9, 4.4 * s), rotate((0, 0, 1), -90), scale(1, 9, 1)
            )
            with ray.group(axis):
                ray.box(frame, (-0.65, -0.1, 0), (0.5, (9.48 if turn == 0 else 8.12) / 9, 0.68))
    for rank, row in enumerate(POSITION.split("/")):
        file = 0
        for sign in row:
            if sign.isdigit():
                file += int(sign)
                continue
            white = sign.isupper()
            ray.comment(f"{NAMES[sign.lower()]} on {'abcdefgh'[file]}{8 - rank}")
            piece = Piece(ray, light if white else dark, file - 3.5, rank - 3.5, 60 if white else -50)
            getattr(piece, NAMES[sign.lower()])()
            file += 1
    ray.save("chess.ray")
