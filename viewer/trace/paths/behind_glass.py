"""How much of what photons bring is seen only through smooth glass, and so is not in the picture."""

from __future__ import annotations

import numpy as np

from ..rays.intersect import Intersector
from .photon_passes import PhotonPasses
from .wavefront import Sums, Wavefront


class BehindGlass:
    """Measures it on the first round of photons. The camera's ray to each vertex that it does not see is traced: if the
    first that it meets is smooth glass, the vertex is seen through that, though not at the same place of the picture.

    What is seen in mirrors is not measured: no ray says where.
    """

    def __init__(self, passes: PhotonPasses, intersector: Intersector, wavefront: Wavefront) -> None:
        self._passes, self._intersector, self.rays = passes, intersector, wavefront
        self._light = Sums(passes.context.gl, (1, 1), 1)

    def measure(self) -> None:
        """Trace the rays that `PhotonPasses.shade_onto` has written, and add up the light at their ends."""
        self._intersector.store(self.rays, self._intersector.trace(self._intersector.fetch(self.rays)))
        self._passes.weigh(self.rays, self._light)

    @property
    def share(self) -> float:
        """The light behind smooth glass, over that and what the camera sees; 0 if there is none."""
        seen, behind = np.frombuffer(self._light.framebuffer.read(components=4, dtype="f4"), np.float32)[:2].tolist()
        return behind / (seen + behind) if behind > 0 else 0.0

    def release(self) -> None:
        self.rays.release()
        self._light.release()
