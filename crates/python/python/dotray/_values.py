"""Arguments checked: every fault is a ValueError that names the argument, the index and the value."""

from __future__ import annotations

import math
import operator
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dotray import _dotray

Floats: TypeAlias = NDArray[np.float32] | NDArray[np.float64]
Vector: TypeAlias = tuple[float, float, float]

#: The sixteen basic colours of HTML, and some more that plots use.
COLORS = {
    "black": (0.0, 0.0, 0.0), "silver": (0.75, 0.75, 0.75), "gray": (0.5, 0.5, 0.5), "white": (1.0, 1.0, 1.0),
    "maroon": (0.5, 0.0, 0.0), "red": (1.0, 0.0, 0.0), "purple": (0.5, 0.0, 0.5), "fuchsia": (1.0, 0.0, 1.0),
    "green": (0.0, 0.5, 0.0), "lime": (0.0, 1.0, 0.0), "olive": (0.5, 0.5, 0.0), "yellow": (1.0, 1.0, 0.0),
    "navy": (0.0, 0.0, 0.5), "blue": (0.0, 0.0, 1.0), "teal": (0.0, 0.5, 0.5), "aqua": (0.0, 1.0, 1.0),
    "orange": (1.0, 0.65, 0.0), "gold": (1.0, 0.84, 0.0), "pink": (1.0, 0.75, 0.8), "brown": (0.65, 0.16, 0.16),
}  # fmt: skip


def floats(value: ArrayLike, name: str) -> Floats:
    """The value as an array of single or double precision; no copy where it is one already."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name} is no array of numbers: {error}") from None
    if array.dtype in (np.float32, np.float64) and array.dtype.isnative:
        return array
    if array.dtype.kind not in "iufb":
        raise ValueError(f"{name} has dtype {array.dtype}: expected real numbers")
    return array.astype(np.float64)


def index_text(array: NDArray[Any], place: int) -> str:
    """The index of an element that stands at a place in row order, as one would type it."""
    return ", ".join(str(int(i)) for i in np.unravel_index(place, array.shape))


def two_dimensional(array: NDArray[Any]) -> NDArray[Any]:
    return array.reshape(array.shape[0] if array.ndim else 1, -1) if array.ndim != 2 else array


def check_finite(array: Floats, name: str) -> None:
    place = _dotray.first_not_finite(two_dimensional(array))
    if place is not None:
        where = f"[{index_text(array, place)}]" if array.ndim else ""
        raise ValueError(f"{name}{where} is {array.flat[place]}: expected a finite number")


def check_positive(array: Floats, name: str, what: str = "above 0") -> None:
    place = _dotray.first_not_positive(two_dimensional(array))
    if place is not None:
        where = f"[{index_text(array, place)}]" if array.ndim else ""
        raise ValueError(f"{name}{where} is {array.flat[place]}: expected a number {what}")


def rows(value: ArrayLike, name: str, columns: int) -> Floats:
    """(N, columns) finite numbers; (columns,) stands for one row."""
    array = floats(value, name)
    if array.ndim == 1 and array.shape == (columns,):
        array = array[np.newaxis, :]
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} has shape {array.shape}: expected (N, {columns})")
    check_finite(array, name)
    return array


def lengths(value: ArrayLike, name: str) -> Floats:
    """(N,) numbers above 0; a single one stands for all."""
    array = floats(value, name)
    if array.ndim == 2 and array.shape[1] == 1:
        array = array[:, 0]
    if array.ndim > 1:
        raise ValueError(f"{name} has shape {array.shape}: expected one number or (N,)")
    check_positive(array, name)
    return array.reshape(1) if array.ndim == 0 else array


def broadcast(arrays: dict[str, Floats], extra: dict[str, int] | None = None) -> tuple[int, dict[str, Any]]:
    """All arrays with as many rows as the longest, as numpy broadcasts them: nothing is copied."""
    counts = {name: len(array) for name, array in arrays.items()} | (extra or {})
    count = max(counts.values()) if 0 not in counts.values() else 0
    for name, found in counts.items():
        if found not in (1, count):
            others = ", ".join(f"{other} has {rows}" for other, rows in counts.items() if other != name)
            raise ValueError(f"{name} has {found} rows, {others}: they cannot be broadcast together")
    return count, {name: np.broadcast_to(array, (count, *array.shape[1:])) for name, array in arrays.items()}


def vector(value: ArrayLike, name: str) -> Vector:
    """Three finite numbers."""
    array = floats(value, name)
    if array.shape != (3,):
        raise ValueError(f"{name} has shape {array.shape}: expected 3 numbers")
    check_finite(array, name)
    return (float(array[0]), float(array[1]), float(array[2]))


def direction(value: ArrayLike, name: str) -> Vector:
    """Three finite numbers that are not all 0."""
    found = vector(value, name)
    if found == (0.0, 0.0, 0.0):
        raise ValueError(f"{name} is (0, 0, 0): expected a direction of any length but 0")
    return found


def number(value: float, name: str, least: float = -math.inf, most: float = math.inf, open_: bool = False) -> float:
    """A finite number within bounds."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}: expected a number") from None
    inside = least < found < most if open_ else least <= found <= most
    if not (math.isfinite(found) and inside):
        bounds = "a finite number" if least == -math.inf and most == math.inf else f"{least:g} to {most:g}"
        raise ValueError(f"{name} is {value!r}: expected {bounds}")
    return found


