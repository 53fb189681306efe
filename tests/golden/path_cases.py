"""What the path-traced golden images show: small scenes, one for each part of the path tracer that could be wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from cases import sides
from images import image_of
from shapes import WHITE, constant, facing_floor, moved, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.scene.camera import Camera
from viewer.scene.curves import Curves
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture, UVTransform
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings

SIZE = (32, 32)


@dataclass(frozen=True)
class PathCase:
    """`spp` samples a pixel are one picture."""

    name: str
    make: Callable[[], tuple[Scene, Camera]]
    spp: int = 64
    settings: dict[str, object] = field(default_factory=dict)

    def with_seed(self, seed: int) -> Settings:
        return Settings.of(mode="path", spp=self.spp, seed=seed, **self.settings)


PLASTIC = {"metallic": 0.0, "perceptual_roughness": 0.5}
GLASS = {"metallic": 0.0, "transmission": 1.0, "thickness": 1.0}
FLOOR = Material(base_color=(0.6, 0.55, 0.5, 1), metallic=0.0, perceptual_roughness=0.7)
SUN = Light.from_angles(0.6, 0.7, 2.0)
VIEW = Camera.look_at((0.0, 1.6, 3.2), (0.0, 0.35, 0.0), fov_y=np.radians(34))


def smooth_noise(channels: int, seed: int) -> np.ndarray:
    """Texels between which a map varies, (16, 16, channels) uint8, each around another value."""
    rng = np.random.default_rng(seed)
    return (rng.uniform(0.3, 0.7, channels) * 255 + rng.uniform(-70, 70, (16, 16, channels))).astype(np.uint8)


def maps() -> tuple[Scene, Camera]:
    """A slanted plate with every map there is."""
    flat = np.array([128, 128, 255]) + np.random.default_rng(1).uniform(-50, 50, (16, 16, 3)) * [1, 1, 0]
    turned = UVTransform((0.2, 0.1), 0.4, (1.5, 0.8))
    material = Material(
        base_color_texture=Texture(image_of(smooth_noise(3, 2)), transform=turned),
        metallic=0.8, perceptual_roughness=0.9, metallic_roughness_texture=Texture(image_of(smooth_noise(3, 3))),
        normal_texture=Texture(image_of(flat.astype(np.uint8))), normal_scale=0.8,
        occlusion_texture=Texture(image_of(smooth_noise(3, 4))),
        emissive=(0.3, 0.2, 0.1), emissive_texture=Texture(image_of(smooth_noise(3, 5))),
        specular=0.9, specular_texture=Texture(image_of(smooth_noise(4, 6))),
        specular_color=(1.0, 0.8, 0.6), specular_color_texture=Texture(image_of(smooth_noise(3, 7))), ior=1.8)
    return scene(plate(0), materials=[material], lights=(SUN,), environment=sides()), Camera.look_at(
        (1.2, 0.9, 2.2), (0, 0, 0), fov_y=np.radians(42))


def metal() -> tuple[Scene, Camera]:
    """Copper, a mirror, and gold, from rough to smooth, that see each other and a floor of plastic."""
    materials = [FLOOR, Material(base_color=(0.95, 0.64, 0.54, 1), perceptual_roughness=0.5),
                 Material(base_color=(0.9, 0.9, 0.9, 1), perceptual_roughness=0.0),
                 Material(base_color=(1.0, 0.78, 0.34, 1), perceptual_roughness=0.25)]
    return scene((plate(0, 3.0), facing_floor()), *_row(1, 2, 3), materials=materials, environment=sides()), VIEW


def _row(*materials: int) -> list:
    """Balls beside one another on the floor."""
    return [(sphere(material, 32), moved((0.75 * (k - (len(materials) - 1) / 2), 0.36, 0.0), 0.36))
            for k, material in enumerate(materials)]


def _glass_before_plastic(*glasses: Material) -> tuple[Scene, Camera]:
    """Balls of glass on a floor, one of plastic behind them, and in the first a small one that shines, too: where
    nothing is in the glass, what is done to radiance on its way in is undone on its way out."""
    red = Material(base_color=(0.7, 0.1, 0.1, 1), **PLASTIC)
    inner = Material(base_color=(0.3, 0.6, 0.9, 1), emissive=(0.4, 0.3, 0.1), **PLASTIC)
    balls = _row(*range(3, 3 + len(glasses)))
    center = balls[0][1][:3, 3]
    return scene((plate(0, 3.0), facing_floor()), (sphere(1, 32), moved((0.2, 0.5, -1.0), 0.5)),
                 (sphere(2, 16), moved(center, 0.15)), *balls,
                 materials=[FLOOR, red, inner, *glasses], environment=sides()), VIEW


def glass_smooth() -> tuple[Scene, Camera]:
    return _glass_before_plastic(*(Material(perceptual_roughness=0.0, ior=ior, **GLASS) for ior in (1.5, 1.33)))


def glass_rough() -> tuple[Scene, Camera]:
    return _glass_before_plastic(Material(perceptual_roughness=0.3, **GLASS),
                                 Material(perceptual_roughness=0.6, base_color=(0.9, 0.7, 0.5, 1), **GLASS))


def glass_absorbing() -> tuple[Scene, Camera]:
    """A volume that absorbs, smooth and rough, and glass that is half plastic, of a weak and coloured reflection."""
    green = {"attenuation_distance": 0.4, "attenuation_color": (0.3, 0.8, 0.5)}
    return _glass_before_plastic(
        Material(perceptual_roughness=0.0, **GLASS, **green), Material(perceptual_roughness=0.4, **GLASS, **green),
        Material(perceptual_roughness=0.3, base_color=(0.3, 0.5, 0.9, 1), specular=0.6, specular_color=(1.0, 0.5, 0.2),
                 **(GLASS | {"transmission": 0.5})))


def glass_thin() -> tuple[Scene, Camera]:
    """Three panes without thickness, clear, tinted and rough, half before a wall in the sun."""
    thin = GLASS | {"thickness": 0.0, "double_sided": True}
    panes = [Material(perceptual_roughness=0.0, **thin),
             Material(perceptual_roughness=0.4, base_color=(0.4, 0.7, 0.9, 1), **thin),
             Material(perceptual_roughness=0.6, **thin)]
    placed = [(plate(1 + k, 0.36), _turned(0.7 * (k - 1), 0.4, 0.3 * k, 0.3 * (k - 1))) for k in range(3)]
    return scene((plate(0, 3.0), facing_floor()), (plate(0, 0.8), moved((0, 0.2, -0.8))), *placed,
                 materials=[FLOOR, *panes], lights=(SUN,), environment=sides()), VIEW


def _turned(x: float, y: float, z: float, angle: float) -> np.ndarray:
    matrix = moved((x, y, z))
    matrix[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    return matrix


def alpha() -> tuple[Scene, Camera]:
    """A card with holes and two that blend, one with colours at its corners, and their shadows."""
    y, x = np.mgrid[-1:1:16j, -1:1:16j]
    holes = np.stack([0 * x + 200, 0 * x + 150, 0 * x + 60, 255 * (np.abs(np.hypot(x, y) - 0.6) < 0.3)], axis=-1)
    card = plate(3, 0.45)
    colors = np.float32([[1, 0, 0, 1], [0, 1, 0, 0.3], [0, 0, 1, 1], [1, 1, 1, 0.6]])
    materials = [FLOOR,
                 Material(base_color_texture=Texture(image_of(holes.astype(np.uint8))), alpha_mode="mask",
                          double_sided=True, **PLASTIC),
                 Material(base_color=(0.2, 0.4, 0.9, 0.5), alpha_mode="blend", double_sided=True, **PLASTIC),
                 Material(alpha_mode="blend", double_sided=True, **PLASTIC)]
    return scene((plate(0, 3.0), facing_floor()), (plate(1, 0.45), _turned(-0.6, 0.5, 0.2, 0.4)),
                 (plate(2, 0.45), _turned(0.1, 0.5, 0.5, -0.5)), (replace(card, colors=colors), moved((0.6, 0.5, 0))),
                 materials=materials, lights=(SUN,), environment=sides()), VIEW


def emitters() -> tuple[Scene, Camera]:
    """A room of bright walls, lit by a panel under its ceiling and by a ball: nearly all light is reflected often."""
    white = Material(base_color=(0.8, 0.8, 0.8, 1), metallic=0.0, perceptual_roughness=0.9)
    red, green = (replace(white, base_color=color) for color in ((0.7, 0.1, 0.1, 1), (0.1, 0.6, 0.15, 1)))
    black = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0)
    materials = [white, red, green, replace(black, emissive=(6.0, 5.0, 4.0)), replace(black, emissive=(2.0, 3.0, 6.0)),
                 Material(base_color=(0.9, 0.8, 0.5, 1), metallic=0.0, perceptual_roughness=0.3)]
    ceiling, lamp = facing_floor(y=2.0), facing_floor(y=1.98)
    for matrix in (ceiling, lamp):
        matrix[:3, 1:3] *= -1  # facing down
    side = np.pi / 2
    return scene((plate(0), facing_floor()), (plate(0), ceiling), (plate(0), moved((0, 1, -1))),
                 (plate(1), _turned(-1, 1, 0, side)), (plate(2), _turned(1, 1, 0, -side)), (plate(3, 0.35), lamp),
                 (sphere(4, 16), moved((-0.6, 0.4, 0.3), 0.12)), (sphere(5, 32), moved((0.35, 0.4, -0.2), 0.4)),
                 materials=materials), Camera.look_at((0, 1, 4.1), (0, 1, 0), fov_y=np.radians(38))


def punctual() -> tuple[Scene, Camera]:
    """A point, a spot and a sun, each of its colour."""
    lights = (Light("point", (1.0, 0.3, 0.2), 2.0, (-0.9, 1.1, 0.9), range=4.0),
              Light("spot", (0.3, 1.0, 0.3), 6.0, (1.0, 1.6, 1.0), (-0.5, -0.75, -0.45), inner_cone=0.2,
                    outer_cone=0.5),
              replace(SUN, color=(0.3, 0.4, 1.0)))
    materials = [FLOOR, Material(base_color=(0.8, 0.8, 0.8, 1), **PLASTIC), WHITE,
                 Material(base_color=(0.9, 0.6, 0.3, 1), perceptual_roughness=0.5)]
    return scene((plate(0, 3.0), facing_floor()), *_row(1, 2, 3), materials=materials, lights=lights), VIEW


def brushed() -> tuple[Scene, Camera]:
    """A brushed plate of metal, its direction by a map and turned, half of its glare from a light."""
    directions = smooth_noise(3, 9)
    material = Material(base_color=(0.9, 0.8, 0.6, 1), perceptual_roughness=0.35, anisotropy_strength=0.9,
                        anisotropy_rotation=0.5, anisotropy_texture=Texture(image_of(directions)))
    return scene(plate(0), materials=[material], lights=(SUN,), environment=sides()), Camera.look_at(
        (1.2, 0.9, 2.2), (0, 0, 0), fov_y=np.radians(42))


def specular_glossiness() -> tuple[Scene, Camera]:
    """A slanted plate of KHR_materials_pbrSpecularGlossiness with all its maps."""
    gloss = Material(base_color=(0.8, 0.7, 0.6, 1), base_color_texture=Texture(image_of(smooth_noise(3, 2))),
                     metallic=0.0, perceptual_roughness=0.2, specular_color=(22.0, 15.0, 10.0),
                     specular_glossiness_texture=Texture(image_of(smooth_noise(4, 12))))
    return scene(plate(0), materials=[gloss], lights=(SUN,), environment=sides()), Camera.look_at(
        (1.2, 0.9, 2.2), (0, 0, 0), fov_y=np.radians(42))


def plaster() -> tuple[Scene, Camera]:
    """Rough and smooth plaster, bare and varnished, under a sun behind the eye."""
    clay = {"base_color": (0.8, 0.5, 0.35, 1), "metallic": 0.0}
    materials = [FLOOR, Material(diffuse_roughness=1.0, specular=0.0, **clay), Material(specular=0.0, **clay),
                 Material(diffuse_roughness=0.9, perceptual_roughness=0.5, **clay, diffuse_roughness_texture=Texture(
                     image_of(smooth_noise(1, 13))))]
    balls = _row(1, 2, 3)
    mapped = replace(balls[2][0], uvs=(np.abs(balls[2][0].positions[:, :2]),))
    return scene((plate(0, 3.0), facing_floor()), *balls[:2], (mapped, balls[2][1]), materials=materials,
                 lights=(Light.from_angles(0.1, 0.5, 2.0),), environment=sides()), VIEW


def cloth() -> tuple[Scene, Camera]:
    """Sheen over cloth, rough, smoother, and by maps under a coat."""
    velvet = {"base_color": (0.3, 0.03, 0.06, 1), "metallic": 0.0, "perceptual_roughness": 0.8}
    materials = [FLOOR, Material(sheen_color=(1.0, 0.8, 0.6), sheen_roughness=0.7, **velvet),
                 Material(sheen_color=(0.6, 0.8, 1.0), sheen_roughness=0.3, **velvet),
                 Material(sheen_color=(1.0, 1.0, 1.0), sheen_roughness=0.9, clearcoat=0.5, **velvet,
                          sheen_color_texture=Texture(image_of(smooth_noise(3, 15))),
                          sheen_roughness_texture=Texture(image_of(smooth_noise(4, 16))))]
    balls = _row(1, 2, 3)
    mapped = replace(balls[2][0], uvs=(np.abs(balls[2][0].positions[:, :2]),))
    return scene((plate(0, 3.0), facing_floor()), *balls[:2], (mapped, balls[2][1]), materials=materials,
                 lights=(Light.from_angles(1.9, 0.4, 3.0),), environment=sides()), VIEW


def films() -> tuple[Scene, Camera]:
    """Films over plastic, over metal with thickness and weight by maps, and on both faces of thin glass."""
    film = {"perceptual_roughness": 0.5, "iridescence": 1.0, "iridescence_ior": 1.9}
    materials = [
        FLOOR,
        Material(base_color=(0.02, 0.02, 0.02, 1), metallic=0.0, iridescence_thickness_maximum=330.0, **film),
        Material(base_color=(0.8, 0.7, 0.6, 1), iridescence_texture=Texture(image_of(smooth_noise(3, 18))),
                 iridescence_thickness_minimum=420.0, iridescence_thickness_maximum=180.0,
                 iridescence_thickness_texture=Texture(image_of(smooth_noise(3, 17))), **film),
        Material(iridescence_thickness_maximum=250.0, **film, **(GLASS | {"thickness": 0.0}))]
    balls = _row(1, 2, 3)
    mapped = replace(balls[1][0], uvs=(np.abs(balls[1][0].positions[:, :2]),))
    return scene((plate(0, 3.0), facing_floor()), balls[0], (mapped, balls[1][1]), balls[2], materials=materials,
                 lights=(SUN,), environment=sides()), VIEW


def coated() -> tuple[Scene, Camera]:
    """Coats over metal, over bumps, with bumps of their own over a lamp, and over a rough pane of glass."""
    bumps = [Texture(image_of((np.array([128, 128, 255]) + np.random.default_rng(k).uniform(-80, 80, (4, 4, 3))
                               * [1, 1, 0]).astype(np.uint8))) for k in (12, 13)]
    weight = Texture(image_of(smooth_noise(3, 14)))
    materials = [
        FLOOR, Material(base_color=(0.9, 0.5, 0.3, 1), perceptual_roughness=0.5, clearcoat=1.0),
        Material(base_color=(0.02, 0.04, 0.1, 1), normal_texture=bumps[0], clearcoat=1.0, clearcoat_texture=weight,
                 clearcoat_roughness=0.5, clearcoat_roughness_texture=weight, **PLASTIC),
        Material(base_color=(0, 0, 0, 1), emissive=(1.5, 1.0, 0.4), clearcoat=1.0, clearcoat_roughness=0.2,
                 clearcoat_normal_texture=bumps[1], **PLASTIC),
        Material(perceptual_roughness=0.4, clearcoat=1.0, double_sided=True, **(GLASS | {"thickness": 0.0}))]
    placed = [(plate(1 + k, 0.5), _turned(k % 2 - 0.5, 1.2 - k // 2, 0.0, 0.3 - 0.6 * (k % 2))) for k in range(4)]
    return scene(*placed, (plate(0, 3.0), facing_floor(y=-0.4)), materials=materials, lights=(SUN,),
                 environment=sides()), Camera.look_at((0.0, 1.2, 3.4), (0.0, 0.7, 0.0), fov_y=np.radians(38))


def translucent() -> tuple[Scene, Camera]:
    """A leaf with a map, a hollow ball that absorbs, and paper, from behind and before in the sun."""
    leaf = Material(base_color=(0.2, 0.5, 0.1, 1), metallic=0.0, perceptual_roughness=0.5, double_sided=True,
                    diffuse_transmission=0.9, diffuse_transmission_texture=Texture(image_of(smooth_noise(4, 14))),
                    diffuse_transmission_color_texture=Texture(image_of(smooth_noise(3, 15))))
    wax = Material(base_color=(0.8, 0.7, 0.6, 1), metallic=0.0, perceptual_roughness=0.6, thickness=0.7,
                   diffuse_transmission=0.7, attenuation_distance=0.5, attenuation_color=(0.8, 0.4, 0.2))
    paper = Material(base_color=(0.8, 0.8, 0.8, 1), metallic=0.0, specular=0.0, double_sided=True,
                     diffuse_transmission=0.4, diffuse_transmission_color=(0.9, 0.8, 0.6))
    return scene((plate(0, 3.0), facing_floor()), (plate(1, 0.4), _turned(-0.75, 0.45, 0.1, 0.3)),
                 (sphere(2, 32), moved((0, 0.36, 0), 0.36)), (plate(3, 0.4), _turned(0.8, 0.45, 0.1, 2.8)),
                 materials=[FLOOR, leaf, wax, paper], lights=(Light.from_angles(2.6, 0.5, 3.0),),
                 environment=sides()), VIEW


def scattering() -> tuple[Scene, Camera]:
    """Wax behind a boundary that refracts, fog in a ball of index 1, and a wall that scatters what it transmits."""
    wax = Material(perceptual_roughness=0.7, ior=1.4, scatter_strength=0.9, multiscatter_color=(0.9, 0.7, 0.4),
                   multiscatter_anisotropy=0.3, attenuation_distance=0.12, attenuation_color=(0.4, 0.3, 0.2), **GLASS)
    fog = Material(perceptual_roughness=0.0, ior=1.0, scatter_color=(0.6, 0.8, 0.9), scatter_anisotropy=0.8,
                   attenuation_distance=0.3, attenuation_color=(0.5, 0.4, 0.3), **GLASS)
    wall = Material(perceptual_roughness=0.6, double_sided=True, scatter_strength=0.9, multiscatter_anisotropy=0.4,
                    scatter_strength_texture=Texture(image_of(smooth_noise(4, 21))),
                    multiscatter_color_texture=Texture(image_of(smooth_noise(3, 22))),
                    **(GLASS | {"thickness": 0.0, "transmission": 0.9}))
    return scene((plate(0, 3.0), facing_floor()), *_row(1, 2)[:1], (sphere(2, 32), moved((0.1, 0.36, 0), 0.36)),
                 (plate(3, 0.36), _turned(0.85, 0.4, 0.1, 2.8)), materials=[FLOOR, wax, fog, wall],
                 lights=(Light.from_angles(2.2, 0.6, 2.0),), environment=sides()), VIEW


def cloud() -> tuple[Scene, Camera]:
    """A cloud in fog that thins out with height, and a ball in both, under a sun and a lamp."""
    z, y, x = np.mgrid[-1:1:9j, -1:1:7j, -1:1:11j]
    density = np.maximum(1.2 - np.sqrt(x * x + y * y + z * z) + 0.3 * np.sin(5 * x) * np.cos(4 * z), 0)
    volume = Volume.in_box(density.astype(np.float32), np.array([[-0.9, 0.1, -0.6], [0.5, 1.0, 0.3]]))
    red = Material(base_color=(0.7, 0.2, 0.1, 1), **PLASTIC)
    lamp = Light("point", (0.5, 0.7, 1.0), 0.3, (0.9, 0.7, 0.4))
    model = scene((plate(0, 3.0), facing_floor()), (sphere(1, 32), moved((0.5, 0.3, -0.1), 0.3)),
                  materials=[FLOOR, red], lights=(Light.from_angles(-0.8, 0.8, 2.0), lamp),
                  environment=constant(0.4))
    return replace(model, volumes=(volume,)), VIEW


def dispersive() -> tuple[Scene, Camera]:
    """Glass that refracts colours apart, smooth and rough, before stripes."""
    stripes = np.where(np.arange(16) % 2, 230, 10)[None, :, None] * np.ones((16, 1, 3))
    wall = Material(base_color_texture=Texture(image_of(stripes.astype(np.uint8))), **PLASTIC)
    balls = [Material(perceptual_roughness=roughness, dispersion=6.0, ior=ior, **GLASS)
             for roughness, ior in ((0.0, 1.5), (0.3, 1.7))]
    return scene((plate(0, 1.6), moved((0, 0.6, -0.9))), *_row(1, 2), materials=[wall, *balls],
                 environment=sides()), VIEW


def hair() -> tuple[Scene, Camera]:
    """A tuft of fur on a floor, with its shadow, under a sun and light from all around."""
    model = scene((plate(0, 3.0), facing_floor()), materials=[FLOOR], lights=(SUN,), environment=constant(0.4))
    return replace(model, curves=(_tuft(),)), Camera.look_at((0.0, 1.6, 3.2), (0.1, 0.4, 0.0), fov_y=np.radians(28))


def hair_lamp() -> tuple[Scene, Camera]:
    """A tuft before a lamp, which is about as wide as the lobe of light that passes through fibres: samples of either
    kind find it, so both densities count."""
    lamp = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(8.0, 7.2, 6.0))
    model = scene((sphere(0, 16), moved((-1.2, 1.5, -1.5), 0.6)), materials=[lamp], environment=constant(0.3))
    return replace(model, curves=(_tuft(),)), Camera.look_at((0.0, 1.6, 3.2), (0.1, 0.4, 0.0), fov_y=np.radians(22))


def _tuft() -> Curves:
    fur = viewer.load(resource_folder("assets") / "curves" / "fur.curves", environment=None).curves[0]
    return replace(fur, points=50.0 * fur.points, radii=50.0 * fur.radii)


def denim() -> tuple[Scene, Camera]:
    """Woven cloth that hangs in folds, from near enough to see its yarns, under a sun and in an environment."""
    cloth = viewer.load(resource_folder("assets") / "scenes" / "cloth.glb", environment=None)
    return replace(cloth, environment=sides()), Camera.look_at((0.3, 1.6, 4.0), (0.22, 0.05, 0.35), fov_y=np.radians(9))


def knitted() -> tuple[Scene, Camera]:
    """Stitches of one yarn behind the other, under a sun and light from all around; near enough to see fibres."""
    return _yarns("knit.bcc"), Camera.look_at((0.5, 0.8, 2.2), (0.0, 0.0, 0.0), fov_y=np.radians(24))


def interlaced() -> tuple[Scene, Camera]:
    """Warp and weft of two colours."""
    return _yarns("woven.hair"), Camera.look_at((0.7, 0.4, 2.2), (0.0, 0.0, 0.0), fov_y=np.radians(22))


def _yarns(name: str) -> Scene:
    yarns = viewer.load(resource_folder("assets") / "curves" / name, environment=None).curves[0]
    larger = replace(yarns, points=40.0 * yarns.points, radii=40.0 * yarns.radii)
    return Scene(name, curves=(larger,), lights=(SUN,), environment=constant(0.4))


CASES = [
    PathCase("maps", maps),
    PathCase("metal", metal),
    PathCase("brushed", brushed),
    PathCase("specular-glossiness", specular_glossiness),
    PathCase("plaster", plaster),
    PathCase("coated", coated),
    PathCase("films", films),
    PathCase("translucent", translucent),
    PathCase("cloth", cloth),
    PathCase("scattering", scattering),
    PathCase("cloud", cloud, spp=32, settings={
        "volume_density": 9.0, "volume_albedo": (0.95, 0.9, 0.8), "volume_g": 0.4,
        "volume_emission": (0.2, 0.1, 0.0),
        "fog": 0.08, "fog_albedo": (0.9, 0.9, 0.9), "fog_g": 0.3, "fog_height": 0.8}),
    PathCase("hair", hair, spp=96, settings={"hair_melanin": (0.3, 0.2), "hair_roughness": (0.4, 0.3)}),
    PathCase("hair-lamp", hair_lamp, spp=144, settings={
        "hair_melanin": (0.3, 0.2), "hair_roughness": (0.4, 0.3), "bounces": 2}),
    PathCase("denim", denim, settings={"weave": "denim"}),
    PathCase("knitted", knitted, spp=48, settings={"yarn": "wool", "hair_color": (0.1, 0.05, 0.03)}),
    PathCase("interlaced", interlaced, spp=48, settings={"yarn": "cotton", "yarn_fibres": 8, "yarn_hairs": 0.1}),
    PathCase("dispersive", dispersive, spp=192),  # a path has one colour: more noise
    PathCase("glass-smooth", glass_smooth),
    PathCase("glass-rough", glass_rough),
    PathCase("glass-absorbing", glass_absorbing),
    PathCase("glass-thin", glass_thin),
    PathCase("alpha", alpha),
    PathCase("emitters", emitters),
    PathCase("punctual", punctual),
]
