"""Punctual lights as the tracer takes them: what each gives the scene, and their words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...scene.color import LUMINANCE
from ...scene.light import Light
from ...scene.scene import Scene

_BRIGHTEST = 1e300  # so that sums of them stay finite


def light_powers(lights: Sequence[Light], scene: Scene) -> np.ndarray:
    """About what reaches the scene's bounding sphere, luminance in tracer units, (N,); 0 only where nothing does."""
    is_far, position, intensity, cosines, reach = _columns(lights, scene)
    distance = np.linalg.norm(position, axis=1)
    # From a distance d the sphere takes up pi / d^2; to a light within it all around is scene. A spot lights a cone.
    seen = 4 * np.pi / np.maximum(1, 4 * distance**2)
    cone = np.maximum(2 * np.pi * (1 - cosines.mean(axis=1)), 1e-6)
    angle = np.where(is_far, np.pi, np.where(distance - 1 < reach, np.minimum(seen, cone), 0))
    return intensity @ LUMINANCE * angle


def punctual_words(lights: Sequence[Light], scene: Scene) -> np.ndarray:
    """(3 N, 4) float32: see shaders/trace/punctual.glsl."""
    is_far, position, intensity, cosines, reach = _columns(lights, scene)
    direction = np.array([light.direction for light in lights])
    is_spot = np.array([light.kind == "spot" for light in lights])
    # As KHR_lights_punctual gives them: clamp(cos * scale + offset); 0 and 1 for what shines all around
    scale = 1 / np.maximum(1e-4, cosines[:, 0] - cosines[:, 1])
    words = np.zeros((len(lights), 3, 4))
    words[:, 0, :3] = np.where(is_far[:, None], -direction, position)
    words[:, 0, 3] = np.where(is_far, -1.0, reach**-2.0)
    words[:, 1, :3] = intensity
    words[:, 1, 3] = np.where(is_spot, scale, 0.0)
    words[:, 2, :3] = direction
    words[:, 2, 3] = np.where(is_spot, -cosines[:, 1] * scale, 1.0)
    return np.clip(words, -3e38, 3e38).astype(np.float32).reshape(-1, 4)


def _columns(lights: Sequence[Light], scene: Scene) -> tuple[np.ndarray, ...]:
    """By light: whether it is directional; in tracer units position, intensity and range; cosines of its cone's angles.

    An intensity in candela meets distances in tracer units: I / d^2 stays the same when both are divided by unit^2.
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
