"""Environments by name or from image files: Radiance HDR and OpenEXR (linear), PNG and JPEG (decoded from sRGB)."""

from __future__ import annotations

import hashlib
import tempfile
import weakref
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.utf8_name import utf8_name
from ..errors import InputError
from .chromaticities import to_rec_709, xyz_to_rec_709
from .environment import MAX_RADIANCE, Environment
from .environment_presets import PRESETS, make_preset
from .equirect import texel_solid_angles
from .files import read_file
from .map_warnings import map_warnings
from .radiance_hdr import decoded, plain_pixels, read_hdr_header

FORMATS = {".hdr": "hdr", ".exr": "openexr", ".png": "png", ".jpg": "jpeg", ".jpeg": "jpeg"}
MAX_WIDTH = 4096  # wider maps are averaged down to it: 11 texels per degree, 100 MB of radiance
MAX_TEXELS = 1 << 29  # of a file: a map of 32768 x 16384, which takes seconds to decode
HALF_MAX = 65504.0
BAND = 1 << 20  # texels decoded per step
_CODE = ("environment_files.py", "radiance_hdr.py", "chromaticities.py")


def load_environment(spec: str | Path | None) -> Environment | None:
    """An environment from a file, or a built-in one: 'studio', 'sky' or 'furnace'. None and 'none' return None.

    A name that is also the name of a file means the built-in environment; write ./studio for the file. The file is read
    at once to compute its digest, but it is decoded only when `radiance` is accessed. Maps wider than 4096 texels are
    then reduced by a whole factor, by means weighted with solid angle. The map of an EXR is its display window. Colours
    of other primaries (`chromaticities` of an EXR, PRIMARIES of Radiance) are converted to Rec. 709 with Bradford's
    adaptation of white, and XYZE of Radiance without adaptation. Negative values (colours outside Rec. 709)
    become 0. Infinite values, which overflowed a half float, become 65504. Grey becomes RGB. Alpha and Radiance's
    EXPOSURE are ignored, as other viewers do.

    Raises InputError, at once or when `radiance` is first accessed, for a file that is not a complete image of its
    format, contains NaN or values over 1e12, or declares more than 2^29 texels.
    """
    if spec is None or spec == "none":
        return None
    if spec in PRESETS:
        return make_preset(str(spec))
    path = Path(spec)
    if path.suffix.lower() not in FORMATS:
        problem = ("it is a folder" if path.is_dir() else "no such file" if not path.is_file()
                   else f"{path.suffix} files cannot be read" if path.suffix else "its name has no ending")
        raise InputError(path, "", f"is not an environment: {problem}; use a {', '.join(FORMATS)} file, or one of "
                                   f"none, {', '.join(PRESETS)}")
    digest = _file_digest(path)
    return Environment(path.stem, _RadianceFile(path), digest=digest, warnings=tuple(map_warnings(path)))


def environment_spec(environment: Environment | None) -> str | None:
    """What `load_environment` makes this environment of, up to rotation and intensity; None for that of an array."""
    if environment is None:
        return "none"
    if isinstance(environment.source, _RadianceFile):
        path = environment.source.path
        return f"./{path}" if str(path) in PRESETS else str(path)
    return environment.name if environment.source is PRESETS.get(environment.name) else None


