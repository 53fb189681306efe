"""The layers of a picture beside its light, as both renderers have them together (docs/layers.md).

What surface a pixel shows at its centre is found by the raster in all modes. In mode path, albedo and normal are means
over the samples of a pixel instead, as denoisers want them, and variance and samples are the tracer's own.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from ..image.image import Image
from ..plan.media import has_media
from ..plan.model import LAYERS_LEFT_OUT
from ..raster.layers import Following
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.frame import Frame
from ..scene.scene import Scene
from ..settings import PATH_LAYERS, Settings

_MEANS = ("albedo", "normal", *PATH_LAYERS)


def traced_layers(names: Collection[str], scene: Scene, settings: Settings) -> tuple[str, ...]:
    """What `Tracer.begin` is asked for where a picture of mode path shall have the layers `names`."""
    means = tuple(name for name in names if name in _MEANS)
    return (*means, "distance") if "depth" in names and has_media(scene, settings) else means


def with_layers(image: Image, renderer: Renderer, scene: Scene, camera: Camera, settings: Settings,
                names: Collection[str], following: Following | None) -> Image:
    """The picture with the layers `names` of `viewer.settings.LAYERS`, in their order. A traced picture has those of
    `traced_layers` already.

    `following` are scene and camera at the next time, for motion. Raises as `Renderer.layers`.
    """
    found = dict(image.layers)
    missing = tuple(name for name in names if name not in found)
    if missing:
        found |= renderer.layers(scene, camera, settings, image.size, missing, following)
    if "distance" in found and "depth" in found:
        collided = found["distance"] * _cosines(scene, camera, image.size)
        found["depth"] = np.where(np.isfinite(found["depth"]), found["depth"], collided).astype(np.float32)
    plan = image.stats.get("plan")
    stats = image.stats | ({"plan": _explained(plan, names)} if isinstance(plan, dict) and missing else {})
    return replace(image, layers={name: found[name] for name in names}, stats=stats)


def _cosines(scene: Scene, camera: Camera, size: tuple[int, int]) -> np.ndarray:
    """Of the angle between the view axis and the ray through each pixel's centre, (H, W); 1 for an orthographic camera,
    whose distances are measured along the axis."""
    x, y = ((2 * np.arange(count) + 1) / count - 1 for count in size)
    points = np.stack(np.broadcast_arrays(x[None, :], -y[:, None], 1.0), axis=-1)
    return 1 / np.linalg.norm(points @ Frame(scene, camera, size).ray.T, axis=-1)


def _explained(plan: dict[str, object], names: Collection[str]) -> dict[str, object]:
    """The plan of a picture for JSON, with the pass for layers."""
    passes, left_out = plan["passes"], plan["left_out"]
    assert isinstance(passes, list) and isinstance(left_out, list)
    return plan | {"passes": [*passes[:-1], "surface layers", passes[-1]], "layers": list(names),
                   "left_out": [line for line in left_out if line != LAYERS_LEFT_OUT]}
