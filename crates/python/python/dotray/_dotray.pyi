"""The compiled half of dotray. What it is given has been checked by the other modules of the package."""

from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, TypedDict, final

import numpy as np
from numpy.typing import NDArray

PROGRESS_SCHEMA: int
VERSION: str

__all__ = [
    "Builder",
    "Film",
    "Meter",
    "PROGRESS_SCHEMA",
    "SceneError",
    "VERSION",
    "World",
    "add_boxes",
    "add_cones",
    "add_cylinders",
    "add_spheres",
    "add_triangles",
    "compare",
    "decode",
    "encode",
    "faces_without_area",
    "first_not_finite",
    "first_not_positive",
    "is_singular",
    "work",
    "write_file",
]

_Floats = NDArray[np.float32] | NDArray[np.float64]
_Camera = tuple[Sequence[float], Sequence[float], Sequence[float], float]
_Progress = Callable[[dict[str, Any]], object]
_Told = tuple[str, str, str, tuple[str, int, int] | None, str | None]
_Lighting = tuple[Sequence[float], Sequence[float], Sequence[object]]

class SceneError(ValueError): ...

def first_not_finite(table: _Floats) -> int | None: ...
def first_not_positive(table: _Floats) -> int | None: ...
def faces_without_area(vertices: _Floats, faces: NDArray[np.uint32]) -> list[int]: ...
def is_singular(rows: Sequence[float]) -> bool: ...

@final
class Builder:
    def __new__(cls, carried: dict[str, bytes]) -> Builder: ...
    def load(self, path: str, text: bytes) -> list[tuple[PathLike[str], bytes]]: ...
    def textures(self) -> list[tuple[PathLike[str], bytes]]: ...
    def view(self) -> _View: ...
    def camera(self, numbers: _Camera) -> None: ...
    def background(self, color: Sequence[float]) -> None: ...
    def ambient(self, color: Sequence[float]) -> None: ...
    def light(self, numbers: object) -> None: ...
    def clear_lights(self) -> None: ...
    def texture(self, name: str) -> int: ...
    def material(self, numbers: object, texture: int | None) -> int: ...
    def open_group(self, rows: Sequence[float]) -> None: ...
    def close_group(self) -> None: ...
    def check(self) -> list[_Told]: ...
    def text(self, changed: bool) -> str: ...
    def build(self, choices: dict[str, Any]) -> tuple[World, list[_Told]]: ...

class _View(TypedDict):
    camera: tuple[list[float], list[float], list[float], float] | None
    background: list[float] | None
    ambient: list[float] | None
    lights: list[_LightNumbers]

class _LightNumbers(TypedDict):
    kind: str
    color: list[float]
    position: list[float]
    direction: list[float]
    attenuation: list[float]
    cutoff: float
    dropoff: float
    radius: float

def add_spheres(
    builder: Builder, centers: _Floats, radii: _Floats, material: int, colors: NDArray[np.float32] | None
) -> None: ...
def add_boxes(
    builder: Builder, centers: _Floats, sizes: _Floats, material: int, colors: NDArray[np.float32] | None
) -> None: ...
def add_cylinders(
    builder: Builder,
    starts: _Floats,
    ends: _Floats,
    radii: _Floats,
    caps: bool,
    material: int,
    colors: NDArray[np.float32] | None,
) -> None: ...
def add_cones(
    builder: Builder,
    starts: _Floats,
    ends: _Floats,
    radii: _Floats,
    end_radii: _Floats,
    caps: bool,
    material: int,
    colors: NDArray[np.float32] | None,
) -> None: ...
def add_triangles(
    builder: Builder,
    vertices: _Floats,
    faces: NDArray[np.uint32],
    normals: _Floats | None,
    uv: _Floats | None,
    material: int,
    colors: NDArray[np.float32] | None,
) -> None: ...

@final
class World:
    @property
    def shape_count(self) -> int: ...
    def bounds(self) -> tuple[list[float], list[float]]: ...
    def render(
        self,
        choices: dict[str, Any],
        camera: _Camera | None = None,
        light: _Lighting | None = None,
        progress: _Progress | None = None,
    ) -> tuple[NDArray[np.float32], dict[str, Any]]: ...
    def layers(
        self,
        choices: dict[str, Any],
        names: Sequence[str],
        camera: _Camera | None = None,
        light: _Lighting | None = None,
        progress: _Progress | None = None,
        since: float = 0.0,
    ) -> dict[str, tuple[NDArray[np.float32], list[str]]]: ...
    def explain(
        self,
        choices: dict[str, Any],
        x: float,
        y: float,
        camera: _Camera | None = None,
        light: _Lighting | None = None,
    ) -> dict[str, Any]: ...
    def cast_rays(
        self,
        rays: _Floats,
        geometries: object,
        t_min: float,
        t_max: float,
        coherent: bool,
        surfaces: bool,
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]: ...
    def occluded(
        self, rays: _Floats, t_min: float, t_max: float, coherent: bool, threads: int | None = None
    ) -> NDArray[np.bool_]: ...
    def count_hits(
        self, rays: _Floats, t_min: float, t_max: float, coherent: bool, threads: int | None = None
    ) -> NDArray[np.uint32]: ...
    def all_hits(
        self,
        rays: _Floats,
        geometries: object,
        t_min: float,
        t_max: float,
        coherent: bool,
        threads: int | None = None,
    ) -> dict[str, NDArray[Any]]: ...

def compare(a: NDArray[np.float32], b: NDArray[np.float32], tolerance: float) -> dict[str, Any]: ...
def decode(bytes: bytes) -> NDArray[np.float32]: ...
def encode(
    array: NDArray[np.float32],
    name: str | PathLike[str],
    srgb: bool,
    jpeg_quality: int,
    channels: Sequence[tuple[str, NDArray[np.float32]]],
) -> bytes: ...
def write_file(path: str | PathLike[str], bytes: bytes) -> None: ...

@final
class Meter:
    def __new__(cls) -> Meter: ...
    def advance(self, finished_pixels: int, total_pixels: int) -> dict[str, Any]: ...

@final
class Film:
    def __new__(cls, choices: dict[str, Any], layers: Sequence[str], picture: str) -> Film: ...
    @property
    def counts(self) -> tuple[int, int]: ...
    @property
    def progress(self) -> tuple[int, int]: ...
    def pixels(self, first: int, count: int) -> int: ...
    def merge(self, piece: bytes, first: int, count: int) -> bool: ...
    def take(self) -> tuple[NDArray[np.float32], dict[str, tuple[NDArray[np.float32], list[str]]]]: ...

def work(
    world: World,
    choices: dict[str, Any],
    layers: Sequence[str],
    picture: str,
    first: int,
    count: int,
    camera: _Camera | None = None,
    light: _Lighting | None = None,
) -> bytes: ...
