"""A lobe's functions of a GLSL file, called on arrays: eval, and where the file has them sample, pdf and albedo."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..bake.dfg import dfg_table
from ..errors import UsageError
from ..gpu.call import call_glsl
from ..gpu.glsl_types import Function, Sampler, Struct, find_functions
from ..gpu.source import assemble

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Samples:
    """Of K cases and N numbers each: wi (K, N, 3), weight (K, N, 3), pdf (K, N); flags as in shaders/bsdf/bsdf.glsl."""

    wi: np.ndarray
    weight: np.ndarray
    pdf: np.ndarray
    flags: np.ndarray


@dataclass(frozen=True)
class Bsdf:
    """`name`_eval and its companions in `file`, which take the lobe's struct, directions, and the albedo table if last.

    The struct's members are given in each call as arrays whose leading axes broadcast with those of the directions.
    Parameters are told by their types and order: their names are free.
    """

    file: str | Path
    name: str
    defines: Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        if self.function("eval") is None:
            raise UsageError(f"{self.file}: there is no function {self.name}_eval")

    @cached_property
    def functions(self) -> dict[str, Function]:
        found = {f.name: f for f in find_functions(assemble(self.file, self.defines).text)}
        wanted = {what: f"{self.name}_{what}" for what in ("eval", "sample", "pdf", "albedo")}
        return {what: found[name] for what, name in wanted.items() if name in found}

    def function(self, what: str) -> Function | None:
        return self.functions.get(what)

    @property
    def members(self) -> dict[str, tuple[int, ...]]:
        """The struct's members and their shapes, () for a float; {} where the lobe has no struct."""
        for parameter in self.functions["eval"].parameters:
            if isinstance(parameter.type, Struct):
                return {name: getattr(type_, "shape", ()) for name, type_ in parameter.type.members}
        return {}

    def eval(self, values: Values, wo: np.ndarray, wi: np.ndarray) -> np.ndarray:
        """f, (..., 3) float64."""
        f = self._call("eval", values, [wo, wi])
        return f if f.shape[-1:] == (3,) and f.ndim == np.ndim(wi) else np.repeat(f[..., None], 3, axis=-1)

    def pdf(self, values: Values, wo: np.ndarray, wi: np.ndarray) -> np.ndarray:
        return self._call("pdf", values, [wo, wi])

    def albedo(self, values: Values, NoV: np.ndarray) -> np.ndarray:
        return self._call("albedo", values, [NoV])

    def sample(self, values: Values, wo: np.ndarray, u: np.ndarray) -> Samples:
        found = self._call("sample", values, [wo, u])
        return Samples(*(np.asarray(found[key]) for key in ("wi", "weight", "pdf", "flags")))

    def _call(self, what: str, values: Values, arguments: list[np.ndarray]) -> Any:
        function, given = self.functions[what], iter(arguments)
        named: dict[str, Any] = {}
        for parameter in function.inputs:
            if isinstance(parameter.type, Sampler):
                named[parameter.name] = dfg_table()
            elif isinstance(parameter.type, Struct):
                named[parameter.name] = dict(values)
            else:
                named[parameter.name] = next(given)
        found = call_glsl(self.file, function.name, defines=self.defines, **named)
        if not isinstance(found, dict):
            return found.astype(np.float64)
        return {name: np.asarray(value, None if name == "flags" else np.float64) for name, value in found.items()}
