"""All checks in order, as `pbr-viewer check` runs them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from ...base.progress import Progress
from ...gpu.context import open_context
from ...raster.renderer import Renderer
from ...scene.scene import Scene
from ...settings import Settings
from ...trace.tracer import Tracer
from .checks import Check
from .energy import LobeCase, check_lobe
from .extremes import check_extremes
from .fibres import check_fibre_extremes, check_fibres
from .furnace import check_furnaces, check_material, check_renderer_balance
from .lobe_cases import lobe_cases
from .lobe_stability import check_lobe_extremes, check_lobe_stability
from .media import check_media
from .media_pictures import check_media_extremes, check_media_furnaces
from .stability import check_stability
from .user_lobe import user_case
from .woven import check_woven, check_woven_extremes

Part = tuple[str, Callable[[], Iterator[Check]]]


def run_checks(what: str, quiet: bool) -> list[Check]:
    """The checks of the package's own shaders: `what` of energy, stability or all. Raises ContextError."""
    with open_context() as context:
        renderer, tracer = Renderer(context, use_cache=False), Tracer(context, use_cache=False)
        parts: list[Part] = []
        if what != "stability":
            parts += _lobe_parts(lobe_cases())
            parts += [("media", check_media), ("fibres", check_fibres), ("woven cloth", check_woven)]
            parts += [("furnace", partial(check_furnaces, renderer))]
            parts += [("balance", partial(check_renderer_balance, renderer))]
            parts += [("media in furnaces", partial(check_media_furnaces, tracer))]
        if what != "energy":
            parts += [("float32", check_stability)]
            parts += [("lobes' values", check_lobe_stability), ("lobes' extremes", check_lobe_extremes)]
            parts += [("extreme fibres", check_fibre_extremes), ("extreme cloth", check_woven_extremes)]
            parts += [("extremes", partial(check_extremes, renderer))]
            parts += [("extreme media", partial(check_media_extremes, tracer))]
        return _run(parts, quiet)


def run_model_checks(scene: Scene, settings: Settings, quiet: bool) -> list[Check]:
    """The energy of every material of a model, its factors as the renderer shades them. Raises ContextError."""
    with open_context() as context:
        renderer = Renderer(context, use_cache=False)
        names = [material.name or f"material {k}" for k, material in enumerate(scene.materials)]
        parts: list[Part] = [(name, partial(check_material, renderer, name, material, settings))
                             for name, material in zip(names, scene.materials)]
        return _run(parts, quiet)


def run_shader_checks(file: str, lobe: str, quiet: bool) -> list[Check]:
    """The energy of a lobe of the user's own file. Raises ShaderError, UsageError, ContextError."""
    return _run(_lobe_parts([user_case(file, lobe)]), quiet)


def _lobe_parts(cases: list[LobeCase]) -> list[Part]:
    return [(case.name, partial(check_lobe, case)) for case in cases]


def _run(parts: list[Part], quiet: bool) -> list[Check]:
    checks: list[Check] = []
    with Progress(len(parts), enabled=not quiet) as progress:
        for name, part in parts:
            progress.step(name)
            checks += part()
    return checks
