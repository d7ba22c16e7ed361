"""dotray: spheres, cylinders, cones, boxes and triangles from numpy arrays to a picture, without a GPU or a display.

Three lines make a picture:

>>> import numpy as np, dotray
>>> scene = dotray.Scene()
>>> spheres = scene.add_spheres(np.random.default_rng(1).random((100, 3)), 0.05, color=(0.9, 0.4, 0.1))
>>> image = scene.render(160, 120)
>>> image.numpy().shape
(120, 160, 3)

:class:`Scene` takes arrays and renders them, :func:`load` reads a ``.ray`` file, :class:`RayCaster` answers batches of
rays, :mod:`dotray.cluster` renders on many machines, and :mod:`dotray.jupyter` shows a scene in a notebook.
"""

import importlib
from typing import Any

from dotray._caster import INVALID_ID, RayCaster
from dotray._dotray import VERSION as __version__
from dotray._dotray import SceneError
from dotray._image import Comparison, Image, compare
from dotray._look import AreaLight, Camera, DirectionalLight, Light, Material, PointLight, SpotLight, Texture
from dotray._progress import follow
from dotray._scene import Diagnostic, Group, Scene, load

__all__ = [
    "INVALID_ID",
    "AreaLight",
    "Camera",
    "Comparison",
    "Diagnostic",
    "DirectionalLight",
    "Group",
    "Image",
    "Light",
    "Material",
    "PointLight",
    "RayCaster",
    "Scene",
    "SceneError",
    "SpotLight",
    "Texture",
    "__version__",
    "compare",
    "follow",
    "load",
]


def __getattr__(name: str) -> Any:
    """The module ``jupyter`` comes when it is asked for: it needs a package that few have."""
    if name == "jupyter":
        return importlib.import_module("dotray.jupyter")
    raise AttributeError(f"module 'dotray' has no attribute {name!r}")
