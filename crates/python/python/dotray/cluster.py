"""Pictures and films on many machines, through any ``concurrent.futures.Executor``.

Nothing of this starts an engine: it uses one that is there. With Dask:

>>> from concurrent.futures import ThreadPoolExecutor
>>> import dotray
>>> scene = dotray.Scene()
>>> geometry = scene.add_spheres([0, 0, 0], 1)
>>> with ThreadPoolExecutor(2) as executor:  # or: Client("scheduler:8786").get_executor(pure=False, retries=3)
...     image = scene.render(64, 48, executor=executor)
>>> bool((image.numpy() == scene.render(64, 48).numpy()).all())
True

A picture is cut into pieces, each a function of scene, options and place alone: whoever computes one, and however
often, the bytes are those of one machine. The scene travels to each worker once; pieces come back in any order and go
to disk as they come; what is lost with a worker is computed again by another.
"""

from __future__ import annotations

import hashlib
import io
import os
import pickle
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dotray import _dotray
from dotray._image import Image, add_layers
from dotray._look import Camera
from dotray._options import settings
from dotray._progress import Bar, Progress
from dotray._scene import Scene
from dotray._values import number, whole

__all__ = ["LostWork", "frames", "render"]

#: Pieces begin at multiples of this, as the renderer's own tiles do.
_TILE = 32

#: The worlds that this worker has built, the youngest last, by the hash of their scenes.
_worlds: dict[str, _dotray.World] = {}
_building = threading.Lock()
_MOST_WORLDS = 2


class LostWork(RuntimeError):
    """A piece was computed in vain too often; ``__cause__`` is what went wrong last."""


class SceneMissing(LookupError):
    """A worker does not have the scene and cannot reach its file."""


@dataclass(frozen=True)
class _Travelling:
    """A scene on its way to the workers: where it may be, and how they recognise it."""

    key: str
    path: str
    #: The scene itself where there is no file, or a worker cannot reach it.
    content: bytes | None = None


@dataclass(frozen=True)
class _Piece:
    """What one task computes: a part of one picture."""

    frame: int
    choices: dict[str, Any]
    names: tuple[str, ...]
    camera: Any
    light: Any


def _world(scene: _Travelling) -> _dotray.World:
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
            found: Scene = pickle.loads(content)
            world = found._built()
            while len(_worlds) >= _MOST_WORLDS:
                _worlds.pop(next(iter(_worlds)))
            _worlds[scene.key] = world
        return world


def _compute(scene: _Travelling | bytes, piece: _Piece) -> tuple[NDArray[np.float32], dict[str, Any]]:
    """The task: pixels and layers of a piece."""
    if isinstance(scene, bytes):
        scene = _Travelling(hashlib.sha256(scene).hexdigest(), "", scene)
    world = _world(scene)
    pixels, _ = world.render(piece.choices, piece.camera, piece.light, None)
    layers = {}
    if piece.names:
        layers = world.layers(piece.choices, list(piece.names), piece.camera, piece.light, None)
    return pixels, layers


def _same(content: bytes) -> bytes:
    """Dask's task that holds the scene: should the worker that has it be lost, another gets it anew."""
    return content


class _Engine:
    """An executor, and how the scene reaches its workers."""

    def __init__(self, executor: Executor | Callable[[], Executor], content: bytes, folder: str | None) -> None:
        self.make: Callable[[], Executor] | None = None
        self.executor: Any = executor
        if not hasattr(executor, "submit"):
            self.make = executor
            self.executor = executor()
        self.key = hashlib.sha256(content).hexdigest()
        self.content = content
        self.file: Path | None = None
        self.client = _dask_client(self.executor)
        if self.client is not None:
            if self.client is self.executor:
                self.executor = self.client.get_executor(pure=False, retries=3)
            with warnings.catch_warnings():
                # The scene is one large argument on purpose.
                warnings.filterwarnings("ignore", message="Sending large graph", category=UserWarning)
                self.scene: Any = self.client.submit(_same, content, pure=False, retries=100)
            # To every worker now: one that has to ask for it later might ask a worker that is lost.
            self.client.replicate([self.scene])
        else:
            handle, name = tempfile.mkstemp(prefix=f"dotray-{self.key[:12]}-", suffix=".scene", dir=folder)
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            self.file = Path(name)
            self.scene = _Travelling(self.key, name)

    def submit(self, piece: _Piece, with_scene: bool, twin: bool) -> Future[Any]:
        scene = self.scene
        if with_scene and self.client is None:
            scene = _Travelling(self.key, "", self.content)
        elif twin and not with_scene and self.client is not None:
            # By now the others have the scene. Dask might ask the worker that answers no more for its copy.
            scene = _Travelling(self.key, "")
        future: Future[Any] = self.executor.submit(_compute, scene, piece)
        return future

    def renew(self) -> bool:
        """Another executor in place of one that is broken; false where nobody said how to make one."""
        if self.make is None:
            return False
        self.executor = self.make()
        return True

    def close(self) -> None:
        if self.file is not None:
            self.file.unlink(missing_ok=True)
        if self.make is not None:
            self.executor.shutdown(wait=False, cancel_futures=True)


