"""The camera of scenes that name none, and the lamp of those that name none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dotray._look import Camera, DirectionalLight
from dotray._values import Vector

__all__ = ["Fit", "lamp_above"]


@dataclass(frozen=True)
class Fit:
    """A camera that is placed when the shapes are known."""

    direction: Vector = (0.0, 0.0, -1.0)
    up: Vector = (0.0, 1.0, 0.0)
    half_angle: float = 0.4
    margin: float = 1.0

    def camera(self, low: Sequence[float], high: Sequence[float], width: int, height: int) -> Camera:
        if not all(a <= b for a, b in zip(low, high)):
            return Camera((0.0, 0.0, 0.0), self.direction, self.up, self.half_angle)
        center = [0.5 * (a + b) for a, b in zip(low, high)]
        radius = 0.5 * math.sqrt(sum((b - a) * (b - a) for a, b in zip(low, high)))
        angle = self.half_angle
        if width < height:
            angle = math.atan(math.tan(angle) * width / height)
        distance = self.margin * radius / math.sin(angle)
        length = math.sqrt(sum(x * x for x in self.direction))
        x, y, z = (c - distance * d / length for c, d in zip(center, self.direction))
        return Camera((x, y, z), self.direction, self.up, self.half_angle)


def lamp_above(camera: Camera) -> DirectionalLight:
    """A lamp above the viewer's right shoulder."""
    forward, up = np.array(camera.direction), np.array(camera.up)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, up)
    right = right / np.linalg.norm(right)
    x, y, z = (forward + 0.4 * right - 0.6 * np.cross(right, forward)).tolist()
    return DirectionalLight((x, y, z), (0.7, 0.7, 0.7))
