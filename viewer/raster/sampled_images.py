"""The images that a plan samples, and their channels."""

from __future__ import annotations

from collections.abc import Mapping

from ..plan.model import Draw, Plan
from ..plan.planner import plan_scene
from ..scene.decoding import Decoder, Key, Meaning
from ..scene.mask_levels import mask_map
from ..scene.scene import Scene
from ..scene.schema import MAPS
from ..scene.sheen_levels import sheen_map
from ..scene.texture_image import TextureImage
from ..settings import Settings


def decode_ahead(scene: Scene, settings: Settings) -> Decoder:
    """Begin to decode the images that a picture of `scene` samples, before there is an OpenGL context."""
    # The maps that are sampled depend neither on the target nor on the lights.
    plan = plan_scene(scene, settings, (), samples=1, half_target=False, orthographic=False)
    return Decoder(sampled_images(plan, channels_read(plan, {})))


def channels_read(
    plan: Plan, before: Mapping[tuple[TextureImage, Meaning], str]
) -> dict[tuple[TextureImage, Meaning], str]:
    """The channels, R, RGB, RGBA, RGBC or RGBCO, of each image that some map of this plan reads, or has read `before`.

    C is the alpha of a base colour, which covers what is behind it; other maps have another quantity there, and opaque
    base colours (O) show what it would hide.

    An image that two maps share (occlusion and roughness) is stored once for each meaning.
    """
    reads = {image: set(channels) for image, channels in before.items()}
    for draw in plan.draws:
        for name in draw.maps:
            image = MAPS[name].texture(draw.surface).image
            letters = MAPS[name].info.channels
            if name == "base_color":
                letters = "RGBO" if draw.surface.alpha_mode == "opaque" else "RGBC"
            reads.setdefault((image, meaning_of(draw, name)), set()).update(letters)
    return {read: _channels(letters) for read, letters in reads.items()}


def _channels(letters: set[str]) -> str:
    if "C" in letters and "A" not in letters:
        return "RGBCO" if "O" in letters else "RGBC"
    return "R" if letters == {"R"} else "RGBA" if letters & {"A", "C"} else "RGB"


def sampled_images(plan: Plan, channels: Mapping[tuple[TextureImage, Meaning], str]) -> set[Key]:
    """The images that `plan` samples, with the channels that `channels_read` gives."""
    images = {(MAPS[name].texture(draw.surface).image, meaning_of(draw, name))
              for draw in plan.draws for name in draw.maps}
    return {(image, channels[image, meaning], meaning) for image, meaning in images}


def meaning_of(draw: Draw, name: str) -> Meaning:
    """What the numbers of a map of a draw are. It follows from the material, for all passes that read the map."""
    return sheen_map(name, draw.surface) or mask_map(name, draw.surface) or MAPS[name].info.encoding
