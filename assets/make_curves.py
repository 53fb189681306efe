"""Makes `curves/fur.curves`, a tuft of fur, and `curves/lock.hair`, a lock of hair: python assets/make_curves.py"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np

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


def curves_text(points: np.ndarray) -> bytes:
    """Mitsuba's text: a point a line, and a blank line between strands."""
    lines = ("".join(f"{x:.5f} {y:.5f} {z:.5f} {radius:.6f}\n" for x, y, z, radius in strand) for strand in points)
    return "\n".join(lines).encode()


def hair_bytes(points: np.ndarray) -> bytes:
    """Cem Yuksel's binary file: strands of one number of segments, with points (bit 1) and thicknesses (bit 2)."""
    count, length, _ = points.shape
    head = struct.pack("<4s4I5f88s", b"HAIR", count, count * length, 2 | 4, length - 1, 0.0, 0.0, 1.0, 1.0, 1.0, b"")
    return head + points[..., :3].astype("<f4").tobytes() + (2 * points[..., 3]).astype("<f4").tobytes()


FILES: dict[str, tuple[Callable[[], np.ndarray], Callable[[np.ndarray], bytes]]] = {
    "fur.curves": (fur, curves_text), "lock.hair": (lock, hair_bytes)}

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name, (make, written) in FILES.items():
        (FOLDER / name).write_bytes(written(make()))
