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

A picture is cut into pieces, as ``dotray plan`` does it, each a function of scene, options and place alone: whoever
computes one, and however often, the bytes are those of one machine, and a checksum tells when they are not. The scene
travels to each worker once; pieces come back in any order and go to disk as they come; what is lost with a worker is
computed again by another.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from pathlib import Path
from typing import Any

from dotray import _dotray
from dotray._engines import Engine, RayExecutor
from dotray._image import Image
from dotray._look import Camera
from dotray._options import settings
from dotray._pieces import Piece, SceneMissing, Shot, Whole, folder_of, keep, shots
from dotray._progress import Bar, Progress
from dotray._scene import Scene
from dotray._values import number, whole

__all__ = ["LostWork", "RayExecutor", "frames", "render"]

#: The edge of the renderer's tiles, in whole numbers of which pieces are cut.
_TILE = 32


class LostWork(RuntimeError):
    """A piece was computed in vain too often; ``__cause__`` is what went wrong last."""


class _Task:
    """A piece under way."""

    def __init__(self, piece: Piece, retries: int) -> None:
        self.piece = piece
        self.left = retries
        self.futures: set[Future[Any]] = set()
        self.started = time.monotonic()
        self.with_scene = False


def _gather(
    engine: Engine, pieces: Sequence[Piece], take: Callable[[Piece, bytes], bool], retries: int, patience: float
) -> Iterator[tuple[Piece, bytes]]:
    """Computes all pieces and gives each as it comes, in any order, once ``take`` has found it whole."""
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
                if answer is not None and not take(task.piece, answer):
                    _lost(task, ValueError("it came back damaged"))
                    answer = None
                if answer is None:
                    if not task.futures:
                        submit(task)
                    continue
                longest = max(longest, time.monotonic() - task.started)
                for twin in task.futures:
                    owners.pop(twin, None)
                    twin.cancel()
                yield task.piece, answer
            # A worker that answers no more, though nobody knows yet that it is lost: others do its work as well.
            late = time.monotonic() - max(patience, 2.0 * longest)
            if not done:
                engine.free()
                for task in {id(task): task for task in owners.values()}.values():
                    if task.started < late and len(task.futures) <= retries:
                        submit(task, twin=True)
    finally:
        for future in owners:
            future.cancel()


def _answer(future: Future[Any], task: _Task) -> bytes | None:
    """What a task gave; ``None`` where it is to be done again."""
    try:
        found: bytes = future.result()
        return found
    except (ValueError, TypeError):
        # The scene or the options are at fault, whoever computes.
        raise
    except SceneMissing:
        task.with_scene = True
        return None
    except (Exception, CancelledError) as fault:
        _lost(task, fault)
        return None


def _lost(task: _Task, fault: BaseException) -> None:
    """A piece is lost once more."""
    task.left -= 1
    if task.left < 0:
        raise LostWork(f"a piece of frame {task.piece.shot.frame} was lost too often: {fault}") from fault


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
    progress : the same; a function gets the records ``progress``, whose pixels are those of all pieces.
    executor : an executor; Dask's ``Client`` or ``Client.get_executor(pure=False, retries=3)``; or a function that
        makes an executor, for those that break when a worker is killed (``ProcessPoolExecutor``).
    directory : a folder where pieces go as they come. Who starts again with the same scene and options finds them
        there: what was computed is not computed again. Workers that share no ``/tmp`` with this process also read
        the scene there; without it, it is sent to those that cannot.
    piece : about the edge of a piece in pixels, a multiple of 32: a piece has so many tiles of 32 × 32 pixels.
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
    piece : about the edge of a piece in pixels; by default a frame is one piece.
    resume : whether frames whose files are there are left as they are.
    scene, width, height, executor, directory, retries, patience, progress, options : as for :func:`render`.

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
    if piece is None:
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
    folder = folder_of(directory)
    if not views:
        return
    content = pickle.dumps(scene, protocol=5)
    key = hashlib.sha256(content).hexdigest()
    # A film is there from its first piece to its last, lest a long one fill memory.
    films: dict[int, Whole] = {}
    left: dict[int, int] = {}
    wanted: list[Piece] = []
    finished = total = 0
    for shot in shots(views, choices, names):
        film = Whole(shot, shot.name(key))
        parts = film.plan(size)
        missing = [part for part in parts if not film.find(part, folder)]
        finished, total = finished + film.progress[0], total + film.progress[1]
        if not missing:
            yield shot.frame, film.image()
            continue
        wanted += missing
        left[shot.frame] = len(missing)
        if len(missing) < len(parts):
            films[shot.frame] = film

    def take(part: Piece, content: bytes) -> bool:
        if part.shot.frame not in films:
            films[part.shot.frame] = Whole(part.shot, part.picture)
        return films[part.shot.frame].put(part, content)

    if not wanted:
        return
    engine = Engine(executor, content, None if folder is None else str(folder))
    try:
        meter = _dotray.Meter()
        # Pieces that were there are no pace.
        meter.advance(finished, total)
        with Bar(progress) as bar:
            for part, computed in _gather(engine, wanted, take, retries, patience):
                keep(part, computed, folder)
                frame = part.shot.frame
                left[frame] -= 1
                finished += part.pixels
                if bar.function is not None:
                    bar.function(meter.advance(finished, total))
                if not left[frame]:
                    yield frame, films.pop(frame).image()
    finally:
        engine.close()
