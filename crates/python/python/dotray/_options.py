"""The options of a picture by the names that the compiled half has."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dotray._values import number, pair, whole

__all__ = ["settings"]


def settings(
    width: int,
    height: int,
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
    threads: int | None = None,
) -> dict[str, Any]:
    """The options of a picture by the names that the compiled half has; whatever is no number is refused."""
    most = 1 << 20
    how = aa if isinstance(aa, str) else "grid"
    return {
        "width": whole(width, "width", 1, most),
        "height": whole(height, "height", 1, most),
        "crop": None if crop is None else pair(crop, "crop", 4),
        "recursion": whole(recursion, "recursion", 0, 1000),
        "cutoff": number(cutoff, "cutoff"),
        "aa": how,
        "aa_grid": 1 if isinstance(aa, str) else whole(aa, "aa", 1, 64),
        "aa_threshold": number(aa_threshold, "aa_threshold", 0.0),
        "aa_depth": whole(aa_depth, "aa_depth", 0, 10),
        "shadows": shadows,
        "texture_filter": texture_filter,
        "light_samples": whole(light_samples, "light_samples", 1, 1 << 16),
        "transparent": bool(transparent),
        "threads": None if threads is None else whole(threads, "threads", 1, 1024),
    }
