"""Films: pictures one after the other, in one file that is written whole or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import atomic_write
from ..errors import UsageError
from .image import Image

FILM_FORMATS = (".mp4", ".webp", ".gif", ".apng")
_PILLOW: dict[str, dict[str, Any]] = {
    ".webp": {"format": "WEBP", "quality": 90, "method": 4},
    ".gif": {"format": "GIF", "disposal": 2},
    ".apng": {"format": "PNG", "compress_level": 1},
}
_BT709, _SRGB = 1, 13  # matrix and primaries, and the transfer curve, as H.264 numbers them (ITU-T H.273)


def check_film(path: Path, size: tuple[int, int]) -> None:
    """Raises UsageError for an .mp4 of odd width or height, or if what writes it is not installed."""
    if path.suffix.lower() != ".mp4":
        return
    if size[0] % 2 or size[1] % 2:
        raise UsageError(f"-o {path}: an .mp4 needs an even width and height, not {size[0]}x{size[1]}")
    try:
        import av  # noqa: F401  to see whether it is there
    except ImportError as error:
        raise UsageError(f"-o {path}: an .mp4 needs PyAV: pip install 'pbr-viewer[film]'") from error


def write_film(path: Path, frames: Iterator[Image], fps: float) -> int:
    """Write `frames`, one at least, as they come; returns how many there were. The film repeats without end, but for
    .mp4, in which players decide.

    .webp and .apng keep alpha; .gif has 256 colours a frame, and is transparent or not; .mp4 lies over white. Times are
    rounded so that the film does not run away: to milliseconds, in a .gif to hundredths of a second. All formats but
    .mp4 are written when the last frame has come, and hold all frames in memory until then. Raises OutputError if the
    file cannot be written.
    """
    counted = _Counted(frames)
    with atomic_write(path) as temporary:
        (_write_mp4 if path.suffix.lower() == ".mp4" else _write_pillow)(temporary, counted, fps)
    return counted.count


class _Counted:
    def __init__(self, frames: Iterator[Image]) -> None:
        self._frames, self.count = frames, 0

    def __iter__(self) -> Iterator[Image]:
        for frame in self._frames:
            self.count += 1
            yield frame


def _write_pillow(path: Path, frames: _Counted, fps: float) -> None:
    from PIL import Image as Pillow

    options = _PILLOW[path.suffix.lower()]
    pictures = [Pillow.fromarray(f.srgb if (f.srgb[..., 3] < 255).any() else f.srgb[..., :3]) for f in frames]
    step = 10 if options["format"] == "GIF" else 1  # milliseconds
    ends = [step * round(1000 * k / fps / step) for k in range(len(pictures) + 1)]
    durations = [max(end - begin, step) for begin, end in pairwise(ends)]
    pictures[0].save(path, save_all=True, append_images=pictures[1:], loop=0, duration=durations, **options)


def _write_mp4(path: Path, frames: _Counted, fps: float) -> None:
    from fractions import Fraction

    import av

    with av.open(str(path), "w", format="mp4", options={"movflags": "faststart"}) as container:
        stream = container.add_stream("libx264", rate=Fraction(fps).limit_denominator(1001), options={"crf": "18"})
        stream.pix_fmt = "yuv420p"
        stream.codec_context.colorspace = stream.codec_context.color_primaries = _BT709
        stream.codec_context.color_trc = _SRGB
        for frame in frames:
            if frames.count == 1:
                stream.width, stream.height = frame.size
            pixels = (frame.over(1) * 255 + 0.5).astype(np.uint8)
            picture = av.VideoFrame.from_ndarray(pixels, format="rgb24")
            container.mux(stream.encode(picture.reformat(format="yuv420p", dst_colorspace="ITU709")))
        container.mux(stream.encode())
