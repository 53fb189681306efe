"""Woven cloth, as the BSDF of shaders/bsdf/weave, against the fibres that it stands for: `python -m benchmarks.weave`.

A piece of each weave is spun of fibres (viewer/scene/yarn), and path traced with the scattering of hair: in parallel
light, by an orthographic camera that sees exactly whole repeats of the draft in its middle. A plate with the weave's
BSDF is shown to the same camera. The reflectance, pi L / E, is the mean of the picture, for 20 pairs of directions. For
the anisotropy there are four more, seen along the normal, in light from along the weft, the warp and both diagonals.
Fibres are so thin that as many of them as make a yarn of THICKNESS fill half of it. Each reflectance is the mean of
SEEDS pictures, whose spread gives its standard error.

No parameter is fitted. Those of the BSDF follow from the fibres:

| parameter | from |
|---|---|
| color | the colour of fibres, as it is |
| specular | the mean of Fresnel's reflectance over a cylinder |
| roughness | the variance of the lobe R along the fibre, half of whose deviation is that of the half vector |
| thickness | the mean number of fibres across a yarn, by their number and radius |
| through | random walks through such a layer of parallel white fibres, in diffuse light, of those that meet several |

`--frames` draws assets/scenes/cloth.glb instead, in the studio, in mode pbr: processor time of a frame without a weave
and with each, one after the other in turn. Where the CPU renders, antialias=auto means ssaa-4 for woven cloth, and
msaa-4 for others.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np

import viewer
from viewer.gpu.call import call_glsl
from viewer.gpu.context import open_context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.weave import WEAVES, Weave, Yarn
from viewer.scene.yarn.kind import YARNS, YarnKind
from viewer.scene.yarn.woven import weave_fibres
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import tracing
from .shot import REPOSITORY

THICKNESS, FILLED = 3.0, 0.5
SEEDS = 4
WIDTH = 32
"""Pixels. Views have cosines of whole pixels over it, so that the picture is exactly as high as whole repeats."""
VIEWS = ((32, 0.0), (28, 0.0), (28, 90.0), (20, 45.0), (14, 0.0))
"""Cosine in pixels, and azimuth from the weft on."""
LIGHTS = ((0.97, 17.0), (0.8, 180.0), (0.6, 90.0), (0.45, 241.0))
PAIRS = tuple((view, (cosine, azimuth + 21 * k)) for k, view in enumerate(VIEWS) for cosine, azimuth in LIGHTS)
AXES = tuple(((32, 0.0), (0.625, azimuth)) for azimuth in (0.0, 90.0, 45.0, 135.0))
COLUMNS = {"weave": "weave", "fibres": "fibres:,", "mean": "mean", "pairs within 10 %": "close",
           "rms of pairs": "rms:.3f", "worst pair": "worst", "standard error of a pair, mean (most)": "error",
           "light along weft / warp: fibres": "axis_fibres:.2f",
           "BSDF": "axis_bsdf:.2f", "diagonals: fibres": "twist_fibres:.2f", "BSDF ": "twist_bsdf:.2f"}

FRAMES = {"weave": "weave", "pixels": "size", "none, ms": "none:.0f", "msaa-4, ms": "msaa-4:.0f",
          "ssaa-4, ms": "ssaa-4:.0f", "ssaa-4, of plain msaa-4": "share:.1f"}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("weaves", nargs="*", default=list(WEAVES))
    parser.add_argument("--spp", type=int, default=24)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--results", type=Path, default=Path(__file__).parent / "results")
    parser.add_argument("--frames", action="store_true", help="measure frames instead")
    options = parser.parse_args()
    if options.frames:
        keep_frames(options.weaves, options.results)
        return
    with open_context() as context:
        tracer = Tracer(context)
        rows = [compare(tracer, name, options.spp, options.repeats) for name in options.weaves]
        facts = tracing.conditions(tracer) | {"command": "python -m benchmarks.weave", "spp": options.spp}
        tracer.release()
    text = ["# Woven cloth against its fibres", "",
            "Mean reflectance of red, green and blue over 20 pairs of directions, the BSDF's over the fibres'. "
            "Standard errors are those of the fibres, without the chance in how they lie.", "",
            *tracing.table(rows, COLUMNS)]
    tracing.keep("weave", facts, rows, text, options.results)


def keep_frames(weaves: list[str], results: Path) -> None:
    with open_context() as context:
        renderer, tracer = Renderer(context), Tracer(context)
        rows = frames(renderer, ["off", *weaves], size=128, rounds=3)
        facts = tracing.conditions(tracer) | {"command": "python -m benchmarks.weave --frames"}
        tracer.release()
        renderer.release()
    text = ["# Frames of woven cloth", "", "Median processor time of a frame, on all threads.", "",
            *tracing.table(rows, FRAMES)]
    tracing.keep("weave_frames", facts, rows, text, results)


def frames(renderer: Renderer, weaves: list[str], size: int, rounds: int) -> list[dict[str, object]]:
    """A row for each weave, with the medians of its frames by antialiasing, in ms. Each round draws all of them."""
    scene = viewer.load(REPOSITORY / "assets/scenes/cloth.glb", environment="studio")
    camera = scene.framing_camera(1.0)
    found: dict[tuple[str, str], list[float]] = {(weave, antialias): [] for weave in weaves
                                                 for antialias in ("none", "msaa-4", "ssaa-4")}
    for _ in range(rounds):
        for (weave, antialias), times in found.items():
            for is_measured in (False, True):  # the first frame makes anew what another picture has replaced
                start = time.process_time()
                renderer.display(scene, camera, Settings.of(weave=weave, antialias=antialias), (size, size))
                if is_measured:
                    times.append(1e3 * (time.process_time() - start))
    plain = median(found[weaves[0], "msaa-4"])
    return [{"weave": weave, "size": f"{size} x {size}", "share": median(found[weave, "ssaa-4"]) / plain,
             **{antialias: median(found[weave, antialias]) for antialias in ("none", "msaa-4", "ssaa-4")}}
            for weave in weaves]


def compare(tracer: Tracer, name: str, spp: int, repeats: int) -> dict[str, object]:
    weave, kind = matched(WEAVES[name])
    fibres = weave_fibres(weave, kind, (repeats, repeats))
    pairs = PAIRS + AXES
    scene, cloth = Scene("fibres", curves=(fibres,)), plate(weave, repeats)
    of_fibres = np.array([[reflectance(tracer, scene, pair, -(-spp // SEEDS), bounces=100, seed=seed)
                           for seed in range(SEEDS)] for pair in pairs])
    a = of_fibres.mean(axis=1)
    b = np.array([reflectance(tracer, cloth, pair, 2 * spp, bounces=2) for pair in pairs])
    n = len(PAIRS)
    ratio = b[:n].mean(axis=1) / a[:n].mean(axis=1)
    error = of_fibres.mean(axis=2).std(axis=1, ddof=1) / math.sqrt(SEEDS) / a.mean(axis=1)
    worst = int(np.argmax(np.abs(np.log(ratio))))
    return {"weave": name, "fibres": fibres.strand_count,
            "mean": ", ".join(f"{x:.3f}" for x in b[:n].mean(axis=0) / a[:n].mean(axis=0)),
            "close": int((np.abs(ratio - 1) < 0.1).sum()), "rms": float(np.sqrt(np.mean((ratio - 1)**2))),
            "worst": f"{ratio[worst]:.2f} at {describe(PAIRS[worst])}",
            "error": f"{100 * error.mean():.2f} % ({100 * error.max():.2f} %)",
            **{f"{axis}_{what}": float(values[k].sum() / values[k + 1].sum())
               for what, values in (("fibres", a), ("bsdf", b)) for axis, k in (("axis", n), ("twist", n + 2))},
            "pairs": [{"pair": describe(pair), "fibres": np.round(x, 4).tolist(), "bsdf": np.round(y, 4).tolist(),
                       "error": round(float(e), 4)} for pair, x, y, e in zip(pairs, a, b, error)]}


def describe(pair: tuple) -> str:
    (pixels, azimuth), (cosine, light) = pair
    return (f"view {math.degrees(math.acos(pixels / WIDTH)):.0f}, {azimuth:.0f}; "
            f"light {math.degrees(math.acos(cosine)):.0f}, {light % 360:.0f} degrees")


def matched(weave: Weave) -> tuple[Weave, YarnKind]:
    """The weave with the parameters that follow from its fibres, a repeat for each unit of u and of v, and the fibres.
    Its yarns are wide, since lights do not see through the gaps of a mesh."""
    radius = FILLED * min(weave.flatness) / THICKNESS  # in half widths of the yarn
    kind = replace(YARNS["silk"], fibres=round(THICKNESS / radius), radius=radius, roughness=(0.3, 0.3), hairs=0.0)
    h = (np.arange(2000) + 0.5) / 2000
    cosine = np.sqrt(1 - h * h)
    inside = np.sqrt(1 - (h / kind.ior)**2)
    s, p = ((x - y) / (x + y) for x, y in ((cosine, kind.ior * inside), (inside, kind.ior * cosine)))
    specular = float(((s * s + p * p) / 2).mean())
    m = kind.roughness[0]
    deviation = 0.726 * m + 0.812 * m**2 + 3.7 * m**20
    thickness = kind.fibres * kind.radius
    found = {"specular": (specular,) * 3, "roughness": deviation / 2, "thickness": thickness,
             "through": share_through(kind, thickness), "width": 0.97}

    def fitting(yarn: Yarn) -> Yarn:
        return replace(yarn, **found)

    return replace(weave, warp=fitting(weave.warp), weft=fitting(weave.weft),
                   density=(float(len(weave.draft[0])), float(len(weave.draft)))), kind


def share_through(kind: YarnKind, thickness: float) -> float:
    """Of diffuse light that meets several fibres of a layer of white ones, which all lie along x: the share that comes
    out on the other side, by random walks. A fibre that light meets at an angle is in its way by the sine of that."""
    rng = np.random.default_rng(1)
    count = 1 << 15
    fibre = {"sigma_a": np.zeros(3), "beta_m": kind.roughness[0], "beta_n": kind.roughness[1],
             "tilt": math.radians(kind.tilt), "eta": kind.ior}
    cosine, azimuth = np.sqrt(rng.random(count)), 2 * math.pi * rng.random(count)
    sine = np.sqrt(1 - cosine**2)
    direction = np.column_stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine])
    depth, through, back, fibres = np.zeros(count), 0, 0, 0
    while len(depth):
        met = np.sqrt(np.maximum(1 - direction[:, 0]**2, 1e-9))
        depth = depth - direction[:, 2] * np.log(1 - rng.random(len(depth))) / met
        if fibres > 1:
            through += int((depth > thickness).sum())
            back += int((depth < 0).sum())
        fibres += 1
        inside = (depth >= 0) & (depth <= thickness)
        depth, wo = depth[inside], -direction[inside]
        if len(depth):
            drawn = call_glsl("bsdf/fibre/fibre.glsl", "fibre_sample", f=fibre, h=rng.uniform(-1, 1, len(wo)), wo=wo,
                              u=rng.random((len(wo), 4), np.float32))
            direction = drawn["wi"] / np.linalg.norm(drawn["wi"], axis=1, keepdims=True)
    return through / (through + back)


def plate(weave: Weave, repeats: int) -> Scene:
    half = repeats / 2
    corners = np.float32([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
    mesh = Mesh("cloth", corners, 0, indices=np.uint32([0, 1, 2, 0, 2, 3]), normals=np.float32([[0, 0, 1]] * 4),
                uvs=(corners[:, :2].copy(),))
    cloth = Material(metallic=0.0, weave=weave, double_sided=True, alpha_mode="blend" if weave.has_gaps else "opaque")
    return Scene("cloth", (mesh,), (cloth,), (Instance(0, np.eye(4)),))


def reflectance(tracer: Tracer, scene: Scene, pair: tuple, spp: int, bounces: int, seed: int = 0) -> np.ndarray:
    """pi L / E of red, green and blue in the middle of a cloth about the origin, in the plane z = 0."""
    (pixels, azimuth), (cosine, light) = pair
    turn = math.radians(azimuth)
    to_eye = _direction(pixels / WIDTH, turn)
    right = np.array([-math.sin(turn), math.cos(turn), 0.0])
    pose = np.eye(4)
    pose[:3] = np.column_stack([right, np.cross(to_eye, right), to_eye, 50 * to_eye])
    side = math.sqrt(2) if azimuth == 45 else 1.0  # of a square along the diagonals, two repeats
    sun = Light("directional", intensity=math.pi / cosine,
                direction=tuple((-_direction(cosine, math.radians(light))).tolist()))
    picture = tracer.render(replace(scene, lights=(sun,)), Camera(pose, height=side * pixels / WIDTH),
                            Settings.of(mode="path", spp=spp, bounces=bounces, background="none", seed=seed),
                            (WIDTH, pixels))
    return picture.linear[..., :3].mean(axis=(0, 1), dtype=np.float64)


def _direction(cosine: float, azimuth: float) -> np.ndarray:
    sine = math.sqrt(1 - cosine * cosine)
    return np.array([sine * math.cos(azimuth), sine * math.sin(azimuth), cosine])


if __name__ == "__main__":
    main()
