"""Shapes of arrays: what a scene and its groups take."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dotray import _dotray
from dotray._look import Material
from dotray._values import Floats, Vector, broadcast, check_finite, colors, floats, lengths, matrix, rows

if TYPE_CHECKING:
    from dotray._scene import Scene

Color = ArrayLike | str | None


@dataclass
class Record:
    """What one ``add_`` call was given."""

    kind: str
    geometry: int
    count: int
    arrays: dict[str, Any]
    material: Material
    colors: NDArray[np.float32] | None
    #: The items that became shapes, where some were left out.
    kept: NDArray[np.int64] | None = None

    def __getstate__(self) -> dict[str, Any]:
        """What stands for all items travels once."""
        arrays = {name: _single(array) for name, array in self.arrays.items()}
        return {**self.__dict__, "arrays": arrays, "colors": _single(self.colors)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.arrays = {name: _all(array) for name, array in self.arrays.items()}
        self.colors = _all(self.colors)


@dataclass
class _Same:
    """One row for so many items."""

    row: NDArray[Any]
    count: int


def _single(array: Any) -> Any:
    if isinstance(array, np.ndarray) and len(array) > 1 and array.strides[0] == 0:
        return _Same(array[:1].copy(), len(array))
    return array


def _all(array: Any) -> Any:
    if isinstance(array, _Same):
        return np.broadcast_to(array.row, (array.count, *array.row.shape[1:]))
    return array


class Container:
    """What shapes can be added to: a scene or a group."""

    _items: list[Record | Group]

    def _owner(self) -> Scene:
        raise NotImplementedError

    def _add(
        self,
        kind: str,
        count: int,
        arrays: dict[str, Any],
        color: NDArray[np.float32] | Vector | None,
        material: Material | None,
        kept: NDArray[np.int64] | None = None,
    ) -> int:
        scene = self._owner()
        if material is None:
            white = (1.0, 1.0, 1.0)
            material = Material() if color is None else Material(white if not isinstance(color, tuple) else color)
            color = None if isinstance(color, tuple) else color
        elif isinstance(color, tuple):
            material, color = material.colored(color), None
        if color is not None:
            color = np.broadcast_to(color, (count, 3))
        geometry = scene._geometries
        scene._geometries += 1
        self._items.append(Record(kind, geometry, count, arrays, material, color, kept))
        scene._changed()
        return geometry

    def add_spheres(
        self,
        centers: ArrayLike,
        radii: ArrayLike,
        *,
        color: Color = None,
        material: Material | None = None,
    ) -> int:
        """Adds spheres.

        Parameters
        ----------
        centers : (N, 3), or (3,) for one. float32 and float64 are used where they lie, whatever their strides; do not
            change an array before the picture is made.
        radii : (N,) or one number, above 0, in the units of the centers.
        color : one colour (three numbers, ``'#rrggbb'`` or a name) or (N, 3), one a sphere; uint8 counts as n/255. It
            multiplies the ambient and diffuse colour of ``material``, or is them where there is no material. Colours of
            single spheres are kept in single precision.
        material : a :class:`Material` for all of them.

        Returns
        -------
        The geometry's number, as :class:`RayCaster` gives it.

        Raises
        ------
        ValueError
            For wrong shapes and dtypes, numbers that are not finite, radii that are not above 0: naming the argument,
            the index and the value.

        >>> import dotray
        >>> scene = dotray.Scene()
        >>> scene.add_spheres([[0, 0, 0], [2, 0, 0]], 1, color=[[1, 0, 0], [0, 0, 1]])
        0
        >>> scene.add_spheres([[0, 0, 0], [2, 0, 0]], [1, -1])
        Traceback (most recent call last):
        ValueError: radii[1] is -1.0: expected a number above 0
        """
        table, shade = rows(centers, "centers", 3), None if color is None else colors(color, "color")
        arrays = {"centers": table, "radii": lengths(radii, "radii")}
        count, arrays = broadcast(arrays, _count(shade))
        return self._add("spheres", count, arrays, shade, material)

    def add_cylinders(
        self,
        starts: ArrayLike,
        ends: ArrayLike,
        radii: ArrayLike,
        *,
        caps: bool = True,
        color: Color = None,
        material: Material | None = None,
    ) -> int:
        """Adds cylinders from ``starts`` to ``ends``.

        Parameters
        ----------
        starts, ends : (N, 3), or (3,) for one; no two the same.
        radii : (N,) or one number, above 0.
        caps : whether discs close the ends. Sides alone are ``#shape_side`` in files, which is dotray's own directive.
        color, material : as for :meth:`add_spheres`.

        Returns the geometry's number; raises ValueError as :meth:`add_spheres`.

        >>> import dotray
        >>> dotray.Scene().add_cylinders([0, 0, 0], [[1, 0, 0], [0, 1, 0]], 0.1)
        0
        """
        shade = None if color is None else colors(color, "color")
        arrays = {
            "starts": rows(starts, "starts", 3),
            "ends": rows(ends, "ends", 3),
            "radii": lengths(radii, "radii"),
        }
        count, arrays = broadcast(arrays, _count(shade))
        _check_apart(arrays["starts"], arrays["ends"])
        return self._add("cylinders", count, {**arrays, "caps": bool(caps)}, shade, material)

    def add_cones(
        self,
        starts: ArrayLike,
        ends: ArrayLike,
        radii: ArrayLike,
        end_radii: ArrayLike = 0.0,
        *,
        caps: bool = True,
        color: Color = None,
        material: Material | None = None,
    ) -> int:
        """Adds cones from ``starts``, where their discs lie, to ``ends``, where their apices are.

        Parameters
        ----------
        starts, ends : (N, 3), or (3,) for one; no two the same.
        radii : (N,) or one number: the radius at the start.
        end_radii : (N,) or one number: the radius at the end. Where both are above 0 the cone is truncated and has two
            discs; at least one is above 0.
        caps : whether discs close the ends, as for :meth:`add_cylinders`.
        color, material : as for :meth:`add_spheres`.

        Returns the geometry's number; raises ValueError as :meth:`add_spheres`.

        >>> import dotray
        >>> dotray.Scene().add_cones([0, 0, 0], [0, 1, 0], 0.5, [0, 0.2])
        0
        """
        shade = None if color is None else colors(color, "color")
        arrays = {
            "starts": rows(starts, "starts", 3),
            "ends": rows(ends, "ends", 3),
            "radii": _lengths_or_0(radii, "radii"),
            "end_radii": _lengths_or_0(end_radii, "end_radii"),
        }
        count, arrays = broadcast(arrays, _count(shade))
        _check_apart(arrays["starts"], arrays["ends"])
        points = np.flatnonzero((arrays["radii"] == 0.0) & (arrays["end_radii"] == 0.0))
        if len(points):
            raise ValueError(f"radii[{points[0]}] and end_radii[{points[0]}] are 0: expected one above 0")
        return self._add("cones", count, {**arrays, "caps": bool(caps)}, shade, material)

    def add_boxes(
        self,
        centers: ArrayLike,
        sizes: ArrayLike,
        *,
        color: Color = None,
        material: Material | None = None,
    ) -> int:
        """Adds boxes along the axes; a group turns them.

        Parameters
        ----------
        centers : (N, 3), or (3,) for one.
        sizes : full lengths of the edges: (N, 3), (3,) for all, or one number for cubes; above 0.
        color, material : as for :meth:`add_spheres`.

        Returns the geometry's number; raises ValueError as :meth:`add_spheres`.

        >>> import dotray
        >>> dotray.Scene().add_boxes([[0, 0, 0], [3, 0, 0]], (1, 2, 1))
        0
        """
        shade = None if color is None else colors(color, "color")
        edges = floats(sizes, "sizes")
        if edges.ndim == 0:
            table = rows(np.broadcast_to(edges, (1, 3)), "sizes", 3)
        else:
            table = rows(edges, "sizes", 3)
        place = _dotray.first_not_positive(table)
        if place is not None:
            raise ValueError(f"sizes[{place // 3}, {place % 3}] is {table.flat[place]}: expected a number above 0")
        count, arrays = broadcast({"centers": rows(centers, "centers", 3), "sizes": table}, _count(shade))
        return self._add("boxes", count, arrays, shade, material)

    def add_triangles(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        *,
        color: Color = None,
        material: Material | None = None,
    ) -> int:
        """Adds a mesh of triangles.

        Parameters
        ----------
        vertices : (V, 3).
        faces : (F, 3) whole numbers below V; counter-clockwise seen from outside.
        normals : (V, 3) for a smooth surface, of any length; without them, or where one is 0, faces are flat.
        uv : (V, 2) places in the material's texture.
        color : one colour or (F, 3), one a face.
        material : a :class:`Material` for all faces.

        Returns the geometry's number; raises ValueError as :meth:`add_spheres`. Faces without area are left out, with a
        warning; the other faces keep their numbers.

        >>> import dotray
        >>> dotray.Scene().add_triangles([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        0
        >>> dotray.Scene().add_triangles([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])
        Traceback (most recent call last):
        ValueError: faces[0, 2] is 3: expected the number of one of 3 vertices
        """
        points = rows(vertices, "vertices", 3)
        corners = _faces(faces, len(points))
        arrays: dict[str, Any] = {"vertices": points, "normals": None, "uv": None}
        for name, given, columns in (("normals", normals, 3), ("uv", uv, 2)):
            if given is not None:
                arrays[name] = rows(given, name, columns)
                if len(arrays[name]) != len(points):
                    raise ValueError(f"{name} has {len(arrays[name])} rows: expected {len(points)}, one a vertex")
        shade = None if color is None else colors(color, "color")
        if isinstance(shade, np.ndarray) and len(shade) not in (1, len(corners)):
            hint = "; of vertices: color[faces].mean(axis=1)" if len(shade) == len(points) else ""
            raise ValueError(f"color has {len(shade)} rows: expected {len(corners)}, one a face{hint}")
        flat = _dotray.faces_without_area(points, corners)
        kept = None
        if flat:
            warnings.warn(f"{len(flat)} faces without area are left out, faces[{flat[0]}] first", stacklevel=2)
            kept = np.setdiff1d(np.arange(len(corners)), flat)
            corners = corners[kept]
            shade = shade[kept] if isinstance(shade, np.ndarray) and len(shade) > 1 else shade
        arrays["faces"] = corners
        return self._add("triangles", len(corners), arrays, shade, material, kept)

    def add_group(self, matrix_: ArrayLike) -> Group:
        """Adds a group, which takes shapes (and groups) of its own and moves them by a matrix.

        Parameters
        ----------
        matrix_ : (4, 4), the last row 0 0 0 1; it acts on columns, so that ``matrix_[:3, 3]`` is the shift. Unequal
            scales make exact ellipsoids of spheres.

        Raises ValueError for another shape or last row, numbers that are not finite, and a matrix without inverse.

        >>> import numpy as np
        >>> import dotray
        >>> group = dotray.Scene().add_group(np.diag([2, 1, 1, 1]))
        >>> group.add_spheres([0, 0, 0], 1)
        0
        """
        group = Group(self._owner(), matrix(matrix_, "matrix"))
        self._items.append(group)
        return group


class Group(Container):
    """Shapes that are moved together; made by ``add_group``."""

    def __init__(self, scene: Scene, numbers: list[float]) -> None:
        self._scene = scene
        self._matrix = numbers
        self._items = []

    def _owner(self) -> Scene:
        return self._scene


def _count(shade: NDArray[np.float32] | Vector | None) -> dict[str, int]:
    return {"color": len(shade)} if isinstance(shade, np.ndarray) else {}


def _check_apart(starts: Floats, ends: Floats) -> None:
    same = np.flatnonzero((starts == ends).all(axis=1))
    if len(same):
        raise ValueError(f"ends[{same[0]}] is {ends[same[0]].tolist()}, which is starts[{same[0]}], too")


def _lengths_or_0(value: ArrayLike, name: str) -> Floats:
    array = floats(value, name)
    if array.ndim > 1:
        raise ValueError(f"{name} has shape {array.shape}: expected one number or (N,)")
    check_finite(array, name)
    below = np.flatnonzero(array < 0.0)
    if len(below):
        where = f"[{below[0]}]" if array.ndim else ""
        raise ValueError(f"{name}{where} is {array.flat[below[0]]}: expected a number of 0 or more")
    return array.reshape(1) if array.ndim == 0 else array


def _faces(value: ArrayLike, vertices: int) -> NDArray[np.uint32]:
    array = np.asarray(value)
    if array.shape == (3,):
        array = array[np.newaxis, :]
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"faces has shape {array.shape}: expected (F, 3)")
    if array.dtype.kind not in "iu":
        raise ValueError(f"faces has dtype {array.dtype}: expected whole numbers")
    bad = np.argwhere((array < 0) | (array >= vertices))
    if len(bad):
        row, column = bad[0]
        found = array[row, column]
        raise ValueError(f"faces[{row}, {column}] is {found}: expected the number of one of {vertices} vertices")
    return array.astype(np.uint32, copy=False)
