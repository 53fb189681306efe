"""A piece of the renderer, its alternatives, and the measures of their errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import moderngl
import numpy as np

from viewer.gpu.context import Context

SHADERS = Path(__file__).resolve().parent / "shaders"
"""The GLSL of the alternatives, which the renderer has no use for."""
MakeTexture = Callable[[Context], moderngl.Texture]
Error = Callable[[np.ndarray], np.ndarray]
"""From what a kernel gives at a case's parameters, (H, W, 4), to errors of any shape."""


@dataclass(frozen=True)
class Kernel:
    """GLSL that is measured: `call` is an expression of type vec4 in the parameters p and q, the functions of `file`,
    and the textures. `file` is in SHADERS, or named relative to the renderer's own shaders."""

    file: str | Path
    call: str
    textures: Mapping[str, MakeTexture] = field(default_factory=dict)
    uniforms: Mapping[str, np.ndarray] = field(default_factory=dict)
    """Arrays of vectors, (N, 3), by the name they are declared with in `file`."""
    defines: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Case:
    """Where a piece is measured: `parameters`, (H, W, 4 or 8) float32, neighbours alike as in a picture."""

    parameters: np.ndarray
    error: Error


@dataclass(frozen=True)
class Variant:
    """One way to do it, with a kernel for each of the piece's cases. `size` is in bytes of what it looks up."""

    name: str
    kernels: tuple[Kernel, ...]
    source: str = ""
    size: int = 0
    bake_s: float | None = None
    is_default: bool = False
    cost_ns: float | None = None
    """Of what is not done by the kernel, but by the processor beforehand."""


@dataclass(frozen=True)
class Piece:
    """`over` is the range of parameters, `unit` what errors are in, `truth` what they are against, `reason` why the
    renderer does it as it does."""

    name: str
    title: str
    over: str
    unit: str
    truth: str
    cases: tuple[Case, ...]
    variants: tuple[Variant, ...]
    reason: str
    per: str = "evaluation"
    """What a cost is that of."""


def absolute(reference: np.ndarray, unit: float = 1.0) -> Error:
    """Differences from `reference`, (H, W, C), in the first C components."""
    return lambda found: (found[..., : reference.shape[-1]] - reference) / unit


def relative(reference: np.ndarray) -> Error:
    """The same as shares of `reference`, which is nowhere 0."""
    return lambda found: found[..., : reference.shape[-1]] / reference - 1


def logarithmic(reference: np.ndarray) -> Error:
    """Differences of the natural logarithm from that of `reference`."""
    truth = np.log(reference)
    return lambda found: np.log(np.maximum(found[..., : reference.shape[-1]], 1e-9)) - truth


def grid(*axes: np.ndarray) -> np.ndarray:
    """All combinations of two axes' values, padded to four components: (len, len, 4) float32."""
    points = np.zeros((len(axes[0]), len(axes[1]), 4), np.float32)
    points[..., 0], points[..., 1] = axes[0][:, None], axes[1]
    return points
