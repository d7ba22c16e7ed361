"""Scenes: what is seen, by whom, in which light; and their pictures."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dotray import _dotray
from dotray._camera import Fit, lamp_above
from dotray._diagnostic import Diagnostic
from dotray._image import Image, add_layers
from dotray._look import AreaLight, Camera, DirectionalLight, Light, PointLight, SpotLight, Texture
from dotray._look import light_of_numbers
from dotray._progress import Bar, Progress
from dotray._options import settings
from dotray._shapes import Container, Group, Record
from dotray._tree import fill, records, textures
from dotray._values import Vector, color, direction, number, vector, whole

if TYPE_CHECKING:
    from concurrent.futures import Executor

__all__ = ["Diagnostic", "Group", "Scene", "load"]


@dataclass(frozen=True)
class Base:
    """A file that the scene began with."""

    path: str
    files: dict[str, bytes]
    camera: Camera | None
    background: Vector
    ambient: Vector
    lights: tuple[Light, ...]


class Scene(Container):
    """Shapes, lights, a background and a camera.

    Parameters
    ----------
    background : the colour where nothing is: three numbers, ``'#rrggbb'`` or a name.
    ambient : the light that is everywhere, L_G.

    A scene without lights is lit by one lamp above the viewer's shoulder; one without camera is seen along -z, as
    large as fits. :attr:`camera`, :attr:`lights`, :attr:`background` and :attr:`ambient` may be set at any time, and
    setting them costs nothing: only shapes and materials make the next picture build what rays meet anew.

    >>> import numpy as np
    >>> scene = Scene()
    >>> geometry = scene.add_spheres(np.eye(3), 0.5, color=np.eye(3))
    >>> scene.render(64, 48).numpy().shape
    (48, 64, 3)
    """

    def __init__(self, *, background: ArrayLike | str = (1.0, 1.0, 1.0), ambient: ArrayLike | str = (0.3, 0.3, 0.3)):
        self._items: list[Record | Group] = []
        self._geometries = 0
        self._base: Base | None = None
        self._world: _dotray.World | None = None
        self._camera: Camera | None = None
        self._fit = Fit()
        self._lights: list[Light] | None = None
        self._background = color(background, "background")
        self._ambient = color(ambient, "ambient")

    def _owner(self) -> Scene:
        return self

    def _changed(self) -> None:
        self._world = None

    def __getstate__(self) -> dict[str, Any]:
        if self._base is not None:
            builder = self._builder()
            self._base.files.update((str(path), content) for path, content in builder.textures())
        return {**self.__dict__, "_world": None}

    # What is seen.

    @property
    def camera(self) -> Camera | None:
        """The camera; ``None`` where one is fitted to the shapes."""
        return self._camera

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        if camera is not None and not isinstance(camera, Camera):
            raise ValueError(f"camera is {camera!r}: expected a Camera or None")
        self._camera = camera

    def look_at(
        self,
        position: ArrayLike,
        target: ArrayLike,
        up: ArrayLike = (0.0, 1.0, 0.0),
        half_angle: float = 0.4,
    ) -> Camera:
        """Places the camera at ``position``, looking at the point ``target``; gives it back.

        ``half_angle`` is half of the vertical view angle in radians. Raises ValueError that names the argument.

        >>> Scene().look_at((0, 0, 5), (0, 0, 0)).direction
        (0.0, 0.0, -5.0)
        """
        self.camera = Camera.look_at(position, target, up, half_angle)
        return self.camera

    def fit(
        self,
        direction_: ArrayLike = (0.0, 0.0, -1.0),
        up: ArrayLike = (0.0, 1.0, 0.0),
        half_angle: float = 0.4,
        margin: float = 1.0,
    ) -> None:
        """Lets each picture's camera look along ``direction_`` from where all shapes are seen.

        ``margin`` multiplies the distance. Raises ValueError that names the argument.

        >>> Scene().fit((-1, -1, -1), up=(0, 0, 1))
        """
        way, above = direction(direction_, "direction"), direction(up, "up")
        Camera((0.0, 0.0, 0.0), way, above, half_angle)
        self._fit = Fit(way, above, float(half_angle), number(margin, "margin", 0.0))
        self._camera = None

    @property
    def background(self) -> Vector:
        """The colour where nothing is."""
        return self._background

    @background.setter
    def background(self, value: ArrayLike | str) -> None:
        self._background = color(value, "background")

    @property
    def ambient(self) -> Vector:
        """L_G, the light that is everywhere."""
        return self._ambient

    @ambient.setter
    def ambient(self, value: ArrayLike | str) -> None:
        self._ambient = color(value, "ambient")

    @property
    def lights(self) -> list[Light] | None:
        """The lights; ``None`` for one lamp above the viewer's shoulder, an empty list for none."""
        return self._lights

    @lights.setter
    def lights(self, lights: Iterable[Light] | None) -> None:
        found = None if lights is None else list(lights)
        for i, light in enumerate(found or []):
            if not isinstance(light, (PointLight, DirectionalLight, SpotLight, AreaLight)):
                raise ValueError(f"lights[{i}] is {light!r}: expected a light")
        self._lights = found

    def add_light(self, light: Light) -> None:
        """Adds a light; the lamp of scenes without lights goes with the first.

        >>> scene = Scene()
        >>> scene.add_light(PointLight((0, 10, 0)))
        >>> len(scene.lights)
        1
        """
        self.lights = [*(self._lights or []), light]

    # What is built of it.

    def _camera_at(self, width: int, height: int) -> Camera:
        if self._camera is not None:
            return self._camera
        return self._fit.camera(*self._built().bounds(), width, height)

    def _lights_from(self, camera: Camera) -> list[Light]:
        if self._lights is not None:
            return self._lights
        return [lamp_above(camera)]

    def _builder(self, names: dict[Texture, str] | None = None) -> _dotray.Builder:
        names = textures(self._items) if names is None else names
        carried = {name: texture.data for texture, name in names.items()}
        if self._base is not None:
            carried |= self._base.files
        builder = _dotray.Builder(carried)
        if self._base is not None:
            builder.load(self._base.path, self._base.files[self._base.path])
        numbers = {texture: builder.texture(name) for texture, name in names.items()}
        fill(builder, self._items, numbers)
        return builder

    def _add_view(self, builder: _dotray.Builder, width: int, height: int) -> bool:
        """Camera, background and light where they are not those of the file that the scene began with; whether any is."""
        camera, light = self._view(width, height)
        if camera is not None:
            builder.camera(camera)
        if light is not None:
            background, ambient, lights = light
            builder.background(background)
            builder.ambient(ambient)
            builder.clear_lights()
            for lamp in lights:
                builder.light(lamp)
        return camera is not None or light is not None

    def _view(self, width: int, height: int) -> tuple[Any, Any]:
        """What a picture sets anew: the camera; background, ambient light and lights."""
        base = self._base
        if base is not None:
            same = (self._background, self._ambient, tuple(self._lights or ())) == (
                base.background,
                base.ambient,
                base.lights,
            )
            if same and self._lights is not None:
                camera = None if self._camera == base.camera else self._camera_at(width, height)._numbers()
                return camera, None
        seen = self._camera_at(width, height)
        return seen._numbers(), (self._background, self._ambient, self._lights_from(seen))

    def _built(self, accel: str = "bvh", build: str = "balanced", threads: int | None = None) -> _dotray.World:
        if self._world is None:
            choices = {"accel": accel, "quality": build, "threads": threads}
            self._world, _ = self._builder().build(choices)
        return self._world

    def _geometry_table(self) -> tuple[NDArray[np.uint32], NDArray[np.uint32], dict[int, NDArray[np.int64]]]:
        """The number of the first shape of each geometry, its number, and which items became shapes."""
        found = [record for record in records(self._items) if record.count]
        counts = np.array([record.count for record in found], np.int64)
        before = self._built().shape_count - int(counts.sum())
        first = before + np.concatenate([[0], np.cumsum(counts)[:-1]]) if found else np.zeros(0, np.int64)
        ids = np.array([record.geometry for record in found], np.uint32)
        if self._base is not None:
            first, ids = np.concatenate([[0], first]), np.concatenate([[0], ids])
        kept = {record.geometry: record.kept for record in found if record.kept is not None}
        return first.astype(np.uint32), ids.astype(np.uint32), kept

    @property
    def shape_count(self) -> int:
        """How many shapes there are.

        >>> scene = Scene()
        >>> scene.add_boxes([[0, 0, 0], [2, 0, 0]], 1), scene.shape_count
        (0, 2)
        """
        return self._built().shape_count

    def bounds(self) -> NDArray[np.float64]:
        """The corners of the box around all shapes: (2, 3), the smallest first.

        >>> scene = Scene()
        >>> geometry = scene.add_boxes([0, 0, 0], 2)
        >>> scene.bounds().round(6).tolist()
        [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]
        """
        return np.array(self._built().bounds())

    # What comes of it.

    def render(
        self,
        width: int = 640,
        height: int = 480,
        *,
        aa: int | str = "none",
        aa_threshold: float = 0.1,
        aa_depth: int = 3,
        recursion: int = 5,
        cutoff: float = 0.002,
        shadows: str = "filtered",
        texture_filter: str = "bilinear",
        light_samples: int = 64,
        transparent: bool = False,
        crop: Sequence[int] | None = None,
        layers: Iterable[str] = (),
        accel: str = "bvh",
        build: str = "balanced",
        threads: int | None = None,
        progress: Progress = None,
        executor: Executor | None = None,
    ) -> Image:
        """Makes a picture. The same scene and options give the same bytes on any machine and number of threads.

        Parameters
        ----------
        width, height : pixels.
        aa : samples a pixel: ``"none"`` for one, a number n for n × n, ``"adaptive"`` for the corners, divided where
            they differ by more than ``aa_threshold``, ``aa_depth`` times at most.
        recursion, cutoff : how deep mirrored and refracted rays go, and the least contribution for which one is traced.
        shadows : ``"filtered"`` (what is see-through dims), ``"opaque"`` or ``"off"``.
        texture_filter : ``"bilinear"`` or ``"nearest"``.
        light_samples : point lights that stand for an :class:`AreaLight`.
        transparent : whether the picture has alpha instead of the background.
        crop : (x, y, width, height) in pixels from the upper left: only this part is made.
        layers : names of layers that the picture's ``layers`` shall hold: depth, normal, position, shape, material, st,
            object, shadow, direct, reflected, transmitted, rays, boxtests, shapetests.
        accel, build, threads : how the nearest shape is found, the effort of building that structure (``"fast"``,
            ``"balanced"``, ``"best"``), and threads (all cores). The picture does not depend on them.
        progress : ``None`` shows a bar where somebody looks (tqdm's where it is installed), ``True`` always, ``False``
            never; a function is called with records as docs/progress.md describes them, dictionaries whose ``event`` is
            ``"picture"``, ``"layers"`` or ``"progress"``. Ctrl-C stops, and so does an exception in the function.
        executor : a ``concurrent.futures.Executor`` whose workers make the tiles: see :mod:`dotray.cluster`.

        Raises
        ------
        ValueError
            For options that make no sense, naming the option, its value and what was expected.
        SceneError
            For a scene that cannot be rendered; its text tells all faults.

        >>> scene = Scene()
        >>> geometry = scene.add_spheres([0, 0, 0], 1, color="teal")
        >>> scene.render(40, 30, aa=2, transparent=True).numpy().shape
        (30, 40, 4)
        """
        choices = settings(
            width,
            height,
            aa=aa,
            aa_threshold=aa_threshold,
            aa_depth=aa_depth,
            recursion=recursion,
            cutoff=cutoff,
            shadows=shadows,
            texture_filter=texture_filter,
            light_samples=light_samples,
            transparent=transparent,
            crop=crop,
            threads=threads,
        )
        names = [layers] if isinstance(layers, str) else list(layers)
        if executor is not None:
            from dotray import cluster

            return cluster._render(self, choices, names, executor, progress)
        world = self._built(accel, build, choices["threads"])
        camera, light = self._view(width, height)
        with Bar(progress) as bar:
            pixels, stats = world.render(choices, camera, light, bar.function)
            image = Image(pixels)
            image.stats = stats
            if names:
                since = time.monotonic() - bar.start
                add_layers(image, world.layers(choices, names, camera, light, bar.function, since))
        return image

    def explain(self, x: int, y: int, width: int = 640, height: int = 480, **options: Any) -> dict[str, Any]:
        """Why a pixel has its colour: the ray through its centre and all that came of it, as nested dictionaries.

        Parameters
        ----------
        x, y : the pixel, counted from the upper left.
        width, height, options : as for :meth:`render`.

        Returns
        -------
        ``kind``, ``origin``, ``direction``, ``color``, … and ``hit``: ``None`` or what was met there, with the terms of
        each light (``lights``) and the rays that were sent on (``reflected``, ``refracted``: another ray or the reason
        why there is none). docs/explain.md describes the terms.

        >>> scene = Scene()
        >>> geometry = scene.add_spheres([0, 0, 0], 1)
        >>> ray = scene.explain(320, 240)
        >>> ray["kind"], ray["hit"]["shape"], ray["hit"]["reflected"]
        ('eye', 0, 'no weight')
        """
        choices = settings(width, height, **options)
        column, row = whole(x, "x", 0, width - 1), whole(y, "y", 0, height - 1)
        camera, light = self._view(width, height)
        return self._built().explain(choices, column + 0.5, row + 0.5, camera, light)

    def check(self) -> list[Diagnostic]:
        """Everything there is to say about the scene: errors, warnings, and what is legal but unlikely.

        >>> scene = Scene()
        >>> [str(message) for message in scene.check()]
        ['warning[no-shape]: the scene has no shape: the picture is all background']
        """
        builder = self._builder()
        if self._items or self._base is not None:
            try:
                self._add_view(builder, 640, 480)
            except _dotray.SceneError:
                pass
        else:
            builder.camera(Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))._numbers())
            builder.light(DirectionalLight((0.0, 0.0, -1.0)))
        return [Diagnostic(*told) for told in builder.check()]

    def to_ray(self, width: int = 640, height: int = 480) -> str:
        """The scene as ``.ray`` text; a camera that is fitted is that of a picture of ``width`` × ``height``.

        Single shapes' colours become materials, one for each colour. Textures keep the names under which
        :meth:`save` writes them. A scene that was loaded from another dialect and changed is written in the slides'
        words; raises ValueError for what those cannot say.

        >>> scene = Scene()
        >>> geometry = scene.add_spheres([0, 0, 0], 1, color="red")
        >>> scene.to_ray().splitlines()[-1]
        '#shape_sphere 0 0 0 0 1'
        """
        return self._text(textures(self._items), width, height)

    def _text(self, names: dict[Texture, str], width: int, height: int) -> str:
        builder = self._builder(names)
        viewed = self._add_view(builder, width, height)
        return builder.text(viewed or bool(self._items))

    def save(self, path: str | os.PathLike[str], width: int = 640, height: int = 480) -> None:
        """Writes the scene as a ``.ray`` file, which ``dotray render`` and :func:`load` make the same picture of.

        Textures are written beside it. ``width`` and ``height`` are those of the picture that a fitted camera is for.

        Raises ValueError for what ``.ray`` cannot say, OSError where a file cannot be written.

        >>> import tempfile, pathlib
        >>> path = pathlib.Path(tempfile.mkdtemp(), "ball.ray")
        >>> scene = Scene()
        >>> geometry = scene.add_spheres([0, 0, 0], 1)
        >>> scene.save(path)
        >>> load(path).shape_count
        1
        """
        path = Path(path)
        base = self._base
        if base is not None and path.resolve().parent != Path(base.path).resolve().parent:
            builder = self._builder()
            others = [str(name) for name, _ in builder.textures()] + [name for name in base.files if name != base.path]
            if others:
                raise ValueError(f"path is {path}: expected a place beside {base.path}, which names {others[0]}")
        found = enumerate(textures(self._items))
        names = {texture: f"{path.stem}-texture-{i}{texture.extension}" for i, texture in found}
        text = self._text(names, width, height)
        for texture, name in names.items():
            _dotray.write_file(path.with_name(name), texture.data)
        _dotray.write_file(path, text.encode())