def whole(value: int, name: str, least: int, most: int) -> int:
    """A whole number within bounds."""
    try:
        found = operator.index(value)
    except TypeError:
        raise ValueError(f"{name} is {value!r}: expected a whole number") from None
    if not least <= found <= most:
        raise ValueError(f"{name} is {found}: expected {least} to {most}")
    return found


def color(value: ArrayLike | str, name: str) -> Vector:
    """A colour: three numbers (whole numbers of 8 bits count as n/255), ``'#rrggbb'`` or a name."""
    if isinstance(value, str):
        text = value.strip().lower()
        if text in COLORS:
            return COLORS[text]
        if len(text) == 7 and text[0] == "#":
            try:
                red, green, blue = (int(text[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
                return (red, green, blue)
            except ValueError:
                pass
        raise ValueError(f"{name} is {value!r}: expected '#rrggbb', three numbers, or one of {', '.join(COLORS)}")
    array = np.asarray(value)
    if array.dtype == np.uint8:
        value = array / 255.0
    return vector(value, name)


def colors(value: ArrayLike | str, name: str) -> NDArray[np.float32] | Vector:
    """One colour, or (N, 3) of them in single precision."""
    if isinstance(value, str):
        return color(value, name)
    array = np.asarray(value)
    if array.ndim == 1:
        return color(array, name)
    if array.ndim == 2 and array.shape[1] == 4:
        raise ValueError(f"{name} has shape {array.shape}: expected (N, 3); leave alpha out by {name}[:, :3]")
    table = rows(array / np.float32(255.0) if array.dtype == np.uint8 else array, name, 3)
    with np.errstate(over="ignore"):
        single = table.astype(np.float32, copy=False)
    check_finite(single, name)
    return single


def matrix(value: ArrayLike, name: str) -> list[float]:
    """A 4 × 4 matrix that can be inverted, its last row 0 0 0 1; its numbers row by row."""
    array = floats(value, name)
    if array.shape != (4, 4):
        raise ValueError(f"{name} has shape {array.shape}: expected (4, 4)")
    check_finite(array, name)
    if array[3].tolist() != [0.0, 0.0, 0.0, 1.0]:
        raise ValueError(f"{name}[3] is {array[3].tolist()}: expected the last row 0 0 0 1 (points are columns)")
    numbers: list[float] = array.astype(np.float64).ravel().tolist()
    if _dotray.is_singular(numbers):
        raise ValueError(f"{name} is singular: it flattens everything in the group")
    return numbers


def pair(value: Sequence[int], name: str, count: int) -> tuple[int, ...]:
    """So many whole numbers of 0 or more."""
    found = tuple(whole(part, f"{name}[{i}]", 0, 1 << 31) for i, part in enumerate(value))
    if len(found) != count:
        raise ValueError(f"{name} has {len(found)} numbers: expected {count}")
    return found
