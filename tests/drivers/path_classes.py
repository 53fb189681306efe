"""Whether a driver tells the path tracer's classes of paths apart, which it stores and compares as depths."""

from __future__ import annotations

import moderngl
import numpy as np

from viewer.gpu.context import Context
from viewer.gpu.fullscreen import fullscreen
from viewer.gpu.programs import Programs, set_uniform
from viewer.trace.defines import shader_defines
from viewer.trace.layout import (
    CLASS_ENDED,
    CLASS_FIRST_HIT,
    CLASS_IDLE,
    CLASS_SHADE,
    ENDED,
    IDLE,
    IN_FLIGHT,
    KIND_SHIFT,
    NO_KIND,
)
from viewer.trace.paths.wavefront import STATE, UNITS, Wavefront

COUNT = CLASS_SHADE + NO_KIND
"""Classes, if there were as many kinds of surfaces as a hit has numbers for."""


def shaded(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Which paths the pass of each class shades, and which it should, (2, classes, H, W) bool each: first of all paths,
    then of first hits."""
    programs = Programs(context)
    wavefront = Wavefront(context, 3, 2, textures=len(STATE), has_layers=False)
    rng, shape = np.random.default_rng(3), wavefront.size[::-1]
    status, kind = rng.choice([IDLE, IN_FLIGHT, ENDED], shape), rng.integers(0, NO_KIND + 1, shape)
    depth = rng.integers(0, 2, shape)
    fields = {"origin": status, "radiance": depth << 16}  # as `pack_counters` of shaders/trace/state.glsl has it
    for name, values in fields.items():
        texels = np.zeros((*shape, 4), np.float32)
        texels[..., 3] = values
        getattr(wavefront, name).write(texels.tobytes())
    hits = np.zeros((*shape, 4), np.uint32)
    hits[..., 0] = kind << KIND_SHIFT
    wavefront.hit.write(hits.tobytes())
    classes = np.where(status == IDLE, CLASS_IDLE, CLASS_SHADE + kind)
    classes[(status != IDLE) & ((status == ENDED) | (kind == NO_KIND))] = CLASS_ENDED
    first = np.where((classes >= CLASS_SHADE) & (depth == 0), CLASS_FIRST_HIT, CLASS_IDLE)
    found = [[_shaded(context, programs, wavefront, number, first_hits) for number in range(COUNT)]
             for first_hits in (0, 1)]
    expected = [[wanted == number for number in range(COUNT)] for wanted in (classes, first)]
    wavefront.release()
    programs.release()
    return np.array(found), np.array(expected)


def _shaded(context: Context, programs: Programs, wavefront: Wavefront, number: int, first_hits: int) -> np.ndarray:
    names = ("HAS_TRANSMISSION", "HAS_VOLUME", "HAS_SCATTERING", "HAS_PANES", "HAS_NESTED", "HAS_AIRLIGHT", "HAS_GRIDS",
             "HAS_FOG", "HAS_CURVES", "HAS_LIGHT_TREE", "HAS_SEE_THROUGH", "DISPERSIVE", "SAMPLING")
    switches = dict.fromkeys(names, 0)
    switches["FIRST_HITS"] = first_hits
    classify = programs.get("trace/path_class.vert", "trace/classify.frag", shader_defines(switches))
    zero = programs.get("trace/path_class.vert", "trace/zero.frag", shader_defines({}))
    wavefront.sums.framebuffer.clear(1.0, 1.0, 1.0, 1.0)
    wavefront.bind()
    for name, unit in UNITS.items():
        set_uniform(classify, name, unit)
    set_uniform(zero, "u_path_class", number)
    context.gl.enable_only(moderngl.DEPTH_TEST)
    for target, compare, program in ((wavefront.classes, "1", classify), (wavefront.sums.framebuffer, "==", zero)):
        target.use()
        context.gl.depth_func = compare
        fullscreen(context.gl, program).render(vertices=3)
    context.gl.depth_func = "<"
    texels = np.frombuffer(wavefront.sums.textures[0].read(), np.float32)
    return texels.reshape(*wavefront.size[::-1], 4)[..., 0] == 0