def _dask_client(executor: Any) -> Any:
    """The client of Dask's executor, or the client itself; ``None`` for other engines."""
    if not type(executor).__module__.startswith("distributed"):
        return None
    return executor if hasattr(executor, "get_executor") else executor._client


class _Task:
    """A piece under way."""

    def __init__(self, piece: _Piece, retries: int) -> None:
        self.piece = piece
        self.left = retries
        self.futures: set[Future[Any]] = set()
        self.started = time.monotonic()
        self.with_scene = False


def _gather(
    engine: _Engine, pieces: Sequence[_Piece], retries: int, patience: float
) -> Iterator[tuple[_Piece, NDArray[np.float32], dict[str, Any]]]:
    """Computes all pieces and gives each as it comes, in any order, once."""
    tasks = [_Task(piece, retries) for piece in pieces]
    owners: dict[Future[Any], _Task] = {}

    def submit(task: _Task, twin: bool = False) -> None:
        try:
            future = engine.submit(task.piece, task.with_scene, twin)
        except BrokenExecutor as broken:
            if not engine.renew():
                raise LostWork("the executor is broken; give a function that makes one") from broken
            future = engine.submit(task.piece, task.with_scene, twin)
        task.futures.add(future)
        task.started = time.monotonic()
        owners[future] = task

    longest = 0.0
    try:
        for task in tasks:
            submit(task)
        while owners:
            done, _ = wait(owners, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in done:
                if future not in owners:
                    continue
                task = owners.pop(future)
                task.futures.discard(future)
                answer = _answer(future, task)
                if answer is None:
                    if not task.futures:
                        submit(task)
                    continue
                longest = max(longest, time.monotonic() - task.started)
                for twin in task.futures:
                    owners.pop(twin, None)
                    twin.cancel()
                yield (task.piece, *answer)
            # A worker that answers no more, though nobody knows yet that it is lost: others do its work as well.
            late = time.monotonic() - max(patience, 2.0 * longest)
            if not done:
                for task in {id(task): task for task in owners.values()}.values():
                    if task.started < late and len(task.futures) <= retries:
                        submit(task, twin=True)
    finally:
        for future in owners:
            future.cancel()


def _answer(future: Future[Any], task: _Task) -> tuple[NDArray[np.float32], dict[str, Any]] | None:
    """What a task gave; ``None`` where it is to be done again."""
    try:
        found: tuple[NDArray[np.float32], dict[str, Any]] = future.result()
        return found
    except (ValueError, TypeError):
        # The scene or the options are at fault, whoever computes.
        raise
    except SceneMissing:
        task.with_scene = True
        return None
    except (Exception, CancelledError) as fault:
        task.left -= 1
        if task.left < 0:
            raise LostWork(f"a piece of frame {task.piece.frame} was lost too often: {fault}") from fault
        return None


def _crops(choices: dict[str, Any], size: int) -> list[tuple[int, int, int, int]]:
    """The parts of a picture, counted from its upper left corner, of about ``size`` × ``size`` pixels."""
    x, y, width, height = choices["crop"] or (0, 0, choices["width"], choices["height"])
    edges = [_edges(x, width, size), _edges(y, height, size)]
    return [(a, c, b - a, d - c) for c, d in edges[1] for a, b in edges[0]]


def _edges(start: int, length: int, size: int) -> list[tuple[int, int]]:
    inner = range(start // size * size + size, start + length, size)
    marks = [start, *inner, start + length]
    return list(zip(marks, marks[1:]))


def _stored(key: str, piece: _Piece, folder: Path | None) -> Path | None:
    """The file that a piece goes to: its name says what it is of."""
    if folder is None:
        return None
    choices = sorted((name, value) for name, value in piece.choices.items() if name != "threads")
    told = (key, choices, piece.names, piece.camera)
    lights = [] if piece.light is None else [piece.light[0], piece.light[1], *map(repr, piece.light[2])]
    name = hashlib.sha256(repr((told, lights)).encode()).hexdigest()
    return folder / f"{name[:32]}.piece"


def _read(path: Path | None) -> tuple[NDArray[np.float32], dict[str, Any]] | None:
    if path is None or not path.exists():
        return None
    with np.load(path, allow_pickle=False) as content:
        pixels: NDArray[np.float32] = content["pixels"]
        channels = {name.split("/")[1]: content[name] for name in content.files if "/" in name}
        return pixels, {name: (array, content[f"channels:{name}"].tolist()) for name, array in channels.items()}


def _write(path: Path | None, pixels: NDArray[np.float32], layers: dict[str, Any]) -> None:
    if path is None:
        return
    content = io.BytesIO()
    arrays: dict[str, Any] = {f"layer/{name}": array for name, (array, _) in layers.items()}
    arrays |= {f"channels:{name}": np.array(channels) for name, (_, channels) in layers.items()}
    np.savez(content, pixels=pixels, **arrays)
    _dotray.write_file(path, content.getvalue())


class _Film:
    """A picture that comes in pieces."""

    def __init__(self, choices: dict[str, Any]) -> None:
        crop: tuple[int, int, int, int] = choices["crop"] or (0, 0, choices["width"], choices["height"])
        self.left, self.top, width, height = crop
        self.pixels = np.zeros((height, width, 4 if choices["transparent"] else 3), np.float32)
        self.layers: dict[str, tuple[NDArray[np.float32], list[str]]] = {}

    def put(self, piece: _Piece, pixels: NDArray[np.float32], layers: dict[str, Any]) -> int:
        x, y, width, height = piece.choices["crop"]
        rows, columns = slice(y - self.top, y - self.top + height), slice(x - self.left, x - self.left + width)
        self.pixels[rows, columns] = pixels
        for name, (array, channels) in layers.items():
            if name not in self.layers:
                shape = (*self.pixels.shape[:2], array.shape[2])
                self.layers[name] = (np.zeros(shape, np.float32), channels)
            self.layers[name][0][rows, columns] = array
        return int(width * height)

    def image(self) -> Image:
        image = Image(self.pixels)
        add_layers(image, self.layers)
        return image


def render(
    scene: Scene,
    width: int = 640,
    height: int = 480,
    *,
    executor: Executor | Callable[[], Executor],
    directory: str | os.PathLike[str] | None = None,
    piece: int = 128,
    retries: int = 3,
    patience: float = 30.0,
    progress: Progress = None,
    layers: Iterable[str] = (),
    **options: Any,
) -> Image:
    """Makes one picture on the workers of ``executor``: the same bytes as :meth:`dotray.Scene.render`.

    Parameters
    ----------
    scene, width, height, layers, options : as for :meth:`dotray.Scene.render`.
    executor : an executor; Dask's ``Client`` or ``Client.get_executor(pure=False, retries=3)``; or a function that
        makes an executor, for those that break when a worker is killed (``ProcessPoolExecutor``).
    directory : a folder where pieces go as they come. Who starts again with the same scene and options finds them
        there: what was computed is not computed again. Workers that share no ``/tmp`` with this process also read
        the scene there; without it, it is sent to those that cannot.
    piece : the edge of a piece in pixels, a multiple of 32.
    retries : how often a piece may be lost before :class:`LostWork` is raised.
    patience : seconds (and twice the longest piece so far) after which a piece that does not come is given to
        another worker as well.

    Raises
    ------
    LostWork
        For a piece that was lost too often, or an executor that is broken.
    ValueError, SceneError
        As :meth:`dotray.Scene.render`.

    >>> from concurrent.futures import ThreadPoolExecutor
    >>> scene = Scene()
    >>> geometry = scene.add_spheres([0, 0, 0], 1)
    >>> with ThreadPoolExecutor(2) as executor:
    ...     render(scene, 64, 48, executor=executor, piece=32).numpy().shape
    (48, 64, 3)
    """
    choices = settings(width, height, **options)
    found = list(
        _films(
            scene, [(scene._view(width, height))], choices, tuple(layers), executor, directory, piece, retries,
            patience, progress,
        )
    )  # fmt: skip
    return found[0][1]


def _render(scene: Scene, choices: dict[str, Any], names: list[str], executor: Executor, progress: Progress) -> Image:
    view = scene._view(choices["width"], choices["height"])
    found = list(_films(scene, [view], choices, tuple(names), executor, None, 128, 3, 30.0, progress))
    return found[0][1]


def frames(
    scene: Scene,
    cameras: Iterable[Camera],
    path: str,
    width: int = 640,
    height: int = 480,
    *,
    executor: Executor | Callable[[], Executor],
    directory: str | os.PathLike[str] | None = None,
    piece: int | None = None,
    retries: int = 3,
    patience: float = 30.0,
    srgb: bool = False,
    resume: bool = True,
    progress: Progress = None,
    **options: Any,
) -> list[Path]:
    """Makes a picture for each camera on the workers of ``executor``; each goes to its file when it is finished.

    Parameters
    ----------
    cameras : one a frame.
    path : where frames go, such as ``"film/{:04d}.png"``; the frame's number is put in, and the folder made.
    piece : the edge of a piece in pixels; by default a frame is one piece.
    resume : whether frames whose files are there are left as they are.
    scene, width, height, executor, directory, retries, patience, options : as for :func:`render`.

    Returns the frames' paths, in order; raises as :func:`render`, and OSError where a file cannot be written.

    >>> import tempfile
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> scene = Scene()
    >>> geometry = scene.add_spheres([0, 0, 0], 1)
    >>> cameras = [Camera.look_at((x, 0, 5), (0, 0, 0)) for x in (-1, 1)]
    >>> with ThreadPoolExecutor(2) as executor:
    ...     files = frames(scene, cameras, tempfile.mkdtemp() + "/{:02d}.png", 32, 24, executor=executor)
    >>> [file.name for file in files]
    ['00.png', '01.png']
    """
    choices = settings(width, height, **options)
    paths, views, numbers = [], [], []
    kept = scene.camera
    try:
        for number_, camera in enumerate(cameras):
            paths.append(Path(path.format(number_)))
            if resume and paths[-1].exists():
                continue
            scene.camera = camera
            views.append(scene._view(width, height))
            numbers.append(number_)
    finally:
        scene.camera = kept
    for folder in {path_.parent for path_ in paths}:
        folder.mkdir(parents=True, exist_ok=True)
    if len(set(paths)) < len(paths):
        raise ValueError(f"path is {path!r}: expected a place for the frame's number, such as 'film/{{:04d}}.png'")
    size = max(width, height) + _TILE - 1 if piece is None else piece
    size -= size % _TILE
    found = _films(scene, views, choices, (), executor, directory, max(size, _TILE), retries, patience, progress)
    for index, image in found:
        image.save(paths[numbers[index]], srgb=srgb)
    return paths


def _films(
    scene: Scene,
    views: Sequence[tuple[Any, Any]],
    choices: dict[str, Any],
    names: tuple[str, ...],
    executor: Executor | Callable[[], Executor],
    directory: str | os.PathLike[str] | None,
    piece: int,
    retries: int,
    patience: float,
    progress: Progress,
) -> Iterator[tuple[int, Image]]:
    """The pictures of all views, each when its last piece has come."""
    size = whole(piece, "piece", _TILE, 1 << 20)
    if size % _TILE:
        raise ValueError(f"piece is {size}: expected a multiple of {_TILE}")
    whole(retries, "retries", 0, 1000)
    number(patience, "patience", 0.0)
    folder = None if directory is None else Path(directory)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    if not views:
        return
    content = pickle.dumps(scene, protocol=5)
    key = hashlib.sha256(content).hexdigest()
    crops = _crops(choices, size)
    # A film is there from its first piece to its last, lest a long one fill memory.
    films: dict[int, _Film] = {}
    missing = [len(crops)] * len(views)

    def put(part: _Piece, pixels: NDArray[np.float32], layers: dict[str, Any]) -> int:
        missing[part.frame] -= 1
        return films.setdefault(part.frame, _Film(choices)).put(part, pixels, layers)

    finished, total = 0, len(views) * sum(width * height for _, _, width, height in crops)
    wanted = []
    for frame, (camera, light) in enumerate(views):
        for crop in crops:
            part = _Piece(frame, {**choices, "crop": crop}, names, camera, light)
            stored = _read(_stored(key, part, folder))
            if stored is None:
                wanted.append(part)
            else:
                finished += put(part, *stored)
        if not missing[frame]:
            yield frame, films.pop(frame).image()
    if not wanted:
        return
    engine = _Engine(executor, content, None if folder is None else str(folder))
    try:
        with Bar(progress) as bar:
            for part, pixels, layers in _gather(engine, wanted, retries, patience):
                _write(_stored(key, part, folder), pixels, layers)
                finished += put(part, pixels, layers)
                if bar.function is not None:
                    bar.function(finished, total)
                if not missing[part.frame]:
                    yield part.frame, films.pop(part.frame).image()
    finally:
        engine.close()
