"""A picture as a render returns it: linear radiance, displayed values, layers and statistics."""

from __future__ import annotations

import io
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.atomic import atomic_write
from ..base.expect import expect, expect_path
from ..base.quiet import without_warnings
from ..base.utf8_name import utf8_name
from ..errors import InputError, OutputError, UsageError
from ..scene.color import linear_to_srgb, srgb_to_linear
from .exr import write_exr

# zlib level 1 takes 7-11 ms at 512x512 and 20-36 ms at 1280x720 on one slow core. Pillow's default, level 6, takes
# three times as long for files that are 8 % smaller.
_PNG = {"format": "PNG", "compress_level": 1}
_ENCODERS: dict[str, dict[str, Any]] = {
    ".png": _PNG,
    ".jpg": {"format": "JPEG", "quality": 95, "subsampling": 0},
    ".jpeg": {"format": "JPEG", "quality": 95, "subsampling": 0},
    ".webp": {"format": "WEBP", "lossless": True, "quality": 0, "exact": True},
}
LINEAR_WRITABLE = (".exr", ".npz")
"""What is written as linear light, with layers."""
WRITABLE = (*_ENCODERS, *LINEAR_WRITABLE)
LINEAR_FORMATS = (".exr", ".hdr")
_MAX_PIXELS = 1 << 27
_OF_LAYERS = (np.float32, np.float64, np.uint32)
_DECODED = srgb_to_linear(np.arange(256) / 255).astype(np.float32)


