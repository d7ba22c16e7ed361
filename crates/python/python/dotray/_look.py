"""What a scene looks like: camera, lights, materials, textures."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dotray import _dotray
from dotray._values import Vector, check_finite, color, direction, floats, number, vector

_set = object.__setattr__


@dataclass(frozen=True)
class Camera:
    """A pinhole camera, as ``#camera`` has it.

    Parameters
    ----------
    position : (3,) where the eye is.
    direction : (3,) where it looks; any length but 0.
    up : (3,) what is up in the picture; not parallel to the direction.
    half_angle : half of the vertical view angle, in radians; above 0 and below pi/2.

    Raises
    ------
    ValueError
        Naming the argument and its value.

    >>> Camera((0, 0, 5), (0, 0, -1), half_angle=0.4).position
    (0.0, 0.0, 5.0)
    """

    position: Vector
    direction: Vector
    up: Vector = (0.0, 1.0, 0.0)
    half_angle: float = 0.4

    def __post_init__(self) -> None:
        _set(self, "position", vector(self.position, "position"))
        _set(self, "direction", direction(self.direction, "direction"))
        _set(self, "up", direction(self.up, "up"))
        _set(self, "half_angle", number(self.half_angle, "half_angle", 0.0, np.pi / 2, open_=True))
        forward, up = np.array(self.direction), np.array(self.up)
        across = np.linalg.norm(np.cross(forward, up))
        if across <= 1e-12 * np.linalg.norm(forward) * np.linalg.norm(up):
            raise ValueError(f"up is {self.up}: expected a direction not parallel to {self.direction}")

    @classmethod
    def look_at(
        cls,
        position: ArrayLike,
        target: ArrayLike,
        up: ArrayLike = (0.0, 1.0, 0.0),
        half_angle: float = 0.4,
    ) -> Camera:
        """A camera at ``position`` that looks at the point ``target``.

        >>> Camera.look_at((0, 0, 5), (0, 1, 0)).direction
        (0.0, 1.0, -5.0)
        """
        eye, aim = vector(position, "position"), vector(target, "target")
        if eye == aim:
            raise ValueError(f"target is {aim}: expected another point than the position")
        way = (aim[0] - eye[0], aim[1] - eye[1], aim[2] - eye[2])
        return cls(eye, way, vector(up, "up"), half_angle)

    def _numbers(self) -> tuple[Vector, Vector, Vector, float]:
        return (self.position, self.direction, self.up, self.half_angle)


def _fading(value: ArrayLike) -> Vector:
    found = vector(value, "attenuation")
    if min(found) < 0.0 or max(found) == 0.0:
        raise ValueError(f"attenuation is {found}: expected numbers of 0 or more, not all 0")
    return found


@dataclass(frozen=True)
class _Light:
    kind: ClassVar[str] = ""


@dataclass(frozen=True)
class PointLight(_Light):
    """A lamp that shines in all directions, as ``#light_point``.

    ``attenuation`` (a, b, c) makes it fade with the distance d by 1 / (a + b d + c d²); the default does not.

    >>> PointLight((0, 5, 0), color=(1, 1, 0.9), attenuation=(1, 0, 0.01)).position
    (0.0, 5.0, 0.0)
    """

    kind: ClassVar[str] = "point"
    position: Vector
    color: Vector = (1.0, 1.0, 1.0)
    attenuation: Vector = (1.0, 0.0, 0.0)
    direction: ClassVar[Vector] = (0.0, 0.0, 0.0)
    cutoff: ClassVar[float] = 0.0
    dropoff: ClassVar[float] = 0.0
    radius: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        _set(self, "position", vector(self.position, "position"))
        _set(self, "color", color(self.color, "color"))
        _set(self, "attenuation", _fading(self.attenuation))


@dataclass(frozen=True)
class DirectionalLight(_Light):
    """Parallel light that travels along ``direction``, as ``#light_dir``.

    >>> DirectionalLight((0, -1, 0)).color
    (1.0, 1.0, 1.0)
    """

    kind: ClassVar[str] = "directional"
    direction: Vector
    color: Vector = (1.0, 1.0, 1.0)
    position: ClassVar[Vector] = (0.0, 0.0, 0.0)
    attenuation: ClassVar[Vector] = (1.0, 0.0, 0.0)
    cutoff: ClassVar[float] = 0.0
    dropoff: ClassVar[float] = 0.0
    radius: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        _set(self, "direction", direction(self.direction, "direction"))
        _set(self, "color", color(self.color, "color"))


@dataclass(frozen=True)
class SpotLight(_Light):
    """A lamp that shines into a cone about ``direction``, as ``#light_spot``.

    ``cutoff`` is the angle between the axis and the cone's edge, in radians; the light falls off from the axis by the
    cosine to the power of 128 ``dropoff``.

    >>> SpotLight((0, 5, 0), (0, -1, 0), cutoff=0.3).cutoff
    0.3
    """

    kind: ClassVar[str] = "spot"
    position: Vector
    direction: Vector
    color: Vector = (1.0, 1.0, 1.0)
    cutoff: float = 0.5
    dropoff: float = 0.0
    attenuation: Vector = (1.0, 0.0, 0.0)
    radius: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        _set(self, "position", vector(self.position, "position"))
        _set(self, "direction", direction(self.direction, "direction"))
        _set(self, "color", color(self.color, "color"))
        _set(self, "cutoff", number(self.cutoff, "cutoff", 0.0, np.pi))
        _set(self, "dropoff", number(self.dropoff, "dropoff", 0.0))
        _set(self, "attenuation", _fading(self.attenuation))


@dataclass(frozen=True)
class AreaLight(_Light):
    """A disc that shines to its front, as ``#light_area``: its shadows are soft.

    >>> AreaLight((0, 5, 0), (0, -1, 0), radius=0.5).radius
    0.5
    """

    kind: ClassVar[str] = "area"
    position: Vector
    direction: Vector
    radius: float
    color: Vector = (1.0, 1.0, 1.0)
    attenuation: Vector = (1.0, 0.0, 0.0)
    cutoff: ClassVar[float] = 0.0
    dropoff: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        _set(self, "position", vector(self.position, "position"))
        _set(self, "direction", direction(self.direction, "direction"))
        _set(self, "radius", number(self.radius, "radius", 0.0))
        if self.radius == 0.0:
            raise ValueError("radius is 0: expected a number above 0; a light without extent is a PointLight")
        _set(self, "color", color(self.color, "color"))
        _set(self, "attenuation", _fading(self.attenuation))


Light = PointLight | DirectionalLight | SpotLight | AreaLight

_KINDS: dict[str, type[Any]] = {light.kind: light for light in (PointLight, DirectionalLight, SpotLight, AreaLight)}


def light_of_numbers(numbers: dict[str, Any]) -> Light:
    """The light that a file describes, as it is: a file may hold values that one would not type."""
    kind = _KINDS[numbers["kind"]]
    light = object.__new__(kind)
    for name in kind.__dataclass_fields__:
        value = numbers[name]
        _set(light, name, tuple(value) if isinstance(value, list) else value)
    found: Light = light
    return found


@dataclass(frozen=True)
class Texture:
    """An image on surfaces: a file, or an array (H, W, 3) of bytes, or of numbers of which 0 is black and 1 is white.

    ``(u, v)`` = (0, 0) is the image's upper left corner, u runs right, v runs down, and both wrap around.

    >>> board = np.indices((8, 8)).sum(0) % 2
    >>> Texture(np.repeat(board[:, :, None] * 255, 3, axis=2).astype(np.uint8)).extension
    '.png'

    Raises
    ------
    ValueError
        For an array of another shape or dtype, naming it; for numbers that are not finite.
    OSError
        For a file that cannot be read.
    """

    source: Any = field(repr=False, compare=False)
    data: bytes = field(init=False, repr=False)
    extension: str = field(init=False)

    def __post_init__(self) -> None:
        if isinstance(self.source, (str, os.PathLike)):
            path = Path(os.fspath(self.source))
            _set(self, "extension", path.suffix.lower())
            _set(self, "data", path.read_bytes())
        else:
            array = np.asarray(self.source)
            if array.ndim != 3 or array.shape[2] != 3 or 0 in array.shape:
                raise ValueError(f"texture has shape {array.shape}: expected (H, W, 3)")
            if array.dtype == np.uint8:
                _set(self, "extension", ".png")
                # n / 255 in single precision: what a reader of the file gets.
                single = array.astype(np.float32) / np.float32(255.0)
                _set(self, "data", _dotray.encode(single, "texture.png", False, 95, []))
            else:
                table = floats(array, "texture")
                check_finite(table.reshape(-1, 3), "texture")
                single = np.ascontiguousarray(table, dtype=np.float32)
                _set(self, "extension", ".pfm")
                _set(self, "data", _dotray.encode(single, "texture.pfm", False, 95, []))
        _set(self, "source", None)

    def numpy(self) -> NDArray[np.float32]:
        """The image as (H, W, 3) or (H, W, 4) float32, of which 0 is black and 1 is white.

        >>> Texture(np.zeros((2, 4, 3))).numpy().shape
        (2, 4, 3)
        """
        return _dotray.decode(self.data)


@dataclass(frozen=True)
class Material:
    """How a surface answers light, by the names of the formula in the lecture slides.

    Parameters
    ----------
    diffuse : M_D, the colour in the light: three numbers, ``'#rrggbb'`` or a name.
    ambient : M_A, the colour in the shadow; by default that of ``diffuse``.
    specular : M_S, the colour of highlights, mirror images and of what shines through.
    emissive : M_E, what the surface gives off by itself.
    k_specular : ks: how much it mirrors; highlights have the exponent 128 ks.
    k_transmission : kt: how much shines through.
    index_of_refraction : ir: 1.5 for glass, 1.33 for water.
    texture : an image that multiplies ambient and diffuse colour: a :class:`Texture`, or the path of a file.
    text : the material's string: ``noise``, ``marble``, ``wood``, ``checker`` and ``bump`` (docs/format.md).

    >>> Material("red").ambient
    (1.0, 0.0, 0.0)
    >>> mirror = Material(diffuse=(0, 0, 0), specular=(0.9, 0.9, 0.9), k_specular=1)
    >>> glass = Material(diffuse=(0, 0, 0), specular=(1, 1, 1), k_specular=0.1, k_transmission=0.9,
    ...                  index_of_refraction=1.5)
    """

    diffuse: Vector = (0.8, 0.8, 0.8)
    ambient: Vector | None = None
    specular: Vector = (0.0, 0.0, 0.0)
    emissive: Vector = (0.0, 0.0, 0.0)
    k_specular: float = 0.0
    k_transmission: float = 0.0
    index_of_refraction: float = 1.0
    texture: Texture | None = None
    text: str = ""

    def __post_init__(self) -> None:
        _set(self, "diffuse", color(self.diffuse, "diffuse"))
        _set(self, "ambient", self.diffuse if self.ambient is None else color(self.ambient, "ambient"))
        _set(self, "specular", color(self.specular, "specular"))
        _set(self, "emissive", color(self.emissive, "emissive"))
        _set(self, "k_specular", number(self.k_specular, "k_specular", 0.0))
        _set(self, "k_transmission", number(self.k_transmission, "k_transmission", 0.0))
        _set(self, "index_of_refraction", number(self.index_of_refraction, "index_of_refraction"))
        if self.k_transmission > 0.0 and self.index_of_refraction <= 0.0:
            raise ValueError(f"index_of_refraction is {self.index_of_refraction}: expected a number above 0")
        if self.texture is not None and not isinstance(self.texture, Texture):
            _set(self, "texture", Texture(self.texture))
        if "!" in self.text:
            raise ValueError(f"text is {self.text!r}: expected text without '!'")

    def colored(self, by: Vector) -> Material:
        """The same with ambient and diffuse colour multiplied.

        >>> Material().colored((1, 0, 0.5)).diffuse
        (0.8, 0.0, 0.4)
        """
        ambient = self.diffuse if self.ambient is None else self.ambient
        diffuse = tuple(a * b for a, b in zip(self.diffuse, by))
        return Material(
            diffuse=(diffuse[0], diffuse[1], diffuse[2]),
            ambient=(ambient[0] * by[0], ambient[1] * by[1], ambient[2] * by[2]),
            specular=self.specular,
            emissive=self.emissive,
            k_specular=self.k_specular,
            k_transmission=self.k_transmission,
            index_of_refraction=self.index_of_refraction,
            texture=self.texture,
            text=self.text,
        )
