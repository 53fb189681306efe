"""Punctual lights as the uniform block of shaders/light/punctual.glsl."""

from __future__ import annotations

import math

import numpy as np

from ..plan.model import Plan
from ..scene.frame import Frame
from ..scene.light import Light


def pack_lights(plan: Plan, frame: Frame) -> np.ndarray:
    """The lights, (N, 4, 4) float32: position, direction, intensity, cone, in eye-relative units.

    An intensity in candela meets distances in scene units: I / d^2 stays the same when both are divided by unit^2.
    """
    rows = np.zeros((len(plan.lights), 4, 4))
    for row, light, layer in zip(rows, plan.lights, plan.shadow_layers, strict=True):
        row[0, :3] = frame.position(light.position)
        row[0, 3] = (frame.unit / light.range) ** 2 if light.range else 0.0
        row[1, :3], row[1, 3] = light.direction, layer
        scale = light.intensity if light.kind == "directional" else light.intensity / frame.unit / frame.unit
        row[2, :3] = np.multiply(light.color, scale)
        row[2, 3] = light.angular_radius**2
        row[3, :2] = spot_cone(light)
    return np.clip(rows, -3e38, 3e38).astype(np.float32)


def spot_cone(light: Light) -> tuple[float, float]:
    """Scale and offset of the angular attenuation, as KHR_lights_punctual gives them."""
    cos_outer = math.cos(light.outer_cone)
    scale = 1.0 / max(1e-4, math.cos(light.inner_cone) - cos_outer)
    return scale, -cos_outer * scale
