"""The checks as a self-contained page: their table, and plots of lobes, albedos, errors and furnaces."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from ...base.atomic import atomic_write, make_folder, write_json
from ...gpu.context import open_context
from ...image.image import Image
from ...raster.renderer import Renderer
from ...scene.material import Material
from ..drawing import to_svg
from ..html_page import html_page
from ..plot import heat_map, lines, polar
from .checks import Check, summary
from .furnace import ROUGHNESS, furnace_picture
from .half_vector import reflected_grid
from .lobes import LOBES, Lobe
from .stability import Sweep, measure, sweeps
from .table import verdict

_BODY = """<h1>pbr-viewer check</h1>
<p>{summary}.</p>
{sections}
<h2>All checks</h2>
<p>A check passes if its value is at most its bound. <b>known</b>: the model is known to fail this check, and does.
<b>FAIL</b>: the check fails, so the shader is wrong. <b>GONE</b>: the model is known to fail and passes, so the check
or the shader is wrong.</p>
<div class="wide"><table><tr><th></th><th>check</th><th>case</th><th>value</th><th>bound</th><th>note</th></tr>
{rows}
</table></div>"""
_STYLE = """
.pass { color: #2a8f52 } .known { color: #a8760a } .FAIL, .GONE { color: #d22; font-weight: bold }
.plots { --gaps: calc((var(--columns) - 1) * 1rem); display: grid; gap: 1rem;
  grid-template-columns: repeat(auto-fill, minmax(max(14rem, (100% - var(--gaps)) / var(--columns)), 1fr)) }
.plots svg { width: 100%; height: auto }
.plots figure { display: flex; gap: .6rem; align-items: center }
img { image-rendering: pixelated; width: 8rem; flex: none; border: 1px solid var(--line) }
"""
_GREY = 0.5
"""What radiance 1 is multiplied by in a furnace's picture: a brighter surface is seen as well as a darker one."""
_SHOWN = ("ggx", "metal", "turquin", "eon", "burley", "phong")


def write_page(folder: str | Path, checks: Sequence[Check], with_plots: bool) -> None:
    """`index.html` and `check.json` in `folder`, which is made where it is missing. Raises OutputError.

    The plots show the package's own shaders, and are left out if something else was checked.
    """
    folder = Path(folder)
    make_folder(folder)
    sections = "\n".join(_sections()) if with_plots else ""
    rows = "\n".join(_row(check) for check in checks)
    body = _BODY.format(summary=summary(checks), sections=sections, rows=rows)
    with atomic_write(folder / "index.html") as file:
        file.write_text(html_page("pbr-viewer check", body, _STYLE), encoding="utf-8")
    write_json(folder / "check.json", [check.to_json() for check in checks])


def _row(check: Check) -> str:
    word = verdict(check)
    cells = (check.check, check.case, f"{check.value:.2e}", f"{check.bound:.2e}", check.note)
    return f'<tr><td class="{word}">{word}</td>' + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"


def _sections() -> Iterator[str]:
    table = {lobe.name: lobe for lobe in LOBES}
    yield _section("Furnaces", "A white metal ball under radiance 1 from everywhere, with and without energy "
                   "compensation for multiple scattering. Radiance 1 is mid grey: a ball that cannot be seen in it "
                   "conserves energy.",
                   _furnaces(), columns=4)
    yield _section("Lobes", "The BSDF times the cosine in the plane of incidence. Light comes from 45 degrees left.",
                   [_lobe_shape(table[name]) for name in _SHOWN])
    yield _section("Albedo", "The share of light that a white material reflects, over the cosine of the viewing angle.",
                   [_albedo(table[name]) for name in _SHOWN])
    wanted = ("d_ggx", "d_beckmann", "v_smith_ggx", "f_dielectric")
    first: dict[str, Sweep] = {}
    for sweep in sweeps():
        if sweep.function in wanted:
            first.setdefault(sweep.function, sweep)
    yield _section("Errors of float32", "Relative error against float64 over two parameters, from 1e-8 (light) to 1e-3 "
                   "(dark). If there is a third parameter, the worst over it is shown.",
                   [_error_map(sweep) for sweep in first.values()], columns=4)


def _section(title: str, text: str, figures: Sequence[str], columns: int = 3) -> str:
    """A title, a text, and figures that fill the width in that many columns, or in fewer on a narrow screen."""
    return f'<h2>{title}</h2><p>{text}</p><div class="plots" style="--columns: {columns}">{"".join(figures)}</div>'


def _furnaces() -> list[str]:
    figures = []
    with open_context() as context:
        renderer = Renderer(context, use_cache=False)
        for multiscatter in ("on", "off"):
            for roughness in ROUGHNESS[2:]:
                picture = furnace_picture(renderer, Material(perceptual_roughness=roughness), multiscatter=multiscatter)
                png = Image.from_linear(_GREY * picture.pixels)._repr_png_()
                words = "energy compensated" if multiscatter == "on" else "single scattering"
                figures.append(f'<figure><img alt="" src="data:image/png;base64,{base64.b64encode(png).decode()}">'
                               f"<figcaption>roughness {roughness:g}, {words}<br>at most {picture.maximum:.1e} off, "
                               f"mean {picture.mean:.1e}</figcaption></figure>")
    return figures


def _settings(lobe: Lobe) -> dict[str, dict]:
    """A few roughnesses of a lobe by name."""
    ranges = {"alpha": (0.1, 0.3, 0.6, 1.0), "sigma": (0.0, 0.5, 1.0), "perceptual_roughness": (0.0, 0.5, 1.0),
              "shininess": (3.0, 10.0, 100.0)}
    name = next(name for name in ranges if name in lobe.parameters)
    size = lobe.parameters[name].size
    word = name.removeprefix("perceptual_")
    return {f"{word} {value:g}": lobe.struct(**{name: value if size == 1 else (value,) * size})
            for value in ranges[name]}


def _lobe_shape(lobe: Lobe) -> str:
    angle = np.linspace(-np.pi / 2, np.pi / 2, 361)[1:-1]
    wi = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
    wo = np.sqrt(0.5) * np.array([-1.0, 0.0, 1.0])
    series = {name: (angle, lobe.eval(m, wo, wi)[..., 0] * np.cos(angle)) for name, m in _settings(lobe).items()}
    return to_svg(polar(lobe.name, series))


def _albedo(lobe: Lobe) -> str:
    NoV = np.linspace(0.02, 1, 25)
    wo = np.stack([np.sqrt(1 - NoV**2), 0 * NoV, NoV], axis=-1)
    grid = reflected_grid(wo)
    weight = grid.solid_angle * np.maximum(grid.wi[..., 2], 0)
    series = {name: (NoV, (np.where(weight > 0, lobe.eval(m, wo[:, None], grid.wi)[..., 0], 0) * weight).sum(axis=1))
              for name, m in _settings(lobe).items()}
    return to_svg(lines(lobe.name, series, "NoV", "albedo"))


def _error_map(sweep: Sweep) -> str:
    error = measure(sweep).relative
    error = error.reshape(*error.shape[:2], -1).max(axis=2)
    names = list(sweep.axes)
    for axis in (0, 1):  # a plot has room for about 40 cells, each the worst of some
        starts = np.arange(0, error.shape[axis], max(1, round(error.shape[axis] / 40)))
        error = np.maximum.reduceat(error, starts, axis=axis)
    ticks = [[f"{axis[k]:.2g}" for k in np.linspace(0, len(axis) - 1, 5).astype(int)] for axis in sweep.axes.values()]
    return to_svg(heat_map(sweep.function, error, names[1], names[0], ticks[1], ticks[0]))
