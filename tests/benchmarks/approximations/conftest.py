"""What a piece's ways give on the device."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from benchmarks.approximations.device import Device
from benchmarks.approximations.piece import Piece
from viewer.gpu.context import Context

Errors = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def device(context: Context) -> Device:
    return Device(context)


@pytest.fixture
def errors(device: Device) -> Callable[[Piece], Errors]:
    """The errors of each way, by its name, of all cases one after the other."""
    def of(piece: Piece) -> Errors:
        assert sum(variant.is_default for variant in piece.variants) == 1
        assert len({variant.name for variant in piece.variants}) == len(piece.variants)
        return {variant.name: np.concatenate([np.ravel(case.error(device.values(kernel, case.parameters)))
                                              for kernel, case in zip(variant.kernels, piece.cases, strict=True)])
                for variant in piece.variants}
    return of


@pytest.fixture
def rms(errors: Callable[[Piece], Errors]) -> Callable[[Piece], dict[str, float]]:
    return lambda piece: {name: float(np.sqrt(np.mean(found**2))) for name, found in errors(piece).items()}
