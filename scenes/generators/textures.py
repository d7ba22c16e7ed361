"""The test images of the scenes: small, drawn from formulas, written without an imaging library."""

import math
import struct
import zlib

from .ray import SCENES, Random, mix, ramp


def write_png(name, width, height, pixel):
    """`pixel(x, y)` gives a colour of three numbers from 0 to 1; the upper row is y = 0."""
    rows = bytearray()
    for y in range(height):
        row = [round(255 * min(max(c, 0), 1)) for x in range(width) for c in pixel(x, y)]
        rows.append(1)  # each byte less its left neighbour: small for flat pictures
        rows += bytes((c - (row[i - 3] if i >= 3 else 0)) % 256 for i, c in enumerate(row))

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(rows), 9))
    (SCENES / "textures" / name).write_bytes(data + chunk(b"IEND", b""))


def write_bmp(name, width, height, pixel):
    """24 bits a pixel, the lowest row first, rows padded to four bytes."""
    pad = -3 * width % 4
    rows = bytearray()
    for y in reversed(range(height)):
        for x in range(width):
            rows += bytes(round(255 * min(max(c, 0), 1)) for c in reversed(pixel(x, y)))
        rows += bytes(pad)
    header = struct.pack("<2sIHHI", b"BM", 54 + len(rows), 0, 0, 54)
    header += struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(rows), 2835, 2835, 0, 0)
    (SCENES / "textures" / name).write_bytes(header + rows)


def smooth_noise(seed, cells_x, cells_y):
    """Value noise that wraps around in x; returns a function of u, v in 0…1."""
    random = Random(seed)
    grid = [[random.real() for _ in range(cells_x)] for _ in range(cells_y + 1)]

    def at(u, v):
        x, y = u * cells_x, v * cells_y
        i, j = int(x) % cells_x, min(int(y), cells_y - 1)
        fx, fy = x - int(x), y - j
        fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
        i1 = (i + 1) % cells_x
        top = grid[j][i] + (grid[j][i1] - grid[j][i]) * fx
        low = grid[j + 1][i] + (grid[j + 1][i1] - grid[j + 1][i]) * fx
        return top + (low - top) * fy

    return at


def layers(seed, cells_x, cells_y, octaves):
    """A sum of value noises, each twice as fine and half as strong."""
    parts = [smooth_noise(seed + k, cells_x << k, cells_y << k) for k in range(octaves)]
    weight = sum(0.5**k for k in range(octaves))
    return lambda u, v: sum(0.5**k * part(u, v) for k, part in enumerate(parts)) / weight


