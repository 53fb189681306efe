"""Colours of other primaries as linear Rec. 709."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

REC_709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""x and y of red, green, blue and white, in the order of EXR's `chromaticities` and of Radiance's PRIMARIES."""
_BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
"""XYZ to the responses of cones in which white points are adapted (Lam 1985, as in ICC.1:2010, annex E)."""


def to_rec_709(chromaticities: Sequence[float]) -> np.ndarray | None:
    """The (3, 3) matrix from linear RGB of eight `chromaticities` to Rec. 709; None where they are those of Rec. 709.

    White becomes white: the white point is adapted by Bradford's transform. Raises ValueError for what are no
    primaries.
    """
    if not np.abs(chromaticities).max() < 10:  # of imaginary primaries, too, the coordinates are about 1
        raise ValueError("chromaticities have to be small numbers")
    if np.abs(np.subtract(chromaticities, REC_709)).max() < 1e-3:
        return None
    cones = _BRADFORD @ np.stack([_xyz(*chromaticities[6:8]), _xyz(*REC_709[6:8])], axis=1)
    adapted = np.linalg.inv(_BRADFORD) @ np.diag(cones[:, 1] / cones[:, 0]) @ _BRADFORD
    return xyz_to_rec_709() @ adapted @ _rgb_to_xyz(chromaticities)


def xyz_to_rec_709() -> np.ndarray:
    """From CIE XYZ to linear Rec. 709, (3, 3), without adaptation: D65 is white."""
    return np.linalg.inv(_rgb_to_xyz(REC_709))


def _rgb_to_xyz(chromaticities: Sequence[float]) -> np.ndarray:
    """SMPTE RP 177-1993: primaries scaled so that together they are the white of Y = 1."""
    primaries = np.stack([_xyz(*chromaticities[k:k + 2]) for k in (0, 2, 4)], axis=1)
    try:
        return primaries * np.linalg.solve(primaries, _xyz(*chromaticities[6:8]))
    except np.linalg.LinAlgError:
        raise ValueError("the primaries lie on a line") from None


def _xyz(x: float, y: float) -> np.ndarray:
    """Of chromaticity x, y; Y is 1."""
    if abs(y) < 1e-3:
        raise ValueError(f"a chromaticity y of {y:g}")
    return np.array([x / y, 1.0, (1 - x - y) / y])
