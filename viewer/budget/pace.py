"""Predicts how long the next frame, or the next samples, of a scene take, from what was measured on it."""

from __future__ import annotations

import math

from ..scene.scene import Scene
from ..settings import Settings

SURE, ALIKE, GUESSED = 1.1, 1.2, 1.5
"""Times what was measured; what follows from frames of the same programs; and what follows from something else. A frame
that was drawn before takes what it took: a budget counts as held up to 1.2 times."""
SHADED = 2 / 3
"""Of a frame: a further point that is shaded in each pixel. Vertices are not shaded again."""
LOOKUPS, LOOKUP = 3.3, 1 / 24
"""Frames: the visibility of the environment, and of one light's shadow map."""
MAP = 2.0
"""Small frames: one shadow map, which shows all triangles, in a larger target."""
RESOLVE = 0.1
"""Of the first frame: the first one with another antialiasing."""
UNKNOWN = 10.0
"""Frames: what programs take that this process compiled before it was watched."""
PATH_FIRSTS, PATH_START_S, TRIANGLE_S = 1.5, 0.5, 2e-6
"""Preparing the paths of a scene: the raster's first frames, whose programs are fewer; what no scene is spared; and the
tree, a triangle."""
SAMPLE = 5.0
"""Frames: one path a pixel."""


def maps(settings: Settings) -> int:
    """Shadow maps for the environment."""
    return 0 if settings.environment_shadows == "off" else int(settings.environment_shadows)


def work(settings: Settings) -> float:
    """Of a frame, in frames of one shaded point a pixel."""
    shaded = 1 + SHADED * (settings.supersampling**2 - 1)
    return shaded + (LOOKUPS + LOOKUP * maps(settings) if maps(settings) else 0)


class Pace:
    """Of one scene in one size; of another, nothing is known. Seconds."""

    def __init__(self) -> None:
        self._of: tuple[Scene, tuple[int, int]] | None = None
        self._forget()
        self.combine: float | None = None
        """Of a pixel, for the combination with paths. It does not depend on the scene."""

    def _forget(self) -> None:
        self.first: float | None = None
        """The first frame with all its preparation, if that was seen."""
        self.textures = 0.0
        """Of that for textures."""
        self.small: float | None = None
        """A frame of few pixels."""
        self.frames: dict[Settings, float] = {}
        """Once all is prepared."""
        self.sample: float | None = None
        """One path a pixel, once the scene is prepared."""
        self._map: float | None = None
        self._maps = 0

    def of(self, scene: Scene, size: tuple[int, int], is_held: bool) -> None:
        """`is_held`: the raster holds the scene's triangles and textures."""
        if not is_held or self._of is None or self._of[0] is not scene or self._of[1] != size:
            self._forget()
        self._of = scene, size

    def drawn(self, settings: Settings, seconds: float, shadows: float) -> None:
        """A frame; `shadows` of its seconds were for maps for the environment, if only to see that these are held."""
        self.frames[settings] = min(seconds - shadows, self.frames.get(settings, math.inf)) if shadows else seconds
        if maps(settings) not in (0, self._maps):
            self._map, self._maps = shadows / maps(settings), maps(settings)

    def knows(self, settings: Settings) -> bool:
        """Whether the raster has drawn such a frame, or one with the same maps, which are there, and programs."""
        most = max((drawn.supersampling for drawn in self.frames), default=0)
        return settings in self.frames or (0 < maps(settings) == self._maps and settings.supersampling <= most)

    def frame(self, settings: Settings) -> float:
        """A picture by the raster, with what it has to prepare; infinite as long as none was drawn."""
        count = maps(settings)
        each = self._map if self._map is not None else math.inf if self.small is None else MAP * self.small
        drawing = each * count if count not in (0, self._maps) else 0.0
        alike = [drawn for drawn in self.frames if bool(maps(drawn)) == bool(count)] or list(self.frames)
        likely = min((self.frames[drawn] * work(settings) / work(drawn) for drawn in alike), default=math.inf)
        if settings in self.frames:  # what it compiled the first time is no part of it now
            return min(self.frames[settings], ALIKE * likely) + SURE * drawing
        if self.knows(settings):
            return max(likely, min(self.frames.values()))
        compiling = self.first - self.textures if self.first is not None else UNKNOWN * likely
        compiling *= 1.0 if count and not any(map(maps, self.frames)) else RESOLVE
        return GUESSED * (likely + drawing + compiling)

    def paths(self, scene: Scene, is_held: bool, samples: float) -> float:
        """So many path-traced samples a pixel, with what is to be prepared."""
        if is_held and self.sample is not None:
            return samples * self.sample
        plain = min(self.frames.values(), default=math.inf)
        begin = PATH_FIRSTS * (self.first or 0.0) + PATH_START_S + TRIANGLE_S * scene.triangle_count
        return begin + samples * SAMPLE * plain
