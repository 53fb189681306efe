"""Checks animations. They are not played, but a broken file should be reported as broken."""

from __future__ import annotations

from .accessors import Accessors
from .element import Element


def check_animations(root: Element, accessors: Accessors) -> None:
    """Warn that they are not played. Raise InputError if a sampler has no key frames or too few values."""
    animations = root.array("animations")
    if animations:
        root.warn("they are not played; the model is shown in its static pose", "animations")
    for animation in animations:
        samplers = animation.array("samplers")
        for channel in animation.array("channels"):
            channel.index("sampler", len(samplers))
        for sampler in samplers:
            frames = accessors.count(sampler.index("input", len(accessors.items)))
            values = accessors.count(sampler.index("output", len(accessors.items)))
            per_frame = 3 if sampler.string("interpolation", "LINEAR") == "CUBICSPLINE" else 1
            # Morph weights have several values per frame, so more values than frames may be right.
            if values < frames * per_frame:
                raise sampler.error(f"{values} values for {frames} key frames", "output")
