"""The `oidn` denoiser: Intel Open Image Denoise on the CPU, an optional dependency."""

from __future__ import annotations

import moderngl
import numpy as np

from ...errors import UsageError
from ...gpu.context import Context
from ...gpu.float_texture import read_texels
from ...image.neighbours import box
from .denoiser import NoisyFilm

_LEAST = 16
"""Pixels along each side that the network needs: where it sees fewer, the picture gets darker."""


class OpenImageDenoise:
    """A network trained on path-traced pictures (Afra 2025). Its inputs include albedo and normals of the first hits.

    Raises UsageError, with the fix, if pyoidn is not installed or does not run.
    """

    def __init__(self, context: Context) -> None:
        try:
            import pyoidn
        except (ImportError, OSError) as error:
            raise UsageError("--denoise oidn needs Open Image Denoise: pip install 'pbr-viewer[oidn]', or take "
                             f"--denoise fast ({' '.join(str(error).split())})") from error
        self._denoise = pyoidn.denoise
        self._context = context
        self._texture: moderngl.Texture | None = None

    def filter(self, film: NoisyFilm, guide: np.ndarray | None = None) -> moderngl.Texture:
        """As `Denoiser.filter`. There is no guide."""
        self._context.make_current()
        emission = read_texels(film.emission) / np.maximum(read_texels(film.sum)[..., 3:], 1)
        radiance, albedo, normal = (read_texels(texture) for texture in (film.radiance, film.albedo, film.normal))
        denoised = self.filter_arrays(radiance, albedo, normal, emission)
        if self._texture is None or self._texture.size != film.radiance.size:
            self.release()
            self._texture = self._context.gl.texture(film.radiance.size, 4, dtype="f4")
        self._texture.write(denoised)
        return self._texture

    def filter_arrays(self, radiance: np.ndarray, albedo: np.ndarray, normal: np.ndarray,
                      emission: np.ndarray) -> np.ndarray:
        """The same for float32 arrays (H, W, 4). `albedo` and `normal` are sums over the hits, whose number is
        albedo.w.

        `emission`, (H, W, 4), is the mean emission of the first hits, which the network would spread to neighbours; w
        is the share of collisions in media. About these alpha has noise, too, and samples may have missed the medium
        by chance, so that pixels near by are filtered as well, and alpha with them.
        """
        near_media = box(emission[..., 3:]) > 0
        emission = emission[..., :3]
        hits = albedo[..., 3:]
        features = [np.divide(total[..., :3], hits, out=np.zeros_like(total[..., :3]), where=hits > 0)
                    for total in (albedo, normal)]
        features[0] = np.clip(features[0], 0, 1)
        color = np.ascontiguousarray(radiance[..., :3])
        is_unchanged = ((hits == 0) & ~near_media) | ~np.isfinite(color)
        rest = np.where(np.isfinite(color), np.maximum(color - emission, 0), 0)
        height, width = color.shape[:2]
        beyond = (0, max(_LEAST - height, 0)), (0, max(_LEAST - width, 0)), (0, 0)
        inputs = [np.pad(values, beyond, mode="edge") for values in (rest, *features)]
        denoised = self._denoise(*inputs, hdr=True)[:height, :width] + emission
        alpha = radiance[..., 3:]
        if (near_media & (alpha < 1)).any():
            inputs[0] = np.pad(np.repeat(alpha, 3, axis=-1), beyond, mode="edge")
            without_noise = self._denoise(*inputs, hdr=True)[:height, :width].mean(axis=-1, keepdims=True)
            alpha = np.where(near_media, np.clip(without_noise, 0, 1), alpha)
        return np.concatenate([np.where(is_unchanged, color, denoised), alpha], axis=-1)

    def release(self) -> None:
        if self._texture is not None:
            self._texture.release()
            self._texture = None
