"""Built-in environments, computed from formulas: a studio, a sky with its sun, and the white furnace."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np

from .color import LUMINANCE
from .environment import Environment
from .equirect import sphere_integral, texel_directions, texel_solid_angles

WIDTH, HEIGHT = 1024, 512


def make_preset(name: str) -> Environment:
    """The built-in environment of that name, one of PRESETS."""
    digest = hashlib.blake2b(Path(__file__).read_bytes(), digest_size=20).hexdigest()
    return Environment(name, PRESETS[name], digest=f"{name} {digest}")


@lru_cache(maxsize=1)
def furnace() -> np.ndarray:
    """Radiance 1 from all directions, in which a surface that neither absorbs nor loses light is invisible."""
    return np.ones((32, 64, 3), np.float32)


# Soft boxes of the studio: azimuth (0 = +Z, towards +X) and elevation of the centre in degrees, width and height in
# degrees as seen from the object, radiance. The default camera is at azimuth 30, elevation 15.
_SOFT_BOXES = (
    (-25.0, 42.0, 56.0, 50.0, 5.6),  # key: large, to the camera's left and above
    (105.0, 22.0, 44.0, 70.0, 1.7),  # fill: to the right, a third as bright
    (205.0, 38.0, 70.0, 22.0, 6.0),  # rim: a strip behind the object, separates its outline from the backdrop
    (0.0, 90.0, 44.0, 44.0, 1.2),  # overhead, for top faces
)


@lru_cache(maxsize=1)
def studio() -> np.ndarray:
    """Neutral light for inspecting models: four soft boxes before a grey backdrop that is darker below."""
    y = np.cos(np.pi * (np.arange(HEIGHT, dtype=np.float32) + 0.5) / HEIGHT)
    # Backdrop: radiance 0.10 below and 0.40 above, with a smooth transition about the horizon.
    grey = 0.10 + 0.30 * _smoothstep((y + 0.35) / 0.9)
    grey = np.repeat(grey[:, None], WIDTH, axis=1)
    for azimuth, elevation, wide, high, radiance in _SOFT_BOXES:
        _add_soft_box(grey, radiance, *map(math.radians, (azimuth, elevation, wide, high)))
    return np.repeat(grey[:, :, None], 3, axis=2)


def _add_soft_box(
    grey: np.ndarray, radiance: float, azimuth: float, elevation: float, wide: float, high: float
) -> None:
    """Add a rectangular light to `grey`, in place. It faces the origin, has soft edges and a brighter middle."""
    sin_az, cos_az, sin_el, cos_el = math.sin(azimuth), math.cos(azimuth), math.sin(elevation), math.cos(elevation)
    frame = np.array([  # right, up, ahead
        [cos_az, 0, -sin_az], [-sin_el * sin_az, cos_el, -sin_el * cos_az], [cos_el * sin_az, sin_el, cos_el * cos_az]
    ], np.float32)  # fmt: skip
    reach = math.hypot(math.tan(wide / 2), math.tan(high / 2))
    centre, span = math.pi / 2 - elevation, math.atan(reach) + 0.02
    first, last = int((centre - span) / math.pi * HEIGHT), int((centre + span) / math.pi * HEIGHT)
    rows = slice(max(0, first), last + 1)
    right, up, ahead = np.moveaxis(texel_directions(HEIGHT, WIDTH, rows).astype(np.float32) @ frame.T, 2, 0)
    ahead = np.maximum(ahead, 1e-3)
    right, up = np.abs(right / ahead) / math.tan(wide / 2), np.abs(up / ahead) / math.tan(high / 2)
    inside = _smoothstep((1 - right) / 0.12) * _smoothstep((1 - up) / 0.12)
    grey[rows] += radiance * inside * (1 - 0.25 * np.minimum(right * right + up * up, 2))


SUN_AZIMUTH, SUN_ELEVATION = math.radians(-35.0), math.radians(42.0)
SUN_RADIUS = math.radians(0.53 / 2)
TURBIDITY = 3.0
GROUND_ALBEDO = 0.2
HAZE = 0.02
"""Optical depth of the air straight below the eye: 200 m where the visibility is 40 km. By Koschmieder 1924 a contrast
of 0.02 is left at the visibility, so the extinction is -ln 0.02 / 40 km. It softens the edge of the ground."""
_SOLAR_ILLUMINANCE = 128.0  # klx outside the atmosphere


@lru_cache(maxsize=1)
def sky() -> np.ndarray:
    """A clear sky (Preetham, Shirley and Smits 1999) with a sun disk of 0.53 degrees, over a grey ground in haze.

    It is scaled so that a horizontal white surface has radiance 1 under sky and sun together.
    """
    sun = _sun_direction()
    radiance = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    upper = slice(0, HEIGHT // 2)
    directions = texel_directions(HEIGHT, WIDTH, upper)
    radiance[upper] = _preetham(directions[:, 0, 1], (directions @ sun).astype(np.float32), SUN_ELEVATION)
    disk = _sun_disk(sun)
    illuminance = _sun_illuminance(SUN_ELEVATION)
    down = directions[:, :1, 1:2] * texel_solid_angles(HEIGHT, WIDTH)[upper, None, None]
    on_ground = (radiance[upper] * down).sum(axis=(0, 1)) + illuminance * sun[1]
    lower = slice(HEIGHT // 2, HEIGHT)
    seen = np.exp(HAZE / texel_directions(HEIGHT, WIDTH, lower)[:, :1, 1:2]).astype(np.float32)
    ground, horizon = GROUND_ALBEDO * on_ground / np.pi, radiance[HEIGHT // 2 - 1]
    radiance[lower] = seen * ground.astype(np.float32) + (1 - seen) * horizon
    radiance += disk[:, :, None] * illuminance.astype(np.float32)
    return radiance * np.float32(np.pi / (on_ground @ LUMINANCE))


def _sun_direction() -> np.ndarray:
    flat = math.cos(SUN_ELEVATION)
    return np.array([flat * math.sin(SUN_AZIMUTH), math.sin(SUN_ELEVATION), flat * math.cos(SUN_AZIMUTH)])


def _sun_illuminance(elevation: float) -> np.ndarray:
    """Illuminance of a surface facing the sun, klx, linear Rec. 709, after Rayleigh and aerosol extinction (Preetham
    1999, appendix 1)."""
    wavelength = np.array([0.610, 0.550, 0.465])  # micrometres, near the peaks of the three primaries
    air_mass = 1 / (math.sin(elevation) + 0.15 * (math.degrees(elevation) + 3.885) ** -1.253)
    beta = 0.04608 * TURBIDITY - 0.04586
    return _SOLAR_ILLUMINANCE * np.exp(-air_mass * (0.008735 * wavelength**-4.08 + beta * wavelength**-1.3))


def _sun_disk(sun: np.ndarray) -> np.ndarray:
    """The fraction of each texel that the disk covers, scaled to integrate to 1 over the sphere, (H, W) float32."""
    fine = 8
    row = int(math.acos(sun[1]) / math.pi * HEIGHT)
    rows = slice((row - 2) * fine, (row + 3) * fine)
    directions = texel_directions(HEIGHT * fine, WIDTH * fine, rows).astype(np.float32)
    covered = (directions @ sun.astype(np.float32)) > math.cos(SUN_RADIUS)
    disk = np.zeros((HEIGHT, WIDTH), np.float32)
    disk[row - 2:row + 3] = covered.reshape(5, fine, WIDTH, fine).mean(axis=(1, 3))
    return disk / np.float32(sphere_integral(disk[:, :, None])[0])


def _preetham(cos_zenith: np.ndarray, cos_gamma: np.ndarray, elevation: float) -> np.ndarray:
    """Linear Rec. 709 radiance (klx/sr), (h, W, 3), from the cosines of the rows' zenith angles (h,) and of the angles
    to the sun (h, W)."""
    t, sun_zenith = TURBIDITY, math.pi / 2 - elevation
    gamma = np.arccos(np.clip(cos_gamma, -1, 1))
    low = 1 / np.maximum(cos_zenith, 0.01)[:, None].astype(np.float32)

    def perez(a: float, b: float, c: float, d: float, e: float) -> np.ndarray:
        sky_part = (1 + a * np.exp(b * low)) * (1 + c * np.exp(d * gamma) + e * cos_gamma * cos_gamma)
        at_zenith = (1 + a * math.exp(b)) * (1 + c * math.exp(d * sun_zenith) + e * math.cos(sun_zenith) ** 2)
        return sky_part / np.float32(at_zenith)

    chi = (4 / 9 - t / 120) * (math.pi - 2 * sun_zenith)
    luminance = (4.0453 * t - 4.9710) * math.tan(chi) - 0.2155 * t + 2.4192
    angles = np.array([sun_zenith**3, sun_zenith**2, sun_zenith, 1])
    turbidities = np.array([t * t, t, 1])
    zenith_x = turbidities @ np.array([[0.00166, -0.00375, 0.00209, 0], [-0.02903, 0.06377, -0.03202, 0.00394],
                                       [0.11693, -0.21196, 0.06052, 0.25886]]) @ angles
    zenith_y = turbidities @ np.array([[0.00275, -0.00610, 0.00317, 0], [-0.04214, 0.08970, -0.04153, 0.00516],
                                       [0.15346, -0.26756, 0.06670, 0.26688]]) @ angles
    big_y = luminance * perez(0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                              -0.0670 * t + 0.3703)
    x = zenith_x * perez(-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
                         -0.0033 * t + 0.0452)
    y = zenith_y * perez(-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
                         -0.0109 * t + 0.0529)
    xyz = np.stack([x / y * big_y, big_y, (1 - x - y) / y * big_y], axis=-1)
    to_rec709 = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]], np.float32)
    return np.maximum(xyz.astype(np.float32) @ to_rec709.T, 0)


def _smoothstep(t: np.ndarray) -> np.ndarray:
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


PRESETS: dict[str, Callable[[], np.ndarray]] = {"studio": studio, "sky": sky, "furnace": furnace}
