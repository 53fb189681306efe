"""Reads animations. What is no animation at all is an error; what only cannot be played is left out, with a warning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..animation import Animation, Interpolation, Target, Track
from .accessors import Accessors
from .element import Element
from .nodes import Nodes
from .pointers import Pointers

_INTERPOLATIONS: dict[str, Interpolation] = {"LINEAR": "linear", "STEP": "step", "CUBICSPLINE": "cubic"}
_PATHS = ("translation", "rotation", "scale", "weights")
_ELEMENTS = 64
"""A track takes the memory of so many elements of an accessor."""


def read_animations(root: Element, accessors: Accessors, nodes: Nodes) -> tuple[Animation, ...]:
    """All animations of the file. Raises InputError for references and counts that are wrong."""
    animations, pointers = [], Pointers(root)
    for number, animation in enumerate(root.array("animations")):
        samplers = animation.array("samplers")
        tracks = []
        for channel in animation.array("channels"):
            sampler = samplers[channel.index("sampler", len(samplers))]
            tracks += _tracks(pointers, channel, sampler, accessors, nodes)
        if tracks:
            animations.append(Animation(animation.string("name", "") or f"animation {number}", tuple(tracks)))
    return tuple(animations)


def _tracks(pointers: Pointers, channel: Element, sampler: Element, accessors: Accessors,
            nodes: Nodes) -> list[Track]:
    """The track of a channel: none, with a warning, if it moves nothing, and several if a pointer names several."""
    element = channel.object("target")
    node = element.index("node", len(nodes.items), None)
    path = element.string("path")
    extension = element.extension("KHR_animation_pointer") if path == "pointer" else None
    if extension is not None:
        pointer = extension.string("pointer")
        found = pointers.resolve(pointer)
        if found is None:
            extension.warn(f"{pointer[:80]!r} is not in the file, or is not drawn; the channel is left out", "pointer")
    elif node is None:
        found = None
        element.warn(f"{path[:20]!r} of no node; the channel is left out")
    else:
        found = pointers.resolve(f"/nodes/{node}/{path}") if path in _PATHS else None
        if found is None:
            problem = "there are no morph targets" if path == "weights" else f"{path[:20]!r} is unknown"
            element.warn(f"{problem}; the channel is left out", "path")
    targets = found[0] if found is not None else []
    fixed = [target for target in targets if target.kind == "node" and target.number in nodes.hierarchy.matrices
             and not target.name.startswith("weights")]
    if fixed:
        element.warn(f"nodes[{fixed[0].number}] has a matrix, which cannot be animated; the channel is left out")
    if found is None or not targets or fixed:
        _checked_counts(sampler, accessors)
        return []
    accessors.claim(channel, _ELEMENTS * len(targets))
    first = read_sampler(sampler, accessors, targets[0], found[1].kind, found[1].size)
    return [] if first is None else [first, *(replace(first, target=target) for target in targets[1:])]


def read_sampler(sampler: Element, accessors: Accessors, target: Target, kind: str, size: int) -> Track | None:
    """The key frames of a sampler, whose values are of the accessor's type `kind` and have `size` numbers, or any
    number if it is 0. None, with a warning, if the key frames are in no order or not finite.

    Raises InputError for counts that do not fit, and for more key frames in all than the file's size allows: any number
    of channels may share a sampler's accessors.
    """
    interpolation = sampler.choice("interpolation", _INTERPOLATIONS, "LINEAR")
    first, second, per_frame = _checked_counts(sampler, accessors)
    times = accessors.floats(first, "SCALAR")[:, 0]
    stored = accessors.floats(second, kind)
    accessors.claim(sampler, len(times) + len(stored))  # of each channel anew: its key frames are checked, and kept
    if size == 0:
        size = len(stored) // (len(times) * per_frame)
    else:
        size = stored.shape[1]
    values = stored.reshape(-1)[:len(times) * per_frame * size]
    if not np.isfinite(times).all() or (np.diff(times) < 0).any():
        sampler.warn("times must be finite, each after the one before; what it moves stands still", "input")
        return None
    if not np.isfinite(values).all():
        sampler.warn("values must be finite; what it moves stands still", "output")
        return None
    shape = (len(times), 3, size) if interpolation == "cubic" else (len(times), size)
    return Track(target, times, values.reshape(shape), interpolation)


def _checked_counts(sampler: Element, accessors: Accessors) -> tuple[int, int, int]:
    """The accessors of times and of values, and how many values a key frame has at least."""
    first = sampler.index("input", len(accessors.items))
    second = sampler.index("output", len(accessors.items))
    frames, values = accessors.count(first), accessors.count(second)
    per_frame = 3 if sampler.string("interpolation", "LINEAR") == "CUBICSPLINE" else 1
    if values < frames * per_frame:
        raise sampler.error(f"{values} values for {frames} key frames", "output")
    return first, second, per_frame
