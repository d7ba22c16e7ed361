"""How far pictures have come: records, and tqdm's bar where it is installed, else one of our own.

A record is a dictionary with the keys that docs/progress.md describes. Functions that are given as ``progress=`` get the
same records that ``dotray render --progress json`` writes as lines, and :func:`follow` reads those lines.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from types import TracebackType
from typing import Any, TypeAlias

from dotray import _dotray

#: What happened: ``record["event"]`` says which keys there are (docs/progress.md). Ignore keys and events that you do not
#: know: newer versions may have more.
Record: TypeAlias = dict[str, Any]

#: ``None`` shows a bar where somebody looks, ``True`` always, ``False`` never; a function is called with records.
Progress: TypeAlias = bool | Callable[[Record], object] | None

_PATIENCE = 0.5


def _somebody_looks() -> bool:
    if "ipykernel" in sys.modules:
        return True
    try:
        return sys.stderr.isatty()
    except (AttributeError, ValueError):
        return False


class _OwnBar:
    """A line on standard error: ``dotray:  43 % [#########           ] 43/100 px, 12 s left``."""

    def __init__(self, unit: str) -> None:
        self.unit = unit
        self.length = 0

    def show(self, what: str, finished: int, total: int, left: float | None) -> None:
        share = finished / total if total else 1.0
        bar = "#" * int(30 * share)
        text = f"{what}: {100 * share:3.0f} % [{bar:<30}] {finished}/{total} {self.unit}"
        if left is not None:
            text += f", {left:.0f} s left"
        # Blanks cover what a longer line has left.
        sys.stderr.write(f"\r{text:<{self.length}}")
        sys.stderr.flush()
        self.length = len(text)

    def write(self, line: str) -> None:
        sys.stderr.write(f"\r{line:<{self.length}}\n")

    def close(self) -> None:
        sys.stderr.write("\n")


class _Tqdm:
    def __init__(self, unit: str) -> None:
        from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]

        self.tqdm: Any = tqdm
        self.unit = unit
        self.bar: Any = None

    def show(self, what: str, finished: int, total: int, left: float | None) -> None:
        if self.bar is None:
            self.bar = self.tqdm(total=total, unit=self.unit, unit_scale=True, desc=what, leave=False)
        elif self.bar.total != total or finished < self.bar.n:
            self.bar.reset(total)
        if self.bar.desc != f"{what}: ":
            self.bar.set_description(what, refresh=False)
        self.bar.update(finished - self.bar.n)
        # tqdm draws every now and then; the end is always seen.
        if finished == total:
            self.bar.refresh()

    def write(self, line: str) -> None:
        self.tqdm.write(line, file=sys.stderr)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()


class Bar:
    """A bar that comes after half a second and goes at the end; its ``function`` is what takes records."""

    def __init__(self, progress: Progress, unit: str = "px") -> None:
        self.unit = unit
        self.bar: _OwnBar | _Tqdm | None = None
        self.what = "dotray"
        self.start = time.monotonic()
        self.function: Callable[[Record], object] | None = None
        if callable(progress):
            self.function = progress
        elif progress or (progress is None and _somebody_looks()):
            self.function = self._take
        self.patience = 0.0 if progress else _PATIENCE

    def _take(self, record: Record) -> None:
        event = record.get("event")
        if event == "frame":
            self.what = f"dotray, frame {record['frame']}"
        elif event == "progress":
            self._show(record["finished_pixels"], record["total_pixels"], record["seconds_left"])

    def _show(self, finished: int, total: int, left: float | None) -> None:
        if self.bar is None:
            if time.monotonic() - self.start < self.patience:
                return
            try:
                self.bar = _Tqdm(self.unit)
            except ImportError:
                self.bar = _OwnBar(self.unit)
        self.bar.show(self.what, finished, total, left)

    def write(self, line: str) -> None:
        """A line of text, above the bar."""
        if self.bar is None:
            print(line, file=sys.stderr)
        else:
            self.bar.write(line)

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.bar is not None:
            self.bar.close()


def _lines(source: Any) -> Iterator[str]:
    """The lines of a process's standard error, or of anything that has lines."""
    stream = source
    if isinstance(source, subprocess.Popen):
        stream = source.stderr
        if stream is None:
            raise ValueError("source is a process whose standard error goes elsewhere: start it with stderr=PIPE")
    elif isinstance(source, (str, bytes)):
        raise ValueError(f"source is {source!r}; expected a process, a file or lines")
    for line in stream:
        yield (line.decode(errors="replace") if isinstance(line, (bytes, bytearray)) else str(line)).rstrip("\r\n")


def _record(line: str) -> Record | None:
    """The record of a line; ``None`` for lines that are none."""
    if not line.startswith("{"):
        return None
    try:
        found = json.loads(line)
    except ValueError:
        return None
    # Messages are objects, too, where the program runs with --log-format json; they have no event.
    return found if isinstance(found, dict) and isinstance(found.get("event"), str) else None


def follow(
    source: subprocess.Popen[Any] | Iterable[str] | Iterable[bytes], progress: Progress = None
) -> Record:
    """Watches a ``dotray render``, ``animate`` or ``work`` that runs with ``--progress json``, until its end.

    Parameters
    ----------
    source : the process (``subprocess.Popen`` with ``stderr=PIPE``), an open file, or any lines; text or bytes.
    progress : as for :meth:`dotray.Scene.render`: a bar, or a function that is called with each record.

    Returns the last record, whose ``outcome`` is ``"done"`` where all went well and whose ``exit`` is the exit code. Lines
    that are no records, such as warnings, go to standard error.

    Raises
    ------
    EOFError
        Where the lines end before the work has told its end: the program was killed, or runs without
        ``--progress json``.
    ValueError
        For a source that has no lines, and for records of a schema that this version does not know.

    >>> lines = [
    ...     '{"event": "start", "seconds": 0, "schema": 1, "version": "0.1.0", "command": "render", "scene": "a.ray"}',
    ...     '{"event": "progress", "seconds": 1, "finished_pixels": 9, "total_pixels": 9, "seconds_left": 0}',
    ...     '{"event": "end", "seconds": 1.5, "outcome": "done", "exit": 0}',
    ... ]
    >>> follow(lines, progress=lambda record: print(record["event"]))["outcome"]
    start
    progress
    end
    'done'
    """
    last: Record | None = None
    with Bar(progress) as bar:
        for line in _lines(source):
            record = _record(line)
            if record is None:
                bar.write(line)
                continue
            schema = record.get("schema", _dotray.PROGRESS_SCHEMA)
            if schema != _dotray.PROGRESS_SCHEMA:
                raise ValueError(
                    f"the records are of schema {schema}; this version of dotray reads {_dotray.PROGRESS_SCHEMA}: "
                    "use the program and the package of one version"
                )
            if bar.function is not None:
                bar.function(record)
            if record["event"] == "end":
                last = record
    code = source.wait() if isinstance(source, subprocess.Popen) else None
    if last is None:
        told = "" if code is None else f" (exit code {code})"
        raise EOFError(f"the lines end before the work has told its end{told}: was it killed, or started without "
                       "`--progress json`?")  # fmt: skip
    return last