@dataclass(frozen=True, eq=False)
class Image:
    """A picture as linear radiance and as displayed values. Row 0 is the top.

    `linear` (H, W, 4) float32 is Rec. 709 radiance with associated (premultiplied) alpha, as in EXR files. `srgb`
    (H, W, 4) uint8 is what a screen shows, after exposure and tone map, with straight alpha, as in PNG files.
    `stats` has the plan and the times of a render, named as in `--stats`: seconds in all (`wall_s`), and those of
    preparing what was not drawn before (`prepare_s`). `layers` are further numbers of each pixel, such as "albedo" and
    "depth" (docs/layers.md): (H, W) or (H, W, 2 or 3), float32, float64 or uint32. `attributes` are texts to store in
    the picture's file, for example that it was denoised. `numpy.asarray(image)` is `linear`.
    """

    linear: np.ndarray
    srgb: np.ndarray
    stats: dict[str, object] = field(default_factory=dict)
    layers: dict[str, np.ndarray] = field(default_factory=dict)
    attributes: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, dtype in (("linear", np.float32), ("srgb", np.uint8)):
            array = getattr(self, name)
            expect(array, np.ndarray, f"Image.{name}", "an array (Image.from_linear and from_srgb make one of others)")
            if array.dtype != dtype or array.ndim != 3 or array.shape[2] != 4:
                raise UsageError(f"Image.{name} is {array.shape} {array.dtype}, not (H, W, 4) {np.dtype(dtype)}")
        if self.linear.shape != self.srgb.shape:
            raise UsageError(f"Image.linear is {self.linear.shape} and srgb {self.srgb.shape}")
        expect(self.layers, dict, "Image.layers", "a dict of arrays")
        for name, layer in self.layers.items():
            expect(layer, np.ndarray, f"Image.layers[{name!r}]", "an array")
            pixels = self.srgb.shape[:2]
            if layer.dtype not in _OF_LAYERS or layer.shape not in (pixels, (*pixels, 2), (*pixels, 3)):
                raise UsageError(f"Image.layers[{name!r}] is {layer.shape} {layer.dtype}, not (H, W) or "
                                 "(H, W, 2 or 3), float32, float64 or uint32")

    @classmethod
    def from_srgb(cls, pixels: ArrayLike) -> Image:
        """From displayed values, (H, W, 3 or 4) uint8 with straight alpha; `linear` is their exact sRGB decoding.

        Raises UsageError for what is not whole numbers from 0 to 255, as does `from_linear` for what is not numbers.
        """
        # `linear` is computed on first access (__getattr__): it takes as long as a PNG, and few callers need it.
        image = cls.__new__(cls)
        vars(image).update(srgb=_with_alpha(pixels, np.uint8, 255), stats={}, layers={}, attributes={})
        return image

    def __getattr__(self, name: str) -> np.ndarray:
        if name != "linear":
            raise AttributeError(f"'Image' object has no attribute {name!r}; its pixels are in `linear` (radiance) and "
                                 "`srgb` (as displayed)", name=name, obj=self)
        linear = _DECODED[self.srgb]
        linear[..., 3] = self.srgb[..., 3] / np.float32(255)
        linear[..., :3] *= linear[..., 3:]
        vars(self)["linear"] = linear
        return linear

    @classmethod
    def from_linear(cls, pixels: ArrayLike) -> Image:
        """From radiance, (H, W, 3 or 4) with associated alpha. `srgb` is the radiance clamped to [0, 1], without a
        tone map."""
        linear = _with_alpha(pixels, np.float32, 1)
        finite = np.nan_to_num(linear, nan=0.0)
        alpha = np.clip(finite[..., 3:], 0, 1)
        straight = np.clip(finite[..., :3] / np.where(alpha > 0, alpha, 1), 0, 1)
        displayed = np.concatenate([linear_to_srgb(straight), alpha], axis=-1)
        return cls(linear, (displayed * 255 + 0.5).astype(np.uint8))

    @classmethod
    def open(cls, path: str | PathLike[str]) -> Image:
        """Reads a PNG, JPEG or WebP file (displayed values) or an EXR or HDR file (linear), and derives `linear` or
        `srgb` from it.

        Raises InputError for a file that is missing, broken, of another format, or larger than 2**27 pixels.
        """
        expect_path(path, "path")
        file = Path(path)
        if not file.is_file():
            raise InputError(file, "", "is a folder, not a picture" if file.is_dir() else "no such file")
        if file.suffix.lower() in LINEAR_FORMATS:
            return cls.from_linear(_read_linear(file))
        return cls.from_srgb(_read_displayed(file))

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) in pixels."""
        height, width = self.srgb.shape[:2]
        return width, height

    def save(self, path: str | PathLike[str]) -> None:
        """Writes a .png, .jpg, .jpeg or .webp file (displayed values), or an .exr or .npz file (linear float32, with
        the layers). The file is written whole or not at all.

        In an .npz, `linear` is the array "rgba", and each layer one of its own name. EXR and PNG hold the `attributes`
        too. JPEG has no alpha, so the picture is composited over white, as a web page would show it. WebP is lossless.
        Raises OutputError if the file cannot be written.
        """
        expect_path(path, "path")
        suffix = Path(path).suffix.lower()
        if suffix not in WRITABLE:
            raise OutputError(f"{fspath(path)}: cannot write {suffix or 'a file without extension'}; "
                              f"choose one of {', '.join(WRITABLE)}")
        with atomic_write(path) as temporary:
            if suffix == ".exr":
                write_exr(temporary, self.linear, self.layers, self.attributes)
            elif suffix == ".npz":
                with open(temporary, "wb") as file:  # numpy would add an ending to a name
                    arrays: dict[str, Any] = {"rgba": self.linear, **self.layers}
                    np.savez_compressed(file, **arrays)
            else:
                temporary.write_bytes(self._encode(**_ENCODERS[suffix]))

    def over(self, background: float) -> np.ndarray:
        """The displayed picture over a grey background in [0, 1]: (H, W, 3) float32 in [0, 1]."""
        displayed = self.srgb / np.float32(255)
        return background + (displayed[..., :3] - np.float32(background)) * displayed[..., 3:]

    def _encode(self, **options: Any) -> bytes:
        from PIL import Image as Pillow

        pixels = self.srgb
        if options["format"] == "JPEG":
            pixels = (self.over(1) * 255 + 0.5).astype(np.uint8)
        if options["format"] == "PNG" and self.attributes:
            from PIL.PngImagePlugin import PngInfo

            options["pnginfo"] = info = PngInfo()
            for name, value in self.attributes.items():
                info.add_text(name, value)
        encoded = io.BytesIO()
        try:
            Pillow.fromarray(pixels).save(encoded, **options)
        except ValueError as error:  # a picture larger than the format allows
            raise OSError(str(error)) from error
        return encoded.getvalue()

    def _repr_png_(self) -> bytes:
        return self._encode(**_PNG)

    def __array__(self, dtype: np.dtype | None = None, copy: bool | None = None) -> np.ndarray:
        if dtype is None or dtype == self.linear.dtype:
            return self.linear.copy() if copy else self.linear
        return self.linear.astype(dtype)

    def __repr__(self) -> str:
        return f"Image({self.size[0]}x{self.size[1]})"


def _with_alpha(values: ArrayLike, dtype: type, opaque: float) -> np.ndarray:
    """(H, W, 3 or 4) to contiguous (H, W, 4) of `dtype`; pixels without alpha become opaque."""
    try:
        pixels = np.asarray(values)
    except ValueError:  # lists of different lengths
        pixels = np.array(None)
    is_number = pixels.dtype.kind in ("iu" if dtype is np.uint8 else "biuf")
    if pixels.ndim != 3 or pixels.shape[2] not in (3, 4) or not pixels.size or not is_number:
        raise UsageError(f"pixels are {pixels.shape} {pixels.dtype}, not (H, W, 3 or 4) {np.dtype(dtype)}")
    if dtype is np.uint8 and pixels.dtype != np.uint8 and not (pixels.min() >= 0 and pixels.max() <= 255):
        raise UsageError(f"pixels are from {pixels.min()} to {pixels.max()}, not from 0 to 255")
    pixels = pixels.astype(dtype, copy=False)
    if pixels.shape[2] == 3:
        pixels = np.concatenate([pixels, np.full_like(pixels[..., :1], opaque)], axis=-1)
    return np.ascontiguousarray(pixels)


def _read_displayed(file: Path) -> np.ndarray:
    from PIL import Image as Pillow

    try:
        # Pillow warns of pictures that are large, though not too large.
        with without_warnings(), Pillow.open(file, formats=("PNG", "JPEG", "WEBP")) as picture:
            _check_size(file, *picture.size)
            if picture.mode.startswith("I"):  # 16-bit grey, which Pillow would clamp to 255
                grey = (np.asarray(picture).astype(np.uint32) + 128) // 257
                return np.repeat(grey.astype(np.uint8)[..., None], 3, axis=-1)
            return np.asarray(picture.convert("RGBA"))
    except Pillow.UnidentifiedImageError:
        raise InputError(file, "", "is not a picture in a supported format (PNG, JPEG, WebP, EXR, HDR)") from None
    except (OSError, SyntaxError, ValueError, Pillow.DecompressionBombError) as error:
        raise InputError(file, "", f"cannot be read: {error}") from error


def _read_linear(file: Path) -> np.ndarray:
    import OpenImageIO as oiio

    with utf8_name(file) as name:
        source = oiio.ImageInput.open(name)
    if source is None:
        oiio.geterror()  # cleared; its words are the library's
        raise InputError(file, "", "cannot be read: its beginning is broken, or is not that of an EXR or HDR file")
    spec = source.spec()
    _check_size(file, spec.width, spec.height)
    pixels = source.read_image(0, 0, 0, spec.nchannels, "float")
    source.geterror()
    source.close()
    if pixels is None:
        raise InputError(file, "", "cannot be read: its pixels are broken, or the file ends before the last of them")
    names = [name.upper() for name in spec.channelnames]
    wanted = ["R", "G", "B"] if "R" in names else ["Y"] * 3
    wanted += ["A"] * ("A" in names)
    missing = sorted(set(wanted) - set(names))
    if missing:
        raise InputError(file, "channels", f"no {', '.join(missing)} among {', '.join(spec.channelnames)}")
    return pixels[:, :, [names.index(name) for name in wanted]]


def _check_size(file: Path, width: int, height: int) -> None:
    if width * height > _MAX_PIXELS:
        raise InputError(file, "", f"{width}x{height} is more than {_MAX_PIXELS} pixels")