def test_card(size=128):
    """Fields of a changing hue, a frame, a diagonal and a disc: every flip and every seam shows."""

    def pixel(x, y):
        u, v = (x + 0.5) / size, (y + 0.5) / size
        field = (
            (0.95, 0.75 - 0.5 * v, 0.2 + 0.6 * u) if (x // 16 + y // 16) % 2 else (0.15 + 0.5 * u, 0.35, 0.85 - 0.5 * v)
        )
        if min(x, y, size - 1 - x, size - 1 - y) < 3:
            return (0.98, 0.96, 0.9)
        if abs(x - y) < 2:
            return (0.98, 0.96, 0.9)
        if math.hypot(u - 0.72, v - 0.28) < 0.14:
            return (0.98, 0.85, 0.2)
        if 0.62 < v < 0.82 and 0.12 < u < 0.16 + 0.2 * (v - 0.62) / 0.2:
            return (0.1, 0.1, 0.14)
        return field

    write_bmp("test-card.bmp", size, size, pixel)


def tiles(size=256):
    """Glazed tiles, white and blue: four quarter circles, a star in the middle, a leaf on each side."""
    white, blue, pale, gold = (0.95, 0.95, 0.92), (0.1, 0.22, 0.55), (0.45, 0.62, 0.85), (0.9, 0.68, 0.2)

    def sample(u, v):
        x, y = abs(u - 0.5) * 2, abs(v - 0.5) * 2
        r, a = math.hypot(x, y), math.atan2(y, x)
        corner = math.hypot(1 - x, 1 - y)
        if max(x, y) > 0.975:
            return (0.72, 0.72, 0.7)
        if corner < 0.2:
            return gold if corner < 0.1 else blue
        if 0.3 < corner < 0.42:
            return blue
        if 0.42 < corner < 0.5:
            return pale
        star = 0.36 + 0.14 * math.cos(8 * a)
        if r < 0.13:
            return gold
        if r < star - 0.1:
            return pale
        if r < star:
            return blue
        side, off = max(x, y), min(x, y)
        if 0.55 < side < 0.95 and off < 0.11 * math.sin(math.pi * (side - 0.55) / 0.4):
            return blue
        return white

    def pixel(x, y):
        points = [sample((x + a) / size, (y + b) / size) for a in (0.25, 0.75) for b in (0.25, 0.75)]
        return tuple(sum(c) / 4 for c in zip(*points))

    write_png("tiles.png", size, size, pixel)


def globe(width=512, height=256):
    """An invented planet: two noises make the land, latitude and height its colour, a net of meridians on top."""
    land = layers(11, 5, 3, 6)
    detail = layers(31, 16, 8, 3)
    shore = [(0.85, 0.78, 0.55), (0.55, 0.65, 0.35), (0.4, 0.52, 0.28), (0.6, 0.5, 0.36), (0.75, 0.68, 0.6)]

    def pixel(x, y):
        u, v = (x + 0.5) / width, (y + 0.5) / height
        h = land(u, v) + 0.1 * (detail(u, v) - 0.5)
        polar = abs(v - 0.5) * 2
        if polar > 0.86 + 0.12 * (detail(u, v) - 0.5):
            colour = (0.93, 0.94, 0.95)
        elif h > 0.5:
            colour = ramp(shore, (h - 0.5) / 0.2)
        else:
            colour = mix((0.1, 0.25, 0.45), (0.35, 0.62, 0.72), max(0, 1 - (0.5 - h) * 6))
        on_line = min(u * 24 % 1, 1 - u * 24 % 1) < 0.025 or min(v * 12 % 1, 1 - v * 12 % 1) < 0.025
        return mix(colour, (0.25, 0.2, 0.15), 0.35) if on_line else colour

    write_png("globe.png", width, height, pixel)


def cloth(width=256, height=128):
    """A woven pattern of stripes, for book covers and blankets."""

    def pixel(x, y):
        weave = 0.9 + 0.1 * ((x // 2 + y // 2) % 2)
        band = y * 16 // height
        base = [(0.55, 0.12, 0.12), (0.8, 0.62, 0.25), (0.5, 0.1, 0.12), (0.12, 0.2, 0.32)][band % 4]
        diamond = abs((x % 32) - 16) + abs((y % 32) - 16)
        if diamond in (7, 8):
            base = (0.9, 0.8, 0.55)
        return tuple(c * weave for c in base)

    write_png("cloth.png", width, height, pixel)


def porcelain(width=256, height=256):
    """Cobalt vines on white that wrap in both directions."""

    def sample(u, v):
        wave = 0.5 + 0.2 * math.sin(2 * math.pi * u)
        vine = abs(v - wave)
        d = 1.0
        for k in range(4):
            cu = (k + 0.5) / 4
            cv = 0.5 + 0.2 * math.sin(2 * math.pi * cu) + (0.24 if k % 2 else -0.24)
            du = min(abs(u - cu), 1 - abs(u - cu))
            dv = min(abs(v - cv % 1), 1 - abs(v - cv % 1))
            r, a = math.hypot(du, dv), math.atan2(dv, du)
            d = min(d, r / (0.085 + 0.03 * math.cos(6 * a)))
        if d < 0.3:
            return (0.85, 0.65, 0.2)
        if d < 1.0:
            return mix((0.1, 0.2, 0.6), (0.35, 0.5, 0.85), d)
        if vine < 0.018:
            return (0.12, 0.25, 0.6)
        if min(v, 1 - v) < 0.03:
            return (0.12, 0.2, 0.55)
        if 0.045 < min(v, 1 - v) < 0.055:
            return (0.12, 0.2, 0.55)
        return (0.96, 0.96, 0.95)

    def pixel(x, y):
        points = [sample((x + a) / width, (y + b) / height) for a in (0.25, 0.75) for b in (0.25, 0.75)]
        return tuple(sum(c) / 4 for c in zip(*points))

    write_png("porcelain.png", width, height, pixel)


def sky(width=512, height=256):
    """An evening sky for the inside of a sphere: the upper half is air with thin clouds, the lower is haze."""
    cloud = layers(71, 8, 24, 4)
    stops = [(0.16, 0.28, 0.5), (0.3, 0.47, 0.68), (0.55, 0.68, 0.8), (0.88, 0.83, 0.76), (0.98, 0.8, 0.6)]

    def pixel(x, y):
        u, v = (x + 0.5) / width, (y + 0.5) / height
        if v > 0.5:
            return (0.75, 0.66, 0.58)
        base = ramp(stops, min(1, (2 * v) ** 5))
        streak = cloud(u, v * 2)
        thick = max(0.0, min(1.0, (streak - 0.5) * 4)) * min(1, (1 - 2 * v) * 8) * 0.85
        return mix(base, (0.98, 0.93, 0.9), thick)

    write_png("sky.png", width, height, pixel)


def main():
    test_card()
    tiles()
    globe()
    cloth()
    porcelain()
    sky()
