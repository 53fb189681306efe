"""Animations are not played; what they claim is checked all the same, so that a broken file is known for one."""

from __future__ import annotations

from .accessors import Accessors
from .element import Element


def check_animations(root: Element, accessors: Accessors) -> None:
    """Raise InputError where a sampler lacks key frames, or has fewer values than key frames."""
    for animation in root.array("animations"):
        samplers = animation.array("samplers")
        for channel in animation.array("channels"):
            channel.index("sampler", len(samplers))
        for sampler in samplers:
            frames = accessors.count(sampler.index("input", len(accessors.items)))
            values = accessors.count(sampler.index("output", len(accessors.items)))
            per_frame = 3 if sampler.string("interpolation", "LINEAR") == "CUBICSPLINE" else 1
            # Morph weights have several values per frame, so only "too few" is always wrong.
            if values < frames * per_frame:
                raise sampler.error(f"{values} values for {frames} key frames", "output")
