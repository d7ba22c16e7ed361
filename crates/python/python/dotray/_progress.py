"""How far a picture has come: tqdm's bar where it is installed, else one of our own."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, TypeAlias

#: ``None`` shows a bar where somebody looks, ``True`` always, ``False`` never; a function is called with the finished
#: and all pixels.
Progress: TypeAlias = bool | Callable[[int, int], object] | None

_PATIENCE = 0.5


def _somebody_looks() -> bool:
    if "ipykernel" in sys.modules:
        return True
    try:
        return sys.stderr.isatty()
    except (AttributeError, ValueError):
        return False


class _OwnBar:
    """A line on standard error: ``dotray:  43 % [#########           ]``."""

    def __init__(self, unit: str) -> None:
        self.unit = unit

    def show(self, finished: int, total: int) -> None:
        share = finished / total if total else 1.0
        bar = "#" * int(30 * share)
        sys.stderr.write(f"\rdotray: {100 * share:3.0f} % [{bar:<30}] {finished}/{total} {self.unit}")
        sys.stderr.flush()

    def close(self) -> None:
        sys.stderr.write("\n")


class _Tqdm:
    def __init__(self, unit: str) -> None:
        from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]

        self.bar: Any = tqdm(unit=unit, unit_scale=True, desc="dotray", leave=False)

    def show(self, finished: int, total: int) -> None:
        self.bar.total = total
        self.bar.update(finished - self.bar.n)

    def close(self) -> None:
        self.bar.close()


class Bar:
    """A bar that comes after half a second and goes at the end; its ``function`` is what the renderer calls."""

    def __init__(self, progress: Progress, unit: str = "px") -> None:
        self.unit = unit
        self.bar: _OwnBar | _Tqdm | None = None
        self.start = time.monotonic()
        self.function: Callable[[int, int], object] | None = None
        if callable(progress):
            self.function = progress
        elif progress or (progress is None and _somebody_looks()):
            self.function = self._show
        self.patience = 0.0 if progress else _PATIENCE

    def _show(self, finished: int, total: int) -> None:
        if self.bar is None:
            if time.monotonic() - self.start < self.patience:
                return
            try:
                self.bar = _Tqdm(self.unit)
            except ImportError:
                self.bar = _OwnBar(self.unit)
        self.bar.show(finished, total)

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.bar is not None:
            self.bar.close()
