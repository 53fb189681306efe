"""Punctual lights for the tracer: their powers, and their records in the scene buffer."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...scene.color import LUMINANCE
from ...scene.light import Light
from ...scene.scene import Scene

_BRIGHTEST = 1e300  # so that sums of them stay finite


def light_powers(lights: Sequence[Light], scene: Scene) -> np.ndarray:
    """About the power that reaches the scene's bounding sphere, luminance in tracer units, (N,); 0 only if none
    does."""
    is_far, position, intensity, cosines, reach = light_columns(lights, scene)
    distance = np.linalg.norm(position, axis=1)
    # Seen from a distance d, the sphere has the solid angle pi / d^2. For a light within it, all directions count. A
    # spot light fills a cone.
    seen = 4 * np.pi / np.maximum(1, 4 * distance**2)
    cone = np.maximum(2 * np.pi * (1 - cosines.mean(axis=1)), 1e-6)
    angle = np.where(is_far, np.pi, np.where(distance - 1 < reach, np.minimum(seen, cone), 0))
    return intensity @ LUMINANCE * angle


def punctual_texels(lights: Sequence[Light], scene: Scene) -> np.ndarray:
    """(3 N, 4) float32: three texels for each light, as shaders/trace/punctual.glsl reads them."""
    is_far, position, intensity, cosines, reach = light_columns(lights, scene)
    direction = np.array([light.direction for light in lights])
    is_spot = np.array([light.kind == "spot" for light in lights])
    # KHR_lights_punctual: clamp(cos * scale + offset). Lights without a cone have 0 and 1.
    scale = 1 / np.maximum(1e-4, cosines[:, 0] - cosines[:, 1])
    texels = np.zeros((len(lights), 3, 4))
    texels[:, 0, :3] = np.where(is_far[:, None], -direction, position)
    texels[:, 0, 3] = np.where(is_far, -1.0, reach**-2.0)
    texels[:, 1, :3] = intensity
    texels[:, 1, 3] = np.where(is_spot, scale, 0.0)
    texels[:, 2, :3] = direction
    texels[:, 2, 3] = np.where(is_spot, -cosines[:, 1] * scale, 1.0)
    return np.clip(texels, -3e38, 3e38).astype(np.float32).reshape(-1, 4)


def light_columns(lights: Sequence[Light], scene: Scene) -> tuple[np.ndarray, ...]:
    """For each light: whether it is directional; position, intensity and range in tracer units; cosines of its cone's
    angles.

    An intensity in candela is divided by unit^2, so that I / d^2 stays the same for distances in tracer units.
    """
    unit = scene.radius
    is_far = np.array([light.kind == "directional" for light in lights])
    position = (np.array([light.position for light in lights], np.float64) - scene.center) / unit
    intensity = np.array([light.color for light in lights]) * np.array([[light.intensity] for light in lights])
    with np.errstate(over="ignore"):
        intensity = np.minimum(np.where(is_far[:, None], intensity, intensity / unit / unit), _BRIGHTEST)
    angles = [(light.inner_cone, light.outer_cone) if light.kind == "spot" else (np.pi, np.pi) for light in lights]
    reach = np.array([light.range or np.inf for light in lights]) / unit
    return is_far, position, intensity, np.cos(angles), reach
