"""Which images a plan samples, and which of their channels."""

from __future__ import annotations

from collections.abc import Mapping

from ..material.maps import CHANNELS, MAPS, material_map
from ..plan.model import Plan
from ..plan.planner import plan_scene
from ..scene.decoding import Decoder, Key
from ..scene.scene import Scene
from ..scene.texture_image import TextureImage
from ..settings import Settings


def decode_ahead(scene: Scene, settings: Settings) -> Decoder:
    """Begin with the images that a picture of `scene` will sample, before there is a context to draw it with."""
    # Which maps are sampled depends neither on the target nor on the lights.
    plan = plan_scene(scene, settings, (), samples=1, half_target=False, orthographic=False)
    return Decoder(sampled_images(scene, plan, channels_read(scene, plan, {})))


def channels_read(
    scene: Scene, plan: Plan, before: Mapping[tuple[TextureImage, bool], str]
) -> dict[tuple[TextureImage, bool], str]:
    """The channels of each image that some map reads, in this plan or `before`: R, RGB or RGBA.

    An image used twice (occlusion and roughness) is stored once.
    """
    reads = {image: set(channels) for image, channels in before.items()}
    for draw in plan.draws:
        material = scene.materials[draw.material]
        for name in draw.maps:
            opaque = name == "base_color" and material.alpha_mode == "opaque"
            image = material_map(material, name).image
            reads.setdefault((image, MAPS[name]), set()).update("RGB" if opaque else CHANNELS[name])
    return {image: "R" if letters == {"R"} else "RGBA" if "A" in letters else "RGB"
            for image, letters in reads.items()}


def sampled_images(scene: Scene, plan: Plan, channels: Mapping[tuple[TextureImage, bool], str]) -> set[Key]:
    """What has to be decoded for `plan`, given what `channels_read` says."""
    images = {(material_map(scene.materials[draw.material], name).image, MAPS[name])
              for draw in plan.draws for name in draw.maps}
    return {(image, channels[image, srgb], srgb) for image, srgb in images}
