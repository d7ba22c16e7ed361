"""Executors, and how a scene reaches their workers."""

from __future__ import annotations

import hashlib
import os
import tempfile
import warnings
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from dotray._pieces import Piece, Travelling, compute

__all__ = ["Engine", "RayExecutor"]


class RayExecutor(Executor):
    """Ray's tasks as an executor, which Ray itself does not have.

    Parameters
    ----------
    num_cpus : the cores that a task asks for; dotray uses as many threads as ``threads=`` says, all by default.
    max_retries : how often Ray itself starts a task again whose worker has died.

    Raises RuntimeError where Ray is not connected: call ``ray.init(address="auto")`` before. It ends nothing of Ray.

    >>> RayExecutor()  # doctest: +SKIP
    <dotray._engines.RayExecutor object at …>
    """

    def __init__(self, num_cpus: float = 1, max_retries: int = 3) -> None:
        import ray  # type: ignore[import-not-found, unused-ignore]

        if not ray.is_initialized():
            raise RuntimeError("Ray is not connected: call ray.init(address='auto') first")
        self._ray: Any = ray
        self._task: Any = ray.remote(num_cpus=num_cpus, max_retries=max_retries)(_call)

    def submit(self, function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Starts a task; arguments that :meth:`put` gave reach each machine once."""
        reference = self._task.remote(function, kwargs, *args)
        future: Future[Any] = reference.future()
        future.add_done_callback(lambda done: self._ray.cancel(reference) if done.cancelled() else None)
        return future

    def put(self, value: Any) -> Any:
        """A handle for something large that many tasks are given: it travels to each machine once."""
        return self._ray.put(value)


def _call(function: Callable[..., Any], kwargs: dict[str, Any], *args: Any) -> Any:
    return function(*args, **kwargs)


def _same(content: bytes) -> bytes:
    """Dask's task that holds the scene: should the worker that has it be lost, another gets it anew."""
    return content


class Engine:
    """An executor, and how the scene reaches its workers."""

    def __init__(self, executor: Executor | Callable[[], Executor], content: bytes, folder: str | None) -> None:
        self.make: Callable[[], Executor] | None = None
        self.executor: Any = executor
        if not hasattr(executor, "submit"):
            if not callable(executor):
                raise ValueError(f"executor is {executor!r}: expected an executor, or a function that makes one")
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
        elif isinstance(self.executor, RayExecutor):
            self.scene = self.executor.put(content)
        else:
            handle, name = tempfile.mkstemp(prefix=f"dotray-{self.key[:12]}-", suffix=".scene", dir=folder)
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            self.file = Path(name)
            self.scene = Travelling(self.key, name)

    def submit(self, piece: Piece, with_scene: bool, twin: bool) -> Future[Any]:
        scene = self.scene
        if with_scene and self.file is not None:
            scene = Travelling(self.key, "", self.content)
        elif twin and not with_scene and self.client is not None:
            # By now the others have the scene. Dask might ask the worker that answers no more for its copy.
            scene = Travelling(self.key, "")
        future: Future[Any] = self.executor.submit(compute, scene, piece)
        return future

    def renew(self) -> bool:
        """Another executor in place of one that is broken; false where nobody said how to make one."""
        if self.make is None:
            return False
        self.executor = self.make()
        return True

    def free(self) -> None:
        """Has a pool of processes notice that one of them is dead, where half of a result keeps it from noticing.

        A worker that is killed in the midst of sending leaves half a message in the pipe, and Python's pool waits for
        the rest for ever: seen with Python 3.11. Once nobody can write there any more, it finds itself broken.
        """
        processes = list((getattr(self.executor, "_processes", None) or {}).values())
        if not any(process.exitcode for process in processes):
            return
        for process in processes:
            process.kill()
        results = getattr(self.executor, "_result_queue", None)
        if results is not None:
            results._writer.close()

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
