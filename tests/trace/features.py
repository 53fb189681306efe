"""One scene for each feature, drawn by the raster and by the path tracer, with bounds for their difference.

As a script, writes docs/raster-against-path.md: python tests/trace/features.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from shapes import WHITE, constant, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment_presets import make_preset
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

SIZE, BLOCKS = 48, 8
VIEW = orthographic(0.4, 0.3, height=2.1)


@dataclass(frozen=True)
class Feature:
    """`mean` bounds |mean path / mean raster - 1|. `blocks` bounds the root mean square difference of the means of 8 x
    8 parts of the picture, divided by the mean. `why` explains a difference that is not noise."""

    name: str
    make: Callable[[], tuple[Scene, Camera]]
    mean: float
    blocks: float
    why: str = ""
    spp: int = 32
    size: int = SIZE
    settings: dict[str, object] = field(default_factory=dict)


def ball(environment=None, lights=(), **material) -> Callable[[], tuple[Scene, Camera]]:
    def make() -> tuple[Scene, Camera]:
        around = make_preset(environment) if isinstance(environment, str) else environment
        return scene(sphere(segments=128), materials=[Material(**material)], environment=around, lights=lights), VIEW

    return make


def asset(name: str, environment: str | None) -> Callable[[], tuple[Scene, Camera]]:
    def make() -> tuple[Scene, Camera]:
        model = viewer.load(resource_folder("assets") / "scenes" / f"{name}.glb", environment=environment)
        return model, model.cameras[0]

    return make


def pane() -> tuple[Scene, Camera]:
    """A blended pane in front of half of a wall far behind it. The shadow of the pane falls outside of the picture."""
    tinted = Material(base_color=(0.2, 0.6, 0.9, 0.4), metallic=0.0, specular=0.0, perceptual_roughness=1.0,
                      alpha_mode="blend", double_sided=True)
    model = scene((plate(0, half=3.0), moved((0, 0, -3))), (plate(1), moved((0.6, 0, 0))), materials=[WHITE, tinted],
                  lights=(Light("directional", intensity=4.0, direction=(-0.8, 0, -0.6)),))
    return model, orthographic(0.0, 0.0, height=2.0)


def pane_shadows() -> tuple[Scene, Camera]:
    """Two black blended panes beside the picture. Their shadows fall on the wall in it and overlap."""
    black = Material(base_color=(0, 0, 0, 0.4), metallic=0.0, specular=0.0, alpha_mode="blend", double_sided=True)
    model = scene((plate(0, half=3.0), moved((0, 0, -3))), (plate(1, half=0.6), moved((3.8, 0.2, 0))),
                  (plate(1, half=0.6), moved((4.2, -0.2, 0.2))), materials=[WHITE, black],
                  lights=(Light("directional", intensity=4.0, direction=(-0.8, 0, -0.6)),))
    return model, orthographic(0.0, 0.0, height=2.0)


def window(roughness: float = 0.0) -> Callable[[], tuple[Scene, Camera]]:
    """A coloured thin-walled pane of glass, tilted, in front of half of an emissive wall."""
    def make() -> tuple[Scene, Camera]:
        glass = Material(base_color=(0.9, 0.6, 0.3, 1), metallic=0.0, perceptual_roughness=roughness, transmission=1.0,
                         double_sided=True)
        shining = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(1.0, 0.8, 0.5))
        model = scene((plate(0, half=3.0), moved((0, 0, -1))), (plate(1, half=2.0), moved((2.0, 0, 0))),
                      materials=[shining, glass], environment=constant(0.5))
        return model, orthographic(0.3, 0.2, height=2.0)

    return make


def hollow_ball() -> tuple[Scene, Camera]:
    """A glass shell whose thickness is 0.3 times its radius."""
    outer = sphere(segments=128)
    hole = replace(outer, indices=np.ascontiguousarray(outer.indices.reshape(-1, 3)[:, ::-1]).ravel(),
                   normals=-outer.normals)
    return scene(outer, (hole, moved((0, 0, 0), 0.7)), materials=[Material(**GLASS)],
                 environment=make_preset("studio")), VIEW


def shadows() -> tuple[Scene, Camera]:
    """A black ball, which reflects no light, on a floor with a directional light from the side."""
    black = replace(WHITE, base_color=(0, 0, 0, 1))
    model = scene((plate(0, half=3.0), facing_floor()), (sphere(1, 64), moved((0, 0.5, 0), 0.5)),
                  materials=[WHITE, black], lights=(Light.from_angles(0.8, 0.9, 3.0),))
    return model, orthographic(0.2, 0.6, height=3.0)


def paper(environment=None, lights=(), turn: float = 0.0) -> Callable[[], tuple[Scene, Camera]]:
    """A sheet that scatters most of what it transmits, seen from its front, or from behind."""
    def make() -> tuple[Scene, Camera]:
        rice = Material(base_color=(0.3, 0.5, 0.2, 1), metallic=0.0, perceptual_roughness=0.0, specular=0.0, ior=1.0,
                        double_sided=True, transmission=0.8, scatter_strength=0.9, multiscatter_color=(0.9, 0.7, 0.2),
                        multiscatter_anisotropy=0.4)
        return scene(plate(), materials=[rice], environment=environment, lights=lights), orthographic(
            0.4 + turn, 0.3, height=1.2)

    return make


def leaf(environment=None, lights=(), turn: float = 0.0) -> Callable[[], tuple[Scene, Camera]]:
    """A sheet that lets light through, seen from its front, or from behind."""
    def make() -> tuple[Scene, Camera]:
        green = Material(base_color=(0.3, 0.5, 0.2, 1), metallic=0.0, specular=0.0, double_sided=True,
                         diffuse_transmission=0.6, diffuse_transmission_color=(0.9, 0.7, 0.2))
        return scene(plate(), materials=[green], environment=environment, lights=lights), orthographic(
            0.4 + turn, 0.3, height=1.2)

    return make


def cloud(environment: str | None = None, lights=()) -> Callable[[], tuple[Scene, Camera]]:
    """The cloud of assets/volumes."""
    def make() -> tuple[Scene, Camera]:
        model = viewer.load(resource_folder("assets") / "volumes" / "cloud.vdb", environment=environment)
        return replace(model, lights=lights), model.framing_camera(1.0)

    return make


GREY, PLASTIC = {"metallic": 0.0, "specular": 0.0, "base_color": (0.5, 0.5, 0.5, 1)}, {
    "metallic": 0.0, "perceptual_roughness": 0.4, "base_color": (0.6, 0.1, 0.1, 1)}
ROUGH = {"metallic": 0.0, "specular": 0.0, "base_color": (0.7, 0.7, 0.7, 1), "diffuse_roughness": 1.0}
GLASS = {"metallic": 0.0, "perceptual_roughness": 0.0, "transmission": 1.0, "thickness": 2.0}
GOLD = {"base_color": (1.0, 0.78, 0.34, 1)}
WAX = {"metallic": 0.0, "base_color": (0.6, 0.6, 0.6, 1), "diffuse_transmission": 0.5, "thickness": 2.0}
BEHIND = (Light("directional", direction=(0.2, -0.3, 1.0), intensity=3.0),)
FILM = {"metallic": 0.5, "perceptual_roughness": 0.4, "iridescence": 1.0, "iridescence_ior": 1.7,
        "iridescence_thickness_maximum": 320.0}
BRUSHED = {"perceptual_roughness": 0.4, "anisotropy_strength": 0.8, "anisotropy_rotation": 0.5}
SUN = (Light.from_angles(-0.6, 0.7, 3.0),)
LAMP = (Light("point", intensity=6.0, position=(-1.2, 1.5, 1.5)),)
SPOT = (Light("spot", intensity=8.0, position=(-1.0, 1.2, 2.0), direction=(0.4, -0.5, -0.77), inner_cone=0.1,
              outer_cone=0.4),)
MAPS = "The rasterizer reads a prefiltered environment."
SUM = "The rasterizer sums two lookups of a prefiltered environment and its irradiance."
TILTED = "The rasterizer reads the irradiance of one cosine lobe, tilted towards the viewer."
CAUGHT = "At each surface inside, the rasterizer follows only the stronger of reflection and refraction."
EDGES = "Edges weigh much in a picture that is mostly empty."
MIXED = "The rasterizer takes a solid for a slab; light inside of a ball goes everywhere."
HAZE = "The rasterizer takes light that fog scatters more than once for diffuse, and surfaces light it in one colour."
DIFFUSE = "The rasterizer takes light that is scattered more than once for diffuse, on a coarse grid."
FEATURES = [
    Feature("uniform light, diffuse", ball(constant(), **GREY), 0.004, 0.012),
    Feature("uniform light, plastic", ball(constant(), **PLASTIC), 0.004, 0.015),
    Feature("uniform light, gold 0.3", ball(constant(), perceptual_roughness=0.3, **GOLD), 0.004, 0.015),
    Feature("furnace, white diffuse", ball(constant(), **(GREY | {"base_color": (1, 1, 1, 1)})), 0.004, 0.012),
    Feature("furnace, white metal 0.6", ball(constant(), perceptual_roughness=0.6), 0.004, 0.012),
    Feature("furnace, white plastic 0.6", ball(constant(), metallic=0.0, perceptual_roughness=0.6), 0.004, 0.012),
    Feature("furnace, white rough diffuse", ball(constant(), **(ROUGH | {"base_color": (1, 1, 1, 1)})), 0.004, 0.012),
    Feature("studio, diffuse", ball("studio", **GREY), 0.01, 0.03, MAPS),
    Feature("studio, plastic", ball("studio", **PLASTIC), 0.01, 0.04, MAPS),
    Feature("studio, rough diffuse", ball("studio", **ROUGH), 0.01, 0.09, TILTED),
    Feature("studio, gold 0.1", ball("studio", perceptual_roughness=0.1, **GOLD), 0.015, 0.06, MAPS),
    Feature("studio, gold 0.5", ball("studio", perceptual_roughness=0.5, **GOLD), 0.015, 0.16, SUM),
    Feature("specular anti-aliasing, gold 0.1", ball("studio", perceptual_roughness=0.1, **GOLD), 0.07, 0.2,
            "The rasterizer widens reflections that are finer than a pixel of so small a ball.",
            settings={"specular_aa": "on"}),
    Feature("studio, coated gold", ball("studio", perceptual_roughness=0.3, clearcoat=1.0, clearcoat_roughness=0.1,
                                        **GOLD), 0.015, 0.09, MAPS),
    Feature("sky, velvet", ball("sky", sheen_color=(1.0, 0.6, 0.3), sheen_roughness=0.5, **GREY), 0.015, 0.06,
            "The rasterizer looks up the light of the fibres along one axis, as wide as a cosine lobe."),
    Feature("sun, velvet", ball(lights=SUN, sheen_color=(1.0, 0.6, 0.3), sheen_roughness=0.5, **GREY), 0.004, 0.012),
    Feature("sky, Zeltner's velvet", ball("sky", sheen_color=(1.0, 0.6, 0.3), sheen_roughness=0.4, **GREY), 0.015, 0.06,
            "The rasterizer looks up the light of the fibres along one axis and its opposite.",
            settings={"sheen": "zeltner"}),
    Feature("sun, Zeltner's velvet", ball(lights=SUN, sheen_color=(1.0, 0.6, 0.3), sheen_roughness=0.4, **GREY), 0.004,
            0.012, settings={"sheen": "zeltner"}),
    Feature("furnace, film on white plastic", ball(constant(), **(FILM | {"metallic": 0.0})), 0.004, 0.012),
    Feature("furnace, film on glass", ball(constant(), **(GLASS | FILM | {"perceptual_roughness": 0.0})), 0.004, 0.012),
    Feature("studio, film on half metal", ball("studio", **FILM), 0.02, 0.1, MAPS),
    Feature("sun, film on half metal", ball(lights=SUN, **FILM), 0.004, 0.015),
    Feature("sun, coated plastic", ball(lights=SUN, clearcoat=1.0, clearcoat_roughness=0.3, **PLASTIC), 0.004, 0.012),
    Feature("furnace, brushed metal", ball(constant(), **BRUSHED), 0.006, 0.015),
    Feature("studio, brushed metal", ball("studio", **BRUSHED), 0.02, 0.06,
            "The rasterizer sums narrower lobes along the tangent."),
    Feature("sun, brushed metal", ball(lights=SUN, **BRUSHED), 0.006, 0.03),
    Feature("sun, diffuse", ball(lights=SUN, **GREY), 0.004, 0.012),
    Feature("sun, plastic", ball(lights=SUN, **PLASTIC), 0.004, 0.012),
    Feature("sun, rough diffuse", ball(lights=SUN, **ROUGH), 0.004, 0.012),
    Feature("sun, gold 0.5", ball(lights=SUN, perceptual_roughness=0.5, **GOLD), 0.004, 0.015),
    Feature("point light, diffuse", ball(lights=LAMP, **GREY), 0.004, 0.012),
    Feature("spot light, diffuse", ball(lights=SPOT, **GREY), 0.004, 0.015),
    Feature("emission", ball(metallic=0.0, specular=0.0, base_color=(0, 0, 0, 1), emissive=(2.0, 1.0, 0.5)), 0.004,
            0.012),
    Feature("sheet, sun behind", leaf(lights=BEHIND), 0.004, 0.012),
    Feature("sheet seen from behind", leaf(lights=BEHIND, turn=np.pi), 0.004, 0.012),
    Feature("scattering sheet, sun behind", paper(lights=BEHIND), 0.004, 0.012),
    Feature("scattering sheet seen from behind", paper(lights=BEHIND, turn=np.pi), 0.004, 0.012),
    Feature("scattering sheet, lopsided environment", paper(environment=lopsided()), 0.01, 0.02, MAPS),
    Feature("sheet, lopsided environment", leaf(environment=lopsided()), 0.01, 0.02, MAPS),
    Feature("furnace, white wax", ball(constant(), **(WAX | {"base_color": (1, 1, 1, 1)})), 0.004, 0.02),
    Feature("studio, wax", ball("studio", **WAX), 0.1, 0.2, MIXED),
    Feature("furnace, white ball in white fog", ball(constant(), **(GREY | {"base_color": (1, 1, 1, 1)})), 0.006, 0.02,
            settings={"fog": 0.5, "fog_albedo": (1, 1, 1)}, spp=16),
    Feature("studio, ball in fog", ball("studio", **GREY), 0.07, 0.08, HAZE, settings={"fog": 0.3}),
    Feature("sun, ball in fog", ball(lights=SUN, **GREY), 0.04, 0.06, HAZE, settings={"fog": 0.3}, spp=16),
    Feature("studio, ball in fog of g 0.7", ball("studio", **GREY), 0.04, 0.1, HAZE,
            settings={"fog": 0.3, "fog_g": 0.7}),
    Feature("studio, cloud", cloud("studio"), 0.06, 0.18, DIFFUSE, settings={"volume_density": 2.0}),
    Feature("sun, cloud", cloud(lights=SUN), 0.06, 0.22, DIFFUSE),
    Feature("unlit", ball("studio", base_color=(0.9, 0.4, 0.1, 1), unlit=True), 0.004, 0.012),
    Feature("shadow of a sun", shadows, 0.004, 0.015),
    Feature("blended pane", pane, 0.015, 0.02, "The path tracer includes interreflection between pane and wall."),
    Feature("shadows of blended panes", pane_shadows, 0.015, 0.04, "A shadow map has 16 steps of transparency."),
    Feature("furnace, glass ball", ball(constant(), **GLASS), 0.004, 0.012),
    Feature("furnace, rough thin glass", ball(constant(), **(GLASS | {"thickness": 0.0, "perceptual_roughness": 0.5})),
            0.02, 0.03),
    Feature("furnace, dispersive glass", ball(constant(), dispersion=5.0, **GLASS), 0.004, 0.02),
    Feature("studio, dispersive glass, traced", ball("studio", dispersion=5.0, **GLASS), 0.03, 0.3, CAUGHT,
            settings={"refraction": "traced"}, spp=64),
    Feature("studio, glass ball", ball("studio", **GLASS), 0.5, 1.2,
            "The rasterizer has no internal reflections and guesses the far side of the ball."),
    Feature("studio, glass ball, traced", ball("studio", **GLASS), 0.02, 0.25, CAUGHT,
            settings={"refraction": "traced"}),
    Feature("studio, hollow glass ball, traced", hollow_ball, 0.09, 0.25, CAUGHT, settings={"refraction": "traced"}),
    Feature("window of coloured glass", window(), 0.004, 0.012),
    Feature("window of rough glass", window(0.4), 0.03, 0.04,
            "The rasterizer blurs the picture behind the glass, the path tracer scatters the light."),
    Feature("normal map", asset("normal-map", None), 0.01, 0.03,
            "The rasterizer widens the lobe about a pixel's mean normal, the path tracer averages the shading.",
            spp=16, size=144),
    Feature("textures", asset("textures", "studio"), 0.015, 0.04, EDGES, spp=16,
            size=144),
    Feature("vertex colours", asset("vertex-colors", "studio"), 0.015, 0.04, EDGES, spp=16, size=144),
]


@dataclass(frozen=True)
class Distance:
    mean: float
    blocks: float


def distance(feature: Feature, renderer: Renderer, tracer: Tracer) -> Distance:
    """The difference between the path-traced picture and the raster's, over the pixels that the model covers."""
    model, camera = feature.make()
    size = (feature.size, feature.size)
    settings = {"background": "none", "specular_aa": "off"} | feature.settings
    raster = renderer.render(model, camera, Settings.of(**settings), size).linear
    path_render = tracer.begin(model, camera, Settings.of(mode="path", spp=feature.spp, **settings), size)
    while not path_render.is_done:
        path_render.step(0.25)
    traced = path_render.image().linear
    path_render.release()
    pair = [_blocks(image[..., :3].astype(np.float64)) for image in (raster, traced)]
    level = pair[0].mean()
    return Distance(abs(pair[1].mean() / level - 1), float(np.sqrt(((pair[1] - pair[0]) ** 2).mean()) / level))


