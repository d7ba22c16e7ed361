"""A picture in pieces: what travels to a worker, what comes back, and what is kept on disk.

A piece is a file of tiles, as ``dotray work`` writes it: each tile has a checksum, and the head says what it is of.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dotray import _dotray
from dotray._image import Image, add_layers

__all__ = ["Piece", "SceneMissing", "Shot", "Travelling", "Whole", "compute", "folder_of", "keep", "shots", "stored"]

#: The worlds that this worker has built, the youngest last, by the hash of their scenes.
_worlds: dict[str, _dotray.World] = {}
_building = threading.Lock()
_MOST_WORLDS = 2


class SceneMissing(LookupError):
    """A worker does not have the scene and cannot reach its file."""


@dataclass(frozen=True)
class Travelling:
    """A scene on its way to the workers: where it may be, and how they recognise it."""

    key: str
    path: str
    #: The scene itself where there is no file, or a worker cannot reach it.
    content: bytes | None = None


@dataclass(frozen=True)
class Shot:
    """One picture of the scene: a frame."""

    frame: int
    choices: dict[str, Any]
    layers: tuple[str, ...]
    camera: Any
    light: Any

    def name(self, key: str) -> str:
        """What the picture is recognised by: all that it depends on, beside the scene of this key."""
        choices = sorted((name, value) for name, value in self.choices.items() if name != "threads")
        lights = [] if self.light is None else [self.light[0], self.light[1], *map(repr, self.light[2])]
        told = (_dotray.VERSION, key, choices, self.layers, self.camera, lights)
        return hashlib.sha256(repr(told).encode()).hexdigest()


@dataclass(frozen=True)
class Piece:
    """What one task computes: ``count`` tiles of a picture, by their numbers."""

    shot: Shot
    picture: str
    first: int
    count: int
    pixels: int


def world_of(scene: Travelling) -> _dotray.World:
    """The world of a scene; each worker builds it once."""
    with _building:
        world = _worlds.get(scene.key)
        if world is None:
            content = scene.content
            if content is None:
                try:
                    content = Path(scene.path).read_bytes()
                except OSError as error:
                    raise SceneMissing(str(error)) from None
            if hashlib.sha256(content).hexdigest() != scene.key:
                raise SceneMissing(f"{scene.path} holds another scene")
            world = pickle.loads(content)._built()
            while len(_worlds) >= _MOST_WORLDS:
                _worlds.pop(next(iter(_worlds)))
            _worlds[scene.key] = world
        return world


def compute(scene: Travelling | bytes, piece: Piece) -> bytes:
    """The task: a piece."""
    if isinstance(scene, bytes):
        scene = Travelling(hashlib.sha256(scene).hexdigest(), "", scene)
    shot, world = piece.shot, world_of(scene)
    return _dotray.work(
        world, shot.choices, shot.layers, piece.picture, piece.first, piece.count, shot.camera, shot.light
    )


def stored(piece: Piece, folder: Path | None) -> Path | None:
    """The file that a piece goes to: its name says what it is of."""
    if folder is None:
        return None
    return folder / f"{piece.picture[:32]}.{piece.first:06}-{piece.count:06}.tiles"


class Whole:
    """A picture that comes in pieces."""

    def __init__(self, shot: Shot, picture: str) -> None:
        self.shot, self.picture = shot, picture
        self.film = _dotray.Film(shot.choices, shot.layers, picture)

    @property
    def progress(self) -> tuple[int, int]:
        """Finished and all pixels, those of the layers with those of the picture."""
        return self.film.progress

    def plan(self, edge: int) -> list[Piece]:
        """The pieces of the picture and of its layers, each of about ``edge`` × ``edge`` pixels."""
        crop = self.shot.choices["crop"]
        width = self.shot.choices["width"] if crop is None else crop[2]
        tiles, bands = self.film.counts
        pieces = []
        for start, end, step in [
            (0, tiles, max(1, (edge // 32) ** 2)),
            (tiles, tiles + bands, max(1, edge * edge // (4 * width))),
        ]:
            for first in range(start, end, step):
                count = min(step, end - first)
                pieces.append(Piece(self.shot, self.picture, first, count, self.film.pixels(first, count)))
        return pieces

    def put(self, piece: Piece, content: bytes) -> bool:
        """Takes a piece; false where it is damaged or of something else."""
        return self.film.merge(content, piece.first, piece.count)

    def find(self, piece: Piece, folder: Path | None) -> bool:
        """Takes a piece that is on the disk; false where there is none."""
        path = stored(piece, folder)
        if path is None or not path.exists():
            return False
        return self.put(piece, path.read_bytes())

    def image(self) -> Image:
        """The picture, which leaves the film."""
        pixels, layers = self.film.take()
        image = Image(pixels)
        add_layers(image, layers)
        return image


def keep(piece: Piece, content: bytes, folder: Path | None) -> None:
    """Writes a piece to the disk, whole."""
    path = stored(piece, folder)
    if path is not None:
        _dotray.write_file(path, content)


def folder_of(directory: str | os.PathLike[str] | None) -> Path | None:
    """The folder of the pieces, which is made."""
    folder = None if directory is None else Path(directory)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def shots(
    views: Sequence[tuple[Any, Any]], choices: dict[str, Any], layers: tuple[str, ...]
) -> list[Shot]:
    """One for each view."""
    return [Shot(frame, choices, layers, camera, light) for frame, (camera, light) in enumerate(views)]
