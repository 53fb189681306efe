"""A lobe of the user's own shader file: eval, and where the file has them sample, pdf and albedo, called on arrays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ...bake.dfg import dfg_table
from ...errors import UsageError
from ...gpu.call import call_glsl
from ...gpu.glsl_types import Function, Sampler, Struct, find_functions
from ...gpu.source import assemble
from .energy import LobeCase

Values = Mapping[str, Any]

# Values of the sets a lobe is checked at, in turn; what is not named here is 0.5, and a colour 1.
_RANGES = {
    "alpha": (0.02, 0.1, 0.4, 1.0), "perceptual_roughness": (0.15, 0.3, 0.6, 1.0), "roughness": (0.15, 0.3, 0.6, 1.0),
    "sigma": (0.0, 0.3, 0.6, 1.0), "shininess": (1.0, 10.0, 100.0, 1000.0), "exponent": (1.0, 10.0, 100.0, 1000.0),
    "eta": (1.5,) * 4, "ior": (1.5,) * 4, "k": (0.0,) * 4, "metallic": (0.0, 0.5, 0.5, 1.0),
}
_ARGUMENTS = {"eval": "vec3 wo, vec3 wi", "pdf": "vec3 wo, vec3 wi", "sample": "vec3 wo, vec3 u", "albedo": "float NoV"}
_COLORS_OF_WHITE = {"albedo", "base_color", "color", "f0", "specular", "k_s", "rho"}


@dataclass(frozen=True)
class UserLobe:
    """`name`_eval and its companions in `file`, which take the lobe's struct, directions, and the albedo table if last.

    The struct's members are given in each call as arrays whose leading axes broadcast with those of the directions.
    Parameters are told by their types and order: their names are free.
    """

    file: Path
    name: str

    def __post_init__(self) -> None:
        if "eval" not in self.functions:
            raise UsageError(f"{self.file}: there is no function {self.name}_eval")
        for what, function in self.functions.items():
            plain = [p for p in function.inputs if not isinstance(p.type, (Struct, Sampler))]
            if len(plain) != len(_ARGUMENTS[what].split(", ")) or len(plain) < len(function.inputs) - 2:
                raise UsageError(f"{self.file}: {function}: beside struct and sampler2D it takes {_ARGUMENTS[what]}")
        sample = self.functions.get("sample")
        result = sample.result if sample else None
        members = {name for name, _ in result.members} if isinstance(result, Struct) else set()
        if sample and not members >= {"wi", "weight", "pdf", "flags"}:
            raise UsageError(f"{self.file}: {sample}: it returns a BsdfSample, as shaders/bsdf/bsdf.glsl has it")

    @cached_property
    def functions(self) -> dict[str, Function]:
        found = {f.name: f for f in find_functions(assemble(self.file).text)}
        wanted = {what: f"{self.name}_{what}" for what in ("eval", "sample", "pdf", "albedo")}
        return {what: found[name] for what, name in wanted.items() if name in found}

    @property
    def members(self) -> dict[str, tuple[int, ...]]:
        """The struct's members and their shapes, () for a float; {} where the lobe has no struct."""
        for parameter in self.functions["eval"].parameters:
            if isinstance(parameter.type, Struct):
                return {name: getattr(type_, "shape", ()) for name, type_ in parameter.type.members}
        return {}

    def eval(self, values: Values, wo: np.ndarray, wi: np.ndarray) -> np.ndarray:
        """f, (..., 3)."""
        f = self._call("eval", values, [wo, wi])
        return f if f.shape[-1:] == (3,) and f.ndim == np.ndim(wi) else np.repeat(f[..., None], 3, axis=-1)

    def pdf(self, values: Values, wo: np.ndarray, wi: np.ndarray) -> np.ndarray:
        return self._call("pdf", values, [wo, wi])

    def albedo(self, values: Values, NoV: np.ndarray) -> np.ndarray:
        return self._call("albedo", values, [NoV])

    def sample(self, values: Values, wo: np.ndarray, u: np.ndarray) -> dict[str, np.ndarray]:
        return self._call("sample", values, [wo, u])

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
        return call_glsl(self.file, function.name, **named)


def user_case(file: str | Path, name: str) -> LobeCase:
    """What to check `name`_eval of `file` at: four sets, white ones where the struct has a colour to make white.

    Raises ShaderError for a file that is missing or broken, UsageError where it has no such function.
    """
    lobe = UserLobe(Path(file).absolute(), name)
    members = lobe.members
    sets = 4 if members else 1
    values = {}
    for member, shape in members.items():
        numbers = np.array(_RANGES.get(member, (1.0 if shape == (3,) else 0.5,) * 4))
        values[member] = np.broadcast_to(numbers.reshape(-1, *[1] * len(shape)), (sets, *shape)).astype(np.float64)
    return LobeCase(name, lobe, values, np.full(sets, bool(_COLORS_OF_WHITE & set(members))),
                    provides=frozenset(lobe.functions))
