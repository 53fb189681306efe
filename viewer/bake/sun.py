"""Extracts suns from an environment as directional lights.

A sun contains most of an outdoor map's energy in a few texels. Filtered maps and low-order irradiance represent it
badly, half floats cannot store it, and it should cast a shadow. Energy is conserved: what is removed from the map
becomes the light.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene.color import LUMINANCE
from ..scene.environment import Environment
from ..scene.equirect import texel_directions, texel_solid_angles
from ..scene.light import Light

MIN_FRACTION = 0.15  # of the map's energy: suns of real skies have 0.5 or more, single lamps 0.1 or less
CORE, DISK, RING = np.radians([1.5, 2.5, 5.0])  # half angles; a photographed sun with its lens glare is 1 degree wide
MAX_SUNS = 3


def extract_sun(environment: Environment) -> tuple[Environment, list[Light]]:
    """The environment without its suns, and the suns as directional lights, without its rotation and intensity.

    A sun is a spot within the angle DISK whose energy above the ring around it (up to RING) is at least MIN_FRACTION of
    the map's energy, with nine tenths of that within CORE. Soft boxes, windows and strings of lamps do not count. Its
    texels are lowered to the ring's median radiance. The light's `intensity` is the integral of the removed radiance
    over solid angle (in lux, the irradiance of a surface facing it), and its direction is the centroid of that
    integral. Its `angular_radius` is that of a disk with the same energy and with the sun's mean radiance, weighted by
    energy. Without a sun the same environment is returned.
    """
    radiance = environment.radiance
    height, width = radiance.shape[:2]
    lights: list[Light] = []
    if width * CORE < 2 * np.pi:  # with texels wider than a sun, compactness cannot be judged
        return environment, lights
    solid_angles = texel_solid_angles(height, width)
    luminance = radiance @ LUMINANCE.astype(np.float32)
    total = width * float(solid_angles @ luminance.mean(axis=1, dtype=np.float64))
    for _ in range(MAX_SUNS):
        peak = divmod(int(luminance.argmax()), width)
        # The peak's luminance over the whole spot is an upper bound of the spot's energy.
        if luminance[peak] * np.pi * DISK**2 <= MIN_FRACTION * total:
            break
        spot = _Spot(radiance, peak, solid_angles)
        excess = spot.removed @ LUMINANCE
        if excess.sum() < MIN_FRACTION * total or excess[spot.angle < CORE].sum() < 0.9 * excess.sum():
            break
        if not lights:
            radiance = radiance.copy()
        lights.append(spot.light())
        radiance[spot.rows, spot.columns] = spot.lowered
        luminance[spot.rows, spot.columns] = spot.lowered @ LUMINANCE
    return (replace(environment, source=radiance, digest="") if lights else environment), lights


class _Spot:
    """The texels within DISK of the brightest one: their positions, the energy removed from each (radiance x solid
    angle, `removed`), and the radiance that remains (`lowered`)."""

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
