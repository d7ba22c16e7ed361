"""A small writer of `.ray` files, and the vectors and matrices that the generators share.

Standard library only; every generator is deterministic, so that running it again gives the same bytes.
"""

import math
from contextlib import contextmanager
from pathlib import Path

SCENES = Path(__file__).resolve().parent.parent


def num(x):
    """A number with five significant digits, without a leading zero that says nothing."""
    text = f"{x:.5g}"
    if "e" in text:
        text = f"{x:.6f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def nums(*values):
    """Numbers and vectors as one run of text."""
    parts = []
    for v in values:
        parts += [num(c) for c in v] if isinstance(v, (tuple, list)) else [num(v)]
    return " ".join(parts)


# --- vectors ---


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def mul(a, s):
    return tuple(x * s for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return mul(a, 1 / length(a))


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def ramp(stops, t):
    """A colour on a ramp of equally spaced stops, t from 0 to 1."""
    at = min(max(t, 0.0), 1.0) * (len(stops) - 1)
    i = min(int(at), len(stops) - 2)
    return mix(stops[i], stops[i + 1], at - i)


# --- matrices: 3 rows of 4, the last row 0 0 0 1 is understood ---


def translate(x, y, z):
    return ((1, 0, 0, x), (0, 1, 0, y), (0, 0, 1, z))


def scale(x, y=None, z=None):
    y, z = (x if y is None else y), (x if z is None else z)
    return ((x, 0, 0, 0), (0, y, 0, 0), (0, 0, z, 0))


def rotate(axis, degrees):
    x, y, z = unit(axis)
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    d = 1 - c
    return (
        (c + x * x * d, x * y * d - z * s, x * z * d + y * s, 0),
        (y * x * d + z * s, c + y * y * d, y * z * d - x * s, 0),
        (z * x * d - y * s, z * y * d + x * s, c + z * z * d, 0),
    )


def product(*matrices):
    """The product; the last one acts first."""
    out = matrices[0]
    for m in matrices[1:]:
        rows = (*m, (0, 0, 0, 1))
        out = tuple(tuple(sum(r[k] * rows[k][j] for k in range(4)) for j in range(4)) for r in out)
    return out


def apply(matrix, p):
    return tuple(dot(r[:3], p) + r[3] for r in matrix)


def along(start, end):
    """Places the y axis on the way from `start` to `end`, with the middle between them as origin."""
    y = unit(sub(end, start))
    x = unit(cross(y, (0, 0, 1) if abs(y[2]) < 0.9 else (1, 0, 0)))
    z = cross(x, y)
    o = mix(start, end, 0.5)
    return tuple((x[i], y[i], z[i], o[i]) for i in range(3))


class Random:
    """A 32-bit xorshift, so that the scenes do not depend on a library's generator."""

    def __init__(self, seed):
        self.state = seed * 2654435761 % 2**32 or 1
        for _ in range(8):
            self.real()

    def real(self, low=0.0, high=1.0):
        x = self.state
        x ^= x << 13 & 0xFFFFFFFF
        x ^= x >> 17
        x ^= x << 5 & 0xFFFFFFFF
        self.state = x
        return low + (high - low) * x / 2**32

    def direction(self):
        z, a = self.real(-1, 1), self.real(0, 2 * math.pi)
        r = math.sqrt(1 - z * z)
        return (r * math.cos(a), r * math.sin(a), z)


class Ray:
    """Collects a scene and writes it: comments, globals, lights, textures, materials, then the shapes."""

    def __init__(self, *comment):
        self.head = [f"// {line}" for line in comment]
        self.globals, self.lights, self.textures, self.materials = [], [], [], []
        self.files, self.vertices, self.body = [], [], []
        self.depth = 0

    # what stands once

    def camera(self, eye, target, degrees, up=(0, 1, 0)):
        """`degrees` is the whole vertical view angle."""
        half = math.radians(degrees) / 2
        self.globals.append(f"#camera {nums(eye)}  {nums(unit(sub(target, eye)))}  {nums(up)}  {num(half)}")

    def background(self, *rgb):
        self.globals.append(f"#background {nums(rgb)}")

    def ambient(self, *rgb):
        self.globals.append(f"#ambient {nums(rgb)}")

    # lights

    def point(self, rgb, at, attenuation=(1, 0, 0)):
        self.lights.append(f"#light_point {nums(rgb)}  {nums(at)}  {nums(attenuation)}")

    def spot(self, rgb, at, target, degrees, rate, attenuation=(1, 0, 0)):
        way = nums(unit(sub(target, at)))
        cut = nums(math.radians(degrees), rate)
        self.lights.append(f"#light_spot {nums(rgb)}  {nums(at)}  {way}  {nums(attenuation)}  {cut}")

    def sun(self, rgb, way):
        self.lights.append(f"#light_dir {nums(rgb)}  {nums(unit(way))}")

    def area(self, rgb, at, target, radius, attenuation=(1, 0, 0)):
        way = nums(unit(sub(target, at)))
        self.lights.append(f"#light_area {nums(rgb)}  {nums(at)}  {way}  {num(radius)}  {nums(attenuation)}")

    # materials

    def texture(self, name):
        line = f"#texture {name}"
        if line not in self.textures:
            self.textures.append(line)
        return self.textures.index(line)

    def material(self, ambient, diffuse, specular=(0, 0, 0), emissive=(0, 0, 0), ks=0, kt=0, ir=1, texture=-1, text=""):
        colours = "  ".join(nums(c) for c in (ambient, diffuse, specular, emissive))
        self.materials.append(f"#material {colours}  {nums(ks, kt, ir)} {texture} !{text}!")
        return len(self.materials) - 1

    def matte(self, rgb, texture=-1, text=""):
        return self.material(rgb, rgb, texture=texture, text=text)

    def gloss(self, rgb, specular=0.35, ks=0.4, texture=-1, text=""):
        return self.material(rgb, rgb, (specular,) * 3, ks=ks, texture=texture, text=text)

    def metal(self, rgb, body=0.3, ks=0.75, text=""):
        return self.material(mul(rgb, body), mul(rgb, body), rgb, ks=ks, text=text)

    def glass(self, tint=(1, 1, 1), ir=1.5, mirror=0.14, clear=0.86):
        """A small specular colour keeps the highlight small; kt makes up for it in what passes."""
        return self.material((0, 0, 0), (0, 0, 0), mul(tint, 0.24), ks=mirror / 0.24, kt=clear / 0.24, ir=ir)

    def glow(self, rgb):
        return self.material((0, 0, 0), (0, 0, 0), emissive=rgb)

    # shapes

    def line(self, text=""):
        self.body.append("  " * self.depth + text if text else "")

    def comment(self, text):
        self.line(f"// {text}")

    def sphere(self, m, centre, r):
        self.line(f"#shape_sphere {m} {nums(centre, r)}")

    def box(self, m, centre, edges):
        self.line(f"#shape_box {m} {nums(centre)}  {nums(edges)}")

    def cylinder(self, m, centre, r, h):
        self.line(f"#shape_cylinder {m} {nums(centre)}  {nums(r, h)}")

    def cone(self, m, centre, r, h):
        self.line(f"#shape_cone {m} {nums(centre)}  {nums(r, h)}")

    def tube(self, m, start, end, r):
        """A cylinder between two points."""
        with self.group(along(start, end)):
            self.cylinder(m, (0, 0, 0), r, length(sub(end, start)))

    def planks(self, m, top, near, far, reach, width, seed):
        """Boards along x from z = far to z = near. The wood's rings run around the axis of each board's group, which
        lies under the board and is stretched, so that the grain is long."""
        random = Random(seed)
        z = near
        while z > far:
            depth, aside, stretch = random.real(0.5, 1.3), random.real(-0.5, 0.5) * width, 9
            middle = translate(random.real(-2, 2), top - 0.1 - depth, z - width / 2 + aside)
            with self.group(product(middle, rotate((0, 0, 1), -90), scale(1, stretch, 1))):
                self.box(m, (-depth, 0, -aside), (0.2, (2 * reach + 6) / stretch, width - 0.012))
            z -= width

    def vertex(self, p, n, st=(0, 0)):
        self.vertices.append(f"#vertex {nums(p, n, st)}")
        return len(self.vertices) - 1

    def triangle(self, m, i, j, k):
        self.line(f"#shape_triangle {m} {i} {j} {k}")

    def include(self, name):
        self.files.append(f"#ray_file {name}")
        return len(self.files) - 1

    def instance(self, number):
        self.line(f"#ray_file_instance {number}")

    @contextmanager
    def group(self, matrix):
        rows = "  ".join(nums(r) for r in matrix)
        self.line(f"#group_begin {rows}  0 0 0 1")
        self.depth += 1
        yield
        self.depth -= 1
        self.line("#group_end")

    def save(self, name):
        def counted(word, lines):
            return [f"#{word}_num {len(lines)}", *lines] if lines else []

        blocks = [
            self.head,
            self.globals,
            counted("light", self.lights),
            counted("texture", self.textures),
            counted("material", self.materials),
            self.files,
            counted("vertex", self.vertices),
            self.body,
        ]
        text = "\n\n".join("\n".join(b) for b in blocks if b) + "\n"
        (SCENES / name).write_text(text, encoding="ascii", newline="\n")
