"""The one shot that every program takes: which model, which light, from where."""

from __future__ import annotations

import math
from pathlib import Path

FOV_Y = 40.0
AZIMUTH, ELEVATION = 35.0, 15.0
STEP = 7.0
"""Degrees of azimuth between two frames that follow each other."""
FILL = 0.8
"""The camera's distance, in units of the one at which the sphere about the bounding box fits the view."""

REPOSITORY = Path(__file__).resolve().parent.parent
_CORPUS = REPOSITORY.parent / "shared" / "corpus"


def default_model() -> str:
    """DamagedHelmet, where the corpus of real data lies beside the checkout; else the project's own model."""
    helmet = _CORPUS / "models/DamagedHelmet/DamagedHelmet.gltf"
    return str(helmet if helmet.is_file() else REPOSITORY / "assets/demo.glb")


def default_environment() -> str:
    """A 1k HDR of a studio from the corpus; else the name of the viewer's own."""
    studio = _CORPUS / "environments/studio_small_05_1k.hdr"
    return str(studio) if studio.is_file() else "studio"


def inputs(model: str, environment: str) -> tuple[str, str]:
    """Both as a process started elsewhere finds them; raises FileNotFoundError. A name of an environment may pass."""
    if not Path(model).is_file():
        raise FileNotFoundError(f"{model}: no such file")
    known = Path(environment).is_file()
    return str(Path(model).resolve()), str(Path(environment).resolve()) if known else environment


def eye(bounds, frame: int = 0) -> tuple[float, float, float]:
    """Where the camera stands, in world units, for the frame-th picture; it looks at the middle of `bounds` (2, 3)."""
    low, high = bounds
    center = [(a + b) / 2 for a, b in zip(low, high)]
    azimuth, elevation = math.radians(AZIMUTH + STEP * frame), math.radians(ELEVATION)
    away = FILL * math.dist(low, high) / 2 / math.sin(math.radians(FOV_Y / 2))
    return (center[0] + away * math.cos(elevation) * math.sin(azimuth), center[1] + away * math.sin(elevation),
            center[2] + away * math.cos(elevation) * math.cos(azimuth))
