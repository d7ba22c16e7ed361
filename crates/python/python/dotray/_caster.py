"""Rays of one's own against the shapes of a scene."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dotray._scene import Scene
from dotray._values import Floats, check_finite, floats, number, whole

#: Stands for no geometry and no item in the arrays that :class:`RayCaster` gives.
INVALID_ID = 0xFFFFFFFF


class _Geometries:
    def __init__(self, first: NDArray[np.uint32], ids: NDArray[np.uint32]) -> None:
        self.first, self.ids = first, ids


class RayCaster:
    """Answers batches of rays in double precision, by the kernels that pictures are made with.

    Parameters
    ----------
    scene : the scene as it is now; shapes that are added later are not seen.
    threads : how many; all cores by default.

    Rays are (..., 6) arrays: origin, then direction. A ray's t counts lengths of its direction, whatever that is. What
    is met must lie at t_min < t < t_max.

    >>> scene = Scene()
    >>> balls = scene.add_spheres([[0, 0, -5], [0, 0, -9]], 1)
    >>> caster = RayCaster(scene)
    >>> found = caster.cast_rays([[0, 0, 0, 0, 0, -1], [0, 0, 0, 0, 0, 2]])
    >>> found["t_hit"].tolist(), found["primitive_ids"].tolist()
    ([4.0, inf], [0, 4294967295])
    """

    def __init__(self, scene: Scene, *, threads: int | None = None) -> None:
        self._world = scene._built()
        first, ids, self._kept = scene._geometry_table()
        self._geometries = _Geometries(first, ids)
        self._threads = None if threads is None else whole(threads, "threads", 1, 1024)

    def cast_rays(
        self,
        rays: ArrayLike,
        *,
        t_min: float = 0.0,
        t_max: float = math.inf,
        coherent: bool = False,
        surfaces: bool = True,
    ) -> dict[str, NDArray[Any]]:
        """What each ray meets first.

        Parameters
        ----------
        rays : (..., 6).
        t_min, t_max : the part of each ray that counts.
        coherent : says that rays that follow each other start and run alike; they then share work. Answers are the
            same.
        surfaces : whether normals and uvs are wanted.

        Returns
        -------
        dict of arrays, each of the shape of ``rays`` without its last axis:
        ``t_hit`` float64, infinite where nothing is met; ``geometry_ids`` uint32, as the ``add_`` methods gave them;
        ``primitive_ids`` uint32, which sphere, cylinder, cone, box or face of that geometry: :data:`INVALID_ID` where
        nothing is met; ``normals`` (..., 3) float64, outward and of length 1 (0 where nothing is met); ``uvs`` (..., 2)
        float64, where in a texture.

        Raises ValueError for rays of another shape or dtype, numbers that are not finite, directions of length 0.
        """
        table, shape = _rays(rays)
        reach = _reach(t_min, t_max)
        found = self._world.cast_rays(table, self._geometries, *reach, bool(coherent), bool(surfaces), self._threads)
        self._name_items(found)
        if surfaces and "normals" not in found:
            found |= {"normals": np.zeros((0, 3)), "uvs": np.zeros((0, 2))}
        return {name: array.reshape((*shape, *array.shape[1:])) for name, array in found.items()}

    def occluded(
        self, rays: ArrayLike, *, t_min: float = 0.0, t_max: float = math.inf, coherent: bool = False
    ) -> NDArray[np.bool_]:
        """Whether anything lies on each ray: booleans of the shape of ``rays`` without its last axis.

        Parameters and errors as for :meth:`cast_rays`.

        >>> scene = Scene()
        >>> ball = scene.add_spheres([0, 0, -5], 1)
        >>> RayCaster(scene).occluded([[0, 0, 0, 0, 0, -1], [0, 0, 0, 0, 1, 0]], t_max=4.5).tolist()
        [True, False]
        """
        table, shape = _rays(rays)
        reach = _reach(t_min, t_max)
        return self._world.occluded(table, *reach, bool(coherent), self._threads).reshape(shape)

    def count_hits(
        self, rays: ArrayLike, *, t_min: float = 0.0, t_max: float = math.inf, coherent: bool = False
    ) -> NDArray[np.uint32]:
        """How many surfaces each ray crosses: uint32 of the shape of ``rays`` without its last axis.

        A ray crosses a closed shape twice. Parameters and errors as for :meth:`cast_rays`.

        >>> scene = Scene()
        >>> ball = scene.add_spheres([0, 0, -5], 1)
        >>> RayCaster(scene).count_hits([0, 0, 0, 0, 0, -1]).tolist()
        2
        """
        table, shape = _rays(rays)
        reach = _reach(t_min, t_max)
        return self._world.count_hits(table, *reach, bool(coherent), self._threads).reshape(shape)

    def all_hits(
        self, rays: ArrayLike, *, t_min: float = 0.0, t_max: float = math.inf, coherent: bool = False
    ) -> dict[str, NDArray[Any]]:
        """Every surface that each ray crosses, ray by ray and nearest first.

        Returns
        -------
        dict of arrays of one length: ``ray_ids`` int64, the ray's place (in row order); ``t_hit``, ``geometry_ids`` and
        ``primitive_ids`` as for :meth:`cast_rays`; and ``ray_splits`` int64, so that the crossings of ray i are
        ``ray_splits[i]:ray_splits[i + 1]``.

        Parameters and errors as for :meth:`cast_rays`.

        >>> scene = Scene()
        >>> ball = scene.add_spheres([0, 0, -5], 1)
        >>> RayCaster(scene).all_hits([0, 0, 0, 0, 0, -1])["t_hit"].tolist()
        [4.0, 6.0]
        """
        table, _ = _rays(rays)
        reach = _reach(t_min, t_max)
        found = self._world.all_hits(table, self._geometries, *reach, bool(coherent), self._threads)
        self._name_items(found)
        ids = found.get("ray_ids", np.zeros(0, np.uint32)).astype(np.int64)
        found["ray_ids"] = ids
        found["ray_splits"] = np.searchsorted(ids, np.arange(len(table) + 1))
        return found

    def _name_items(self, found: dict[str, NDArray[Any]]) -> None:
        """Numbers of items as they were given, where some were left out."""
        for geometry, kept in self._kept.items():
            where = found["geometry_ids"] == geometry
            found["primitive_ids"][where] = kept[found["primitive_ids"][where]]


def _rays(value: ArrayLike) -> tuple[Floats, tuple[int, ...]]:
    array = floats(value, "rays")
    if array.ndim == 0 or array.shape[-1] != 6:
        raise ValueError(f"rays has shape {array.shape}: expected (..., 6), origin and direction")
    check_finite(array.reshape(-1, 6), "rays")
    table = array.reshape(-1, 6)
    still = np.flatnonzero(~table[:, 3:].any(axis=1))
    if len(still):
        raise ValueError(f"rays[{still[0]}] has the direction (0, 0, 0): expected any length but 0")
    return table, array.shape[:-1]


def _reach(t_min: float, t_max: float) -> tuple[float, float]:
    low = number(t_min, "t_min")
    high = float(t_max)
    if not high > low:
        raise ValueError(f"t_max is {t_max!r}: expected a number above t_min, {low:g}")
    return low, high
