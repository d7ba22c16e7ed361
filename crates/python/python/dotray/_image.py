"""Pictures."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dotray import _dotray
from dotray._values import floats, number, whole


@dataclass(frozen=True)
class Comparison:
    """How far two pictures are apart; see :func:`compare`."""

    #: Mean and greatest absolute difference, and column and row of the first pixel that differs most.
    mean: float
    max: float
    max_at: tuple[int, int]
    #: Root of the mean squared difference; peak signal-to-noise ratio in decibels.
    rmse: float
    psnr: float
    #: Structural similarity (1 for equal pictures) and mean FLIP difference (0 for equal pictures).
    ssim: float
    flip: float
    #: The mean difference of the 8 × 8 block that differs most, and the column and row of its upper left pixel.
    block: float
    block_at: tuple[int, int]
    #: Pixels of which some channel differs by more than the tolerance, and all pixels.
    pixels_over: int
    pixels: int


class Image:
    """A picture: numbers of which 0 is black and 1 is white, not clamped.

    Parameters
    ----------
    pixels : (H, W, 3) or (H, W, 4) array, upper row first; the fourth channel is alpha, and colours are not multiplied
        by it. float32 in C order is taken as it is, all else is converted.

    Attributes
    ----------
    layers : dict of the layers that were asked for: (H, W) or (H, W, channels) float32 each.
    stats : dict of what the picture cost: rays, tests, ``memory`` in bytes by part, ``seconds`` by stage.

    Raises
    ------
    ValueError
        For an array of another shape or dtype, naming it.

    >>> import numpy as np
    >>> Image(np.zeros((2, 3, 3))).numpy().shape
    (2, 3, 3)
    """

    def __init__(self, pixels: ArrayLike) -> None:
        array = floats(pixels, "pixels")
        if array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape:
            raise ValueError(f"pixels has shape {array.shape}: expected (H, W, 3) or (H, W, 4)")
        self._pixels: NDArray[np.float32] = np.ascontiguousarray(array, dtype=np.float32)
        self.layers: dict[str, NDArray[np.float32]] = {}
        self._channels: dict[str, list[str]] = {}
        self.stats: dict[str, Any] = {}

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Image:
        """The picture of a file: BMP, PNG, JPEG, TIFF, PPM, QOI, OpenEXR, Radiance HDR or PFM.

        Raises OSError for a file that cannot be read, ValueError for one that is no picture.
        """
        return cls(_dotray.decode(Path(path).read_bytes()))

    @property
    def width(self) -> int:
        """Columns."""
        return int(self._pixels.shape[1])

    @property
    def height(self) -> int:
        """Rows."""
        return int(self._pixels.shape[0])

    def numpy(self) -> NDArray[np.float32]:
        """The pixels as (H, W, 3) or (H, W, 4) float32, upper row first: the picture's own memory, not a copy.

        >>> image = Image(np.zeros((2, 3, 3)))
        >>> image.numpy()[0, 0] = 1, 0.5, 0
        >>> image.numpy()[0, 0].tolist()
        [1.0, 0.5, 0.0]
        """
        return self._pixels

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        array: NDArray[Any] = self._pixels if dtype is None else self._pixels.astype(dtype, copy=False)
        return array.copy() if copy else array

    def save(self, path: str | os.PathLike[str], *, srgb: bool = False, jpeg_quality: int = 95) -> None:
        """Writes the picture, whole or not at all; the extension chooses the format.

        ``.png .bmp .jpg .tif .ppm .qoi`` hold 8 bits a channel, round(255 · clamp(c, 0, 1)); ``.exr .hdr .pfm`` hold
        the numbers as they are, and ``.exr`` the layers too, as channels such as ``depth.Z``. ``srgb`` applies the sRGB
        curve before numbers become bytes.

        Raises ValueError for an unknown extension, OSError where the file cannot be written.
        """
        path = Path(path)
        channels: list[tuple[str, NDArray[np.float32]]] = []
        if path.suffix.lower() == ".exr":
            for name, layer in self.layers.items():
                table = layer[:, :, np.newaxis] if layer.ndim == 2 else layer
                for i, channel in enumerate(self._channels[name]):
                    channels.append((f"{name}.{channel}", np.ascontiguousarray(table[:, :, i])))
        quality = whole(jpeg_quality, "jpeg_quality", 1, 100)
        _dotray.write_file(path, _dotray.encode(self._pixels, path, srgb, quality, channels))

    def png(self) -> bytes:
        """The picture as the bytes of a PNG file.

        >>> Image(np.zeros((2, 3, 3))).png()[1:4]
        b'PNG'
        """
        return _dotray.encode(self._pixels, "picture.png", False, 95, [])

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        layers = f", layers {', '.join(self.layers)}" if self.layers else ""
        return f"<dotray.Image {self.width}x{self.height}, {self._pixels.shape[2]} channels{layers}>"

    def compare(self, other: Image | ArrayLike, tolerance: float = 0.0) -> Comparison:
        """How far another picture of the same size is apart; see :func:`compare`."""
        return compare(self, other, tolerance)


def compare(a: Image | ArrayLike, b: Image | ArrayLike, tolerance: float = 0.0) -> Comparison:
    """How far two pictures (or arrays (H, W, 3 or 4)) of the same size are apart.

    ``tolerance`` is the difference of a channel above which a pixel counts as different.

    Raises ValueError where the sizes differ.

    >>> import numpy as np
    >>> black = np.zeros((16, 16, 3))
    >>> other = black.copy(); other[3, 5] = 0.5
    >>> found = compare(black, other, tolerance=0.1)
    >>> found.max, found.max_at, found.pixels_over
    (0.5, (5, 3), 1)
    """
    first, second = (picture if isinstance(picture, Image) else Image(picture) for picture in (a, b))
    found = _dotray.compare(first.numpy(), second.numpy(), number(tolerance, "tolerance", 0.0))
    return Comparison(**found)


def add_layers(image: Image, layers: dict[str, tuple[NDArray[np.float32], list[str]]]) -> None:
    """Puts layers into a picture, those of one channel as (H, W)."""
    for name, (array, channels) in layers.items():
        image.layers[name] = array[:, :, 0] if len(channels) == 1 else array
        image._channels[name] = channels