class _RadianceFile:
    """Decodes a file, with a weak cache: as long as a caller holds the array, later calls return the same one.

    Copies of an environment (dataclasses.replace) share it.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._cached: Callable[[], np.ndarray | None] = lambda: None

    def __call__(self) -> np.ndarray:
        radiance = self._cached()
        if radiance is None:
            radiance = _decode(self.path)
            radiance.flags.writeable = False
            self._cached = weakref.ref(radiance)
        return radiance

    def __reduce__(self) -> tuple[type[_RadianceFile], tuple[Path]]:
        """A copy, or one in another process, decodes the file itself."""
        return _RadianceFile, (self.path,)


def _file_digest(path: Path) -> str:
    code = b"".join(Path(__file__).with_name(name).read_bytes() for name in _CODE)  # the radiance also depends on it
    digest = hashlib.blake2b(code, digest_size=20)
    try:
        with path.open("rb") as file:
            hashlib.file_digest(file, lambda: digest)
    except FileNotFoundError:
        raise InputError(path, "", "no such file") from None
    except IsADirectoryError:
        raise InputError(path, "", "is a folder") from None
    except OSError as error:
        raise InputError(path, "", f"cannot be read: {error.strerror}") from None
    return digest.hexdigest()


def _decode(path: Path) -> np.ndarray:
    """Radiance (H, W, 3) float32, W at most MAX_WIDTH."""
    if path.suffix.lower() != ".hdr":
        return _decode_by_library(path, path)
    data = read_file(path)
    header = read_hdr_header(data)
    if header is None:
        return _decode_by_library(path, path)
    matrix = xyz_to_rec_709() if header.is_xyz else _matrix(header.primaries)
    if header.size is not None:
        width, height = header.size
        _check_size(path, width, height)
        try:
            pixels = plain_pixels(data, header)
        except ValueError as error:
            raise InputError(path, "", f"ends too early: {error}") from None
        if pixels is not None:
            whole = pixels
            return _joined(_bands(path, lambda first, end: decoded(whole[first:end]), width, height, 1, False, matrix))
    if not header.is_xyz:
        return _decode_by_library(path, path, matrix)
    with tempfile.TemporaryDirectory() as folder:  # the library knows the code of the pixels, but not the name
        copy = Path(folder, "copy.hdr")
        copy.write_bytes(data[:header.start].replace(b"_xyze", b"_rgbe") + data[header.start:])
        return _decode_by_library(path, copy, matrix)


def _decode_by_library(path: Path, readable: Path, matrix: np.ndarray | None = None) -> np.ndarray:
    """What OpenImageIO finds in the file `readable`, in messages called `path`."""
    import OpenImageIO as oiio

    with utf8_name(readable) as name:
        source = oiio.ImageInput.open(name)
    if source is None:
        oiio.geterror()  # cleared; its words are the library's
        raise InputError(path, "", f"its beginning is broken, or is not that of a {path.suffix.lower()} file")
    try:
        spec, found, wanted = source.spec(), source.format_name(), FORMATS[path.suffix.lower()]
        if found != wanted:
            raise InputError(path, "", f"is a {found} file, but its extension says {wanted}")
        if spec.depth > 1 or spec.nchannels < 1 or spec.deep:
            raise InputError(path, "", "is not a flat image")
        _check_size(path, spec.width, spec.height)
        if matrix is None and found == "openexr":
            matrix = _matrix(spec.getattribute("chromaticities"))
        read, width, height = _rows_of(path, source)
        unit = max(1, spec.tile_height)
        is_encoded = str(spec.format) in ("uint8", "uint16")
        texels = _joined(_bands(path, read, width, height, unit, is_encoded, matrix))
    finally:
        source.close()
    return _upright(texels, spec.get_int_attribute("Orientation", 1))


def _rows_of(path: Path, source: Any) -> tuple[Callable[[int, int], np.ndarray], int, int]:
    """A function that reads rows [first, end) of the map as (h, W, 3) float32, and the map's width and height.

    The map is the display window: what of it the data window lacks is black, and the rest of the data is not shown
    (OpenEXR, "Technical Introduction").
    """
    spec = source.spec()
    channels = _color_channels(list(spec.channelnames))
    last = channels[-1] + 1

    def read(first: int, end: int) -> np.ndarray:
        top, bottom = spec.y + first, spec.y + end
        if spec.tile_width:
            texels = source.read_tiles(spec.x, spec.x + spec.width, top, bottom, spec.z, spec.z + 1, 0, last, "float")
        else:
            texels = source.read_scanlines(top, bottom, spec.z, 0, last, "float")
        if texels is None:
            source.geterror()  # cleared
            raise InputError(path, f"row {first}", "is broken, or the file ends before it")
        texels = texels.reshape(end - first, spec.width, last)
        return texels if channels == [0, 1, 2] else np.ascontiguousarray(texels[:, :, channels])

    left, top = spec.x - spec.full_x, spec.y - spec.full_y
    if (left, top, spec.full_width, spec.full_height) == (0, 0, spec.width, spec.height):
        return read, spec.width, spec.height
    _check_size(path, spec.full_width, spec.full_height)
    whole = np.zeros((spec.full_height, spec.full_width, 3), np.float32)
    rows = slice(max(top, 0), max(min(top + spec.height, spec.full_height), 0))
    columns = slice(max(left, 0), max(min(left + spec.width, spec.full_width), 0))
    if rows.start < rows.stop and columns.start < columns.stop:
        data = read(0, spec.height)
        whole[rows, columns] = data[rows.start - top:rows.stop - top, columns.start - left:columns.stop - left]
    return (lambda first, end: whole[first:end]), spec.full_width, spec.full_height


def _bands(path: Path, read: Callable[[int, int], np.ndarray], width: int, height: int, unit: int, encoded: bool,
           matrix: np.ndarray | None) -> Iterator[np.ndarray]:
    """The map from the top in pieces (h, W, 3) float32, each reduced to MAX_WIDTH as it comes: memory stays bounded.

    Pieces begin at multiples of `unit` rows.
    """
    factor = -(-max(width, 2 * height) // MAX_WIDTH)
    unit *= factor
    step = max(1, BAND // width // unit) * unit
    for first in range(0, height, step):
        texels = read(first, min(first + step, height))
        texels = _linear(texels) if encoded else _clean(path, first, texels)
        if matrix is not None:
            texels = texels @ matrix.T.astype(np.float32)
        yield _reduce(np.maximum(texels, 0), factor, first, height)


def _joined(bands: Iterator[np.ndarray]) -> np.ndarray:
    pieces = list(bands)
    return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)


def _check_size(path: Path, width: int, height: int) -> None:
    if width < 1 or height < 1:
        raise InputError(path, "", f"{width} x {height} texels are not an image")
    if width * height > MAX_TEXELS:
        raise InputError(path, "", f"{width} x {height} texels are more than {MAX_TEXELS}")


def _matrix(chromaticities: Sequence[float] | None) -> np.ndarray | None:
    """To Rec. 709, or None if there is nothing to convert; `map_warnings` tells of primaries that are no colours."""
    try:
        return None if chromaticities is None else to_rec_709(chromaticities)
    except ValueError:
        return None


def _color_channels(names: list[str]) -> list[int]:
    if all(c in names for c in "RGB"):
        return [names.index(c) for c in "RGB"]
    return [0, 1, 2] if len(names) >= 3 else [0, 0, 0]


def _reduce(texels: np.ndarray, factor: int, first: int, height: int) -> np.ndarray:
    """Means over blocks of factor x factor texels, weighted by solid angle. Blocks at the right and bottom edge may be
    smaller."""
    if factor == 1:
        return texels
    weights = texel_solid_angles(height, 1)[first:first + len(texels)].astype(np.float32)
    rows = np.arange(0, len(texels), factor)
    sums = np.add.reduceat(texels * weights[:, None, None], rows, axis=0)
    sums /= np.add.reduceat(weights, rows)[:, None, None]
    columns = np.arange(0, texels.shape[1], factor)
    counts = np.diff([*columns, texels.shape[1]]).astype(np.float32)
    return np.add.reduceat(sums, columns, axis=1) / counts[:, None]


def _clean(path: Path, first: int, texels: np.ndarray) -> np.ndarray:
    peak = texels.max(initial=0)  # NaN if any texel is
    if not peak <= MAX_RADIANCE:
        if np.isnan(texels).any():
            row, column = np.argwhere(np.isnan(texels).any(axis=2))[0]
            raise InputError(path, f"row {first + row}, column {column}", "the value is not a number (NaN)")
        texels = np.where(np.isposinf(texels), np.float32(HALF_MAX), texels)
        if texels.max() > MAX_RADIANCE:
            row, column = np.argwhere((texels > MAX_RADIANCE).any(axis=2))[0]
            raise InputError(path, f"row {first + row}, column {column}", f"radiance {texels.max():.3g} is over 1e12")
    return texels


def _linear(encoded: np.ndarray) -> np.ndarray:
    """sRGB to linear (IEC 61966-2-1)."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _upright(texels: np.ndarray, orientation: int) -> np.ndarray:
    """Undo the Exif orientation 1..8. OpenImageIO reports one also for Radiance files with another scanline order."""
    if orientation >= 5:
        texels = texels.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        texels = texels[::-1]
    if orientation in (2, 3, 6, 7):
        texels = texels[:, ::-1]
    return np.ascontiguousarray(texels)