def load(path: str | os.PathLike[str]) -> Scene:
    """The scene of a ``.ray`` file (of any dialect that ``dotray`` reads) and of all files that it includes.

    Its shapes are geometry 0; more can be added, and camera, lights, background and ambient light can be set.

    Raises
    ------
    SceneError
        For a faulty file: its text tells every fault with its place.
    OSError
        For a file that cannot be read.

    >>> load("no-such.ray")
    Traceback (most recent call last):
    FileNotFoundError: [Errno 2] No such file or directory: 'no-such.ray'
    """
    name = os.fspath(path)
    builder = _dotray.Builder({})
    with open(name, "rb") as file:
        text = file.read()
    files = {str(found): content for found, content in builder.load(name, text)}
    files[name] = text
    seen = builder.view()
    camera, fading = seen["camera"], (0.0, 0.0, 0.0)
    background, ambient = ((tuple(value) if value else fading) for value in (seen["background"], seen["ambient"]))
    scene = Scene(background=background, ambient=ambient)
    scene._lights = [light_of_numbers(dict(numbers)) for numbers in seen["lights"]]
    if camera is not None:
        eye, way, above = (vector(part, "camera") for part in camera[:3])
        scene._camera = Camera(eye, way, above, camera[3])
    scene._geometries = 1
    base_lights = tuple(scene._lights)
    scene._base = Base(name, files, scene._camera, scene._background, scene._ambient, base_lights)
    return scene
