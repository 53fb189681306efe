"""A sun in an environment, taken out and made a directional light.

A sun holds most of an outdoor map's energy in a handful of texels: no filtered map or low-order irradiance shows it
well, half floats cannot hold it, and it should cast a shadow. Energy is booked: what leaves the map is the light's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene.color import LUMINANCE
from ..scene.environment import Environment
from ..scene.equirect import texel_directions, texel_solid_angles
from ..scene.light import Light

SHARE = 0.15  # of the whole map's energy: the suns of real skies hold 0.5 and more, single lamps 0.1 and less
CORE, DISK, RING = np.radians([1.5, 2.5, 5.0])  # half angles; a sun with its glare in a camera's lens is 1 degree wide
MOST = 3


def extract_sun(environment: Environment) -> tuple[Environment, list[Light]]:
    """The environment without its suns, and those as directional lights, before its rotation and intensity.

    A sun is a spot of DISK's size that outshines the ring around it by SHARE of all energy on the map, nine tenths of
    that within CORE; soft boxes, windows and strings of lamps are none. It is lowered to the ring's median radiance;
    the light's `intensity` is the integral of what was removed over solid angle (lux: irradiance facing it), its
    direction that integral's centroid, its `angular_radius` that of a disk of the sun's mean radiance, each part of it
    weighed by the light it sends. Without a sun the same environment comes back.
    """
    radiance = environment.radiance
    height, width = radiance.shape[:2]
    lights: list[Light] = []
    if width * CORE < 2 * np.pi:  # a texel wider than a sun says nothing about compactness
        return environment, lights
    solid_angles = texel_solid_angles(height, width)
    luminance = radiance @ LUMINANCE.astype(np.float32)
    total = width * float(solid_angles @ luminance.mean(axis=1, dtype=np.float64))
    for _ in range(MOST):
        peak = divmod(int(luminance.argmax()), width)
        # No spot of this size can hold the share unless its peak could, spread over all of it.
        if luminance[peak] * np.pi * DISK**2 <= SHARE * total:
            break
        spot = _Spot(radiance, peak, solid_angles)
        excess = spot.removed @ LUMINANCE
        if excess.sum() < SHARE * total or excess[spot.angle < CORE].sum() < 0.9 * excess.sum():
            break
        if not lights:
            radiance = radiance.copy()
        lights.append(spot.light())
        radiance[spot.rows, spot.columns] = spot.lowered
        luminance[spot.rows, spot.columns] = spot.lowered @ LUMINANCE
    return (replace(environment, source=radiance, digest="") if lights else environment), lights


class _Spot:
    """The texels within DISK of the brightest: where they are, what is removed (radiance x solid angle), what stays."""

    def __init__(self, radiance: np.ndarray, peak: tuple[int, int], solid_angles: np.ndarray) -> None:
        height, width = radiance.shape[:2]
        reach = int(np.ceil(RING / np.pi * height)) + 1
        first = max(0, peak[0] - reach)
        band = slice(first, peak[0] + reach + 1)
        directions = texel_directions(height, width, band)
        angle = np.arccos(np.clip(directions @ directions[peak[0] - first, peak[1]], -1, 1))
        surround = np.median(radiance[band][(angle > DISK) & (angle < RING)], axis=0)
        rows, self.columns = np.nonzero(angle <= DISK)
        self.rows = rows + first
        self.angle = angle[rows, self.columns]
        self.directions = directions[rows, self.columns]
        before = radiance[self.rows, self.columns]
        self.lowered = np.minimum(before, surround)
        self._solid_angles = solid_angles[self.rows, None]
        self.removed = (before.astype(np.float64) - self.lowered) * self._solid_angles

    def light(self) -> Light:
        energy = self.removed.sum(axis=0)
        luminance = self.removed @ LUMINANCE
        centroid = luminance @ self.directions
        direction = -centroid / np.linalg.norm(centroid)
        lux = float(energy.max())
        color = tuple((energy / lux).tolist())
        solid_angle = luminance.sum() ** 2 / (luminance**2 / self._solid_angles[:, 0]).sum()
        radius = float(np.arccos(1 - solid_angle / (2 * np.pi)))
        return Light("directional", color, lux, direction=tuple(direction.tolist()), angular_radius=radius, name="sun")
