"""The truth that methods of the raster are held against: path traced, in two halves of different seeds."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from viewer.base.digest import digest
from viewer.errors import InputError
from viewer.gpu.context import Context
from viewer.measure.compare.relmse import Halves, relmse
from viewer.measure.report.errors import relmse_floor, trimmed_floor, trimmed_relmse
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

_WHOLE = 0.999
"""Alpha of a pixel that the model covers wholly: at its outline methods differ in their edges alone."""


@dataclass(frozen=True, eq=False)
class Truth:
    """`halves` are radiance, (H, W, 3) each; `mask` (H, W) bool the pixels that count.

    `direct` is the relMSE of the path tracer with one bounce: the share of indirect light, with the noise subtracted.
    """

    halves: Halves
    mask: np.ndarray
    direct: float

    @classmethod
    def of(cls, context: Context, scene: Scene, camera: Camera, size: tuple[int, int], spp: int,
           folder: Path | None = None) -> Truth:
        """Traced, or as it was kept in `folder`, which is made; `spp` counts both halves.

        Raises InputError where the model fills no pixel.
        """
        name = f"{digest(scene, camera, size, spp)}.npz"
        if folder is not None and (folder / name).is_file():
            with np.load(folder / name) as kept:
                pictures = [kept[key] for key in ("first", "second", "direct")]
        else:
            pictures = _trace(context, scene, camera, size, spp // 2)
            if folder is not None:
                folder.mkdir(parents=True, exist_ok=True)
                np.savez_compressed(folder / name, **dict(zip(("first", "second", "direct"), pictures)))
        first, second, direct = pictures
        mask = (first[..., 3] + second[..., 3]) / 2 > _WHOLE
        if not mask.any():
            raise InputError(scene.name, "", "it fills no pixel")
        halves = Halves(first[..., :3], second[..., :3])
        noise = 3 * relmse_floor(halves, mask)  # of the mean, and of a picture of half its samples
        return cls(halves, mask, relmse(direct[mask][:, :3], halves.mean[mask]) - noise)

    @property
    def floor(self) -> float:
        return relmse_floor(self.halves, self.mask)

    @property
    def trimmed_floor(self) -> float:
        return trimmed_floor(self.halves, self.mask)

    def error(self, picture: np.ndarray) -> tuple[float, float]:
        """relMSE and trimmed relMSE of radiance (H, W, 4), the reference's noise taken off both."""
        truth = self.halves.mean
        plain = relmse(np.nan_to_num(picture[self.mask][:, :3], nan=0.0, posinf=0.0, neginf=0.0), truth[self.mask])
        return plain - self.floor, trimmed_relmse(picture, truth, self.mask) - self.trimmed_floor


def _trace(context: Context, scene: Scene, camera: Camera, size: tuple[int, int], spp: int) -> list[np.ndarray]:
    """Both halves, and one with light that was reflected once; (H, W, 4) float32 each."""
    tracer = Tracer(context)
    try:
        return [tracer.render(scene, camera, Settings(mode="path", background="none", spp=spp, **more), size).linear
                for more in ({"seed": 1}, {"seed": 2}, {"seed": 3, "bounces": 1})]
    finally:
        tracer.release()
