"""Makes the files of `curves`: a tuft of fur, a lock of hair, yarns knitted and woven: python assets/make_curves.py"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

from viewer.scene.weave import WEAVES, Weave, Yarn
from viewer.scene.yarn.woven import weave_yarns

FOLDER = Path(__file__).parent / "curves"
GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))


def disk(count: int) -> np.ndarray:
    """Points spread evenly over the unit disk (Vogel 1979), (count, 2)."""
    k = np.arange(count)
    return (np.sqrt((k + 0.5) / count) * np.stack([np.cos(GOLDEN_ANGLE * k), np.sin(GOLDEN_ANGLE * k)])).T


def strands(x: np.ndarray, y: np.ndarray, z: np.ndarray, radius: np.ndarray) -> np.ndarray:
    return np.stack(np.broadcast_arrays(x, y, z, radius), axis=-1)


def fur() -> np.ndarray:
    """A tuft 18 mm high, whose strands part outwards, lean to +X and taper; (440, 6, 4): x, y, z, radius in metres."""
    count = 440
    rng = np.random.default_rng(1)
    root = disk(count)[:, None] * 0.0065
    t = np.linspace(0, 1, 6)[None]
    length = rng.uniform(0.016, 0.024, (count, 1))
    phase, strength = rng.uniform(0, 2 * np.pi, (count, 1)), rng.uniform(0.05, 0.2, (count, 1))
    spread = 0.7 * t + 0.6 * t**2
    x = root[..., 0] * (1 + spread) + length * (0.2 * t**2 + strength * t**1.5 * np.cos(phase))
    z = root[..., 1] * (1 + spread) + length * strength * t**1.5 * np.sin(phase)
    return strands(x, length * (t - 0.25 * t**3), z, 1.3e-4 * (1 - 0.85 * t**2))


def lock() -> np.ndarray:
    """A lock 150 mm long, which hangs, curls ever tighter and comes together at the tip; (220, 24, 4), as `fur`."""
    count = 220
    rng = np.random.default_rng(2)
    across = disk(count)[:, None] * 0.011
    t = np.linspace(0, 1, 24)[None] * rng.uniform(0.88, 1, (count, 1))
    turn = 2 * np.pi * (0.4 * t + 1.5 * t**2)
    swing = 0.014 * t**0.8
    width = 1 - 0.75 * t**1.5
    phase, strength = rng.uniform(0, 2 * np.pi, (2, count, 1)), rng.uniform(0, 0.002, (count, 1))
    x, z = (width * across[..., k] + strength * t * np.sin(14 * t + phase[k]) for k in (0, 1))
    return strands(x + swing * np.sin(turn), -0.15 * t, z + swing * (np.cos(turn) - 1), 2e-4 * (1 - 0.6 * t**4))


def knit() -> np.ndarray:
    """Six rows of eight plain stitches, each 5 mm wide; (6, 153, 4), as `fur`.

    A row is (t + a sin 2t, h cos t, d cos 2t). No yarn of the radius here comes through another. Its points are two
    radii apart, which is how a file without radii says them.
    """
    t = np.linspace(0, 16 * np.pi, 153)[None]
    row = np.arange(6)[:, None] - 2.5
    unit = 5e-3 / (2 * np.pi)
    return strands(unit * (t - 8 * np.pi + 1.4 * np.sin(2 * t)), unit * (4.5 * row + 4 * np.cos(t)),
                   unit * 1.3 * np.cos(2 * t) + 0 * row, np.array(0.66 * unit))


def woven() -> np.ndarray:
    """A twill of blue warp and light weft yarns, 24 mm wide; (24, 73, 7): as `fur`, and the colour."""
    warp, weft = Yarn((0.04, 0.09, 0.3)), Yarn((0.7, 0.65, 0.55))
    yarns = weave_yarns(Weave(WEAVES["twill"].draft, warp, weft, (500.0, 500.0)), (3, 3))
    return np.column_stack([yarns.points, yarns.radii, yarns.colors]).reshape(24, 73, 7)


def curves_text(points: np.ndarray) -> bytes:
    """Mitsuba's text: a point a line, and a blank line between strands."""
    lines = ("".join(f"{x:.5f} {y:.5f} {z:.5f} {radius:.6f}\n" for x, y, z, radius in strand) for strand in points)
    return "\n".join(lines).encode()


def hair_bytes(points: np.ndarray) -> bytes:
    """Cem Yuksel's binary file: strands of one number of segments, with points (bit 1), thicknesses (bit 2) and, where
    `points` has them, colours (bit 4)."""
    count, length, columns = points.shape
    arrays = 2 | 4 | 16 * (columns == 7)
    head = struct.pack("<4s4I5f88s", b"HAIR", count, count * length, arrays, length - 1, 0.0, 0.0, 1.0, 1.0, 1.0, b"")
    parts = points[..., :3], 2 * points[..., 3], points[..., 4:]
    return head + b"".join(part.astype("<f4").tobytes() for part in parts)


def bcc_bytes(points: np.ndarray) -> bytes:
    """Cem Yuksel's other binary file: open Catmull-Rom splines without radii; Y, axis 1, is up."""
    count, length, _ = points.shape
    head = struct.pack("<4s2sBBQQ40s", b"BCC\x44", b"C0", 3, 1, count, count * length, b"")
    return head + b"".join(struct.pack("<i", length) + strand[:, :3].astype("<f4").tobytes() for strand in points)


FILES: dict[str, tuple[Callable[[], np.ndarray], Callable[[np.ndarray], bytes]]] = {
    "fur.curves": (fur, curves_text), "lock.hair": (lock, hair_bytes), "knit.bcc": (knit, bcc_bytes),
    "woven.hair": (woven, hair_bytes)}

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, (make, written) in FILES.items():
        (FOLDER / name).write_bytes(written(make()))
