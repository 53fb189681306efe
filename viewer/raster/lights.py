"""Punctual lights as the uniform block of shaders/light/punctual.glsl."""

from __future__ import annotations

import numpy as np

from ..plan.model import Plan
from ..scene.frame import Frame
from ..scene.light import BRIGHTEST

_NEAREST = 1e-8
"""The least square of a distance, which prevents a division by 0 at the light: (1e-4 of the scene's radius)^2."""

_SHORTEST = 1e18
"""The most of 1 / range, whose square float32 holds. A light of a shorter range than 1e-18 of the scene's radius
reaches nothing."""


def pack_lights(plan: Plan, frame: Frame) -> np.ndarray:
    """The lights, (N, 4, 4) float32: position, direction, intensity, cone, in eye-relative units.

    An intensity in candela meets distances in scene units: I / d^2 stays the same when both are divided by unit^2.
    """
    rows = np.zeros((len(plan.lights), 4, 4))
    for row, light, layer in zip(rows, plan.lights, plan.shadow_layers, strict=True):
        row[0, :3] = frame.position(light.position)
        row[0, 3] = min(frame.unit / light.range, _SHORTEST) ** 2 if light.range else 0.0
        row[1, :3], row[1, 3] = light.direction, layer
        scale = light.intensity if light.kind == "directional" else light.intensity / frame.unit / frame.unit
        row[2, :3] = np.minimum(np.multiply(light.color, scale), BRIGHTEST)
        row[2, 3] = light.angular_radius**2
        row[3, :2] = light.cone
        row[3, 2] = max((light.radius / frame.unit) ** 2, _NEAREST)
    return np.clip(rows, -3e38, 3e38).astype(np.float32)
