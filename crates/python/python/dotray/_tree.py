"""What a scene holds, in the order in which it was added, and its way into the compiled half."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from dotray import _dotray
from dotray._look import Material, Texture
from dotray._shapes import Group, Record

__all__ = ["fill", "records", "textures"]

Items = Sequence[Record | Group]


def records(items: Items) -> Iterator[Record]:
    """All records in the order of the tree."""
    open_: list[Iterator[Record | Group]] = [iter(items)]
    while open_:
        for item in open_[-1]:
            if isinstance(item, Group):
                open_.append(iter(item._items))
                break
            yield item
        else:
            open_.pop()


def textures(items: Items) -> dict[Texture, str]:
    """A name for each texture, under which the scene carries it."""
    names: dict[Texture, str] = {}
    for record in records(items):
        texture = record.material.texture
        if texture is not None and texture not in names:
            names[texture] = f"dotray-texture-{len(names)}{texture.extension}"
    return names


def fill(builder: _dotray.Builder, items: Items, numbers: Mapping[Texture, int]) -> None:
    """Puts everything into a builder, which knows the textures by these numbers."""
    materials: dict[Material, int] = {}
    open_: list[Iterator[Record | Group]] = [iter(items)]
    while open_:
        for item in open_[-1]:
            if isinstance(item, Group):
                builder.open_group(item._matrix)
                open_.append(iter(item._items))
                break
            material = materials.get(item.material)
            if material is None:
                texture = item.material.texture
                material = builder.material(item.material, None if texture is None else numbers[texture])
                materials[item.material] = material
            _put(builder, item, material)
        else:
            open_.pop()
            if open_:
                builder.close_group()


def _put(builder: _dotray.Builder, record: Record, material: int) -> None:
    arrays, shades = record.arrays, record.colors
    match record.kind:
        case "spheres":
            _dotray.add_spheres(builder, arrays["centers"], arrays["radii"], material, shades)
        case "boxes":
            _dotray.add_boxes(builder, arrays["centers"], arrays["sizes"], material, shades)
        case "cylinders":
            ends = (arrays["starts"], arrays["ends"], arrays["radii"])
            _dotray.add_cylinders(builder, *ends, arrays["caps"], material, shades)
        case "cones":
            ends = (arrays["starts"], arrays["ends"], arrays["radii"])
            _dotray.add_cones(builder, *ends, arrays["end_radii"], arrays["caps"], material, shades)
        case _:
            mesh = (arrays["vertices"], arrays["faces"], arrays["normals"], arrays["uv"])
            _dotray.add_triangles(builder, *mesh, material, shades)