def _blocks(pixels: np.ndarray) -> np.ndarray:
    rows, columns = (side // BLOCKS for side in pixels.shape[:2])
    return pixels.reshape(BLOCKS, rows, BLOCKS, columns, 3).mean(axis=(1, 3))


INTRODUCTION = """\
# The rasterizer against the path tracer, feature by feature

    python tests/trace/features.py

renders each scene below with both renderers and writes this page. Both use the same BSDF files, so a difference shows
what the rasterizer approximates, apart from noise. The tests fail if a difference exceeds the limit in brackets.

- *mean*: the relative difference between the mean radiances of the two pictures.
- *blocks*: the picture is divided into 8 x 8 blocks. This is the root mean square of the differences between the mean
  radiances of a block, divided by the mean radiance of the picture.

The scene is a ball of radius 1 that fills a picture of 48 x 48 pixels, unless the name says otherwise. Specular
antialiasing is on in one row only.
"""


def main() -> None:
    from viewer.gpu.context import open_context

    lines = [*INTRODUCTION.splitlines(), "",
             "| feature | mean | blocks | why |", "|---|---|---|---|"]
    with open_context() as context:
        renderer, tracer = Renderer(context), Tracer(context)
        for feature in FEATURES:
            found = distance(feature, renderer, tracer)
            lines.append(f"| {feature.name} | {found.mean:.2%} ({feature.mean:.1%}) | {found.blocks:.2%} "
                         f"({feature.blocks:.1%}) | {feature.why} |")
            print(lines[-1])
    page = Path(__file__).resolve().parents[2] / "docs" / "raster-against-path.md"
    page.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
