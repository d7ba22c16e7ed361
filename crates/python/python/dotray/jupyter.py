"""A scene in a cell of a notebook: turned by hand, traced, its rays looked at, as in the program ``rayview``.

It needs anywidget (``pip install dotray[jupyter]``). Everything happens in the browser, which gets the viewer and the
scene from the kernel; nothing is downloaded.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

try:
    import anywidget
    import traitlets
except ImportError as _missing:
    raise ImportError("dotray.jupyter needs anywidget: pip install anywidget") from _missing

from dotray._scene import Scene
from dotray._tree import textures

__all__ = ["Viewer", "view"]

_WEB = Path(__file__).with_name("web")
_PROGRAM = ("rayview.js", "rayview_bg.wasm.gz", "crew.js", "tracer.js")


class Viewer(anywidget.AnyWidget):  # type: ignore[misc, unused-ignore]
    """What :func:`view` shows: the widget of one scene."""

    _esm = (_WEB / "widget.js").read_text(encoding="utf-8")

    #: The cell's height in points of the screen.
    height: traitlets.Int[int, int] = traitlets.Int(480).tag(sync=True)

    def __init__(self, files: list[tuple[str, bytes]], height: int) -> None:
        super().__init__(height=height)
        self._files = files
        self.on_msg(self._asked)

    def _asked(self, _: Any, content: Any, __: Any) -> None:
        """The browser asks once it shows the cell, so that neither program nor scene is stored in the notebook."""
        if content == "files":
            program = [(_WEB / name).read_bytes() for name in _PROGRAM]
            self.send({"names": [name for name, _ in self._files]}, [*program, *(data for _, data in self._files)])


def view(scene: Scene, height: int = 480) -> Viewer:
    """Shows a scene in the notebook's cell, to be turned by hand and traced.

    A drag turns it, the wheel brings it nearer, ``T`` or *Traced* traces it in the browser with the same pixels as
    :meth:`Scene.render` at the size of the view, a click shows the rays of a pixel. ``height`` is the cell's, in points
    of the screen. What is shown is the scene as it is now.

    The scene goes to the browser as text: it is meant for up to a million shapes or so.

    Raises
    ------
    ValueError
        For what ``.ray`` cannot say, as :meth:`Scene.to_ray` does; for a height that is not above 0.
    RuntimeError
        Where this dotray was built without the viewer.
    """
    if height <= 0:
        raise ValueError(f"height is {height}: expected a number above 0")
    lacking = [name for name in _PROGRAM if not (_WEB / name).is_file()]
    if lacking:
        raise RuntimeError(
            f"this dotray was built without its viewer ({lacking[0]} is missing): "
            "in a checkout, `cargo xtask web` builds it for the next `pip install .`"
        )
    return Viewer(_files(scene), height)


def _files(scene: Scene) -> list[tuple[str, bytes]]:
    """The scene as a file, and the files that it names."""
    names = textures(scene._items)
    files = [("scene.ray", scene._text(names, 640, 480).encode())]
    files += [(name, texture.data) for texture, name in names.items()]
    if scene._base is not None:
        files += [(name, data) for name, data in scene._base.files.items() if name != scene._base.path]
    return files
