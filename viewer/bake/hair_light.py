"""Light that fibres scatter to each other, by diffusion on a grid of their density.

Many thin fibres are a medium (fibre_grid.py, fibre_medium.py). Light that is scattered among them soon goes all ways
across them. But its inclination to them lasts: sunlight from above is still on its way down deep in fur, where a viewer
at its side sees little of it. So the radiance between fibres is a series of Legendre polynomials of s, the cosine of
the angle to the fibres,

    L(s) = 1 / (4 pi) sum_l (2 l + 1) phi_l P_l(s)

and a diffusion equation (diffusion.py) holds for each moment phi_l, with what others turn into it at fibres.

Diffuse light goes all ways from where it is. But light that goes down in fur keeps going down: at the roots all of it
comes from above. So what comes to a cell is gathered once more along straight ways, from what the fibres there scatter
of the diffuse light (as the final gathering of Jensen 1996 does for surfaces).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..scene.fibre import Fibre
from ..scene.light import Light
from .diffusion import MOST_CORRECTED, diffuse_flux, origin_of, solve, thinned
from .fibre_grid import MEAN_SINE, FibreGrid
from .fibre_medium import ORDERS, fibre_medium
from .many_lights import ManyLights, uniform_lights

_DIRECTIONS = uniform_lights(32, np.ones(3)).directions
_RIDGE = 0.03
"""What keeps `_fitted` solvable where no fibres are."""
_ROUNDS = 2
"""Times that the moments of the inclination are solved for, each from the others of the round before."""


@dataclass(frozen=True, eq=False)
class HairLight:
    """Light that fibres have scattered, on the grid.

    `scattered` (nz, ny, nx, 3) is its mean radiance from where fibres hide the outside. `inclined` (nz, ny, nx, 4) has
    its moments phi_1 to phi_4 over phi_0, in the mean of the channels, less those that it would have if it came evenly
    from there. From a direction d it comes 1 + v . d times, with v `across` (nz, ny, nx, 3), at a right angle to the
    fibres. `depths` has the optical depth (nz, ny, nx) to each light.
    """

    scattered: np.ndarray
    inclined: np.ndarray
    across: np.ndarray
    depths: list[np.ndarray]


class HairMedium:
    """The fibres of `grid`, all like `fibre`, as a medium: all that does not depend on lights.

    `open` (nz, ny, nx, 5) says how open it is in a direction d along fibres t, 1 / (1 + the optical depth to the
    outside) = a + b . d + c (t . d)^2: a, b and c. What fibres hide follows in each channel for itself.
    """

    def __init__(self, grid: FibreGrid, fibre: Fibre, are_yarns: bool = False) -> None:
        self.grid, self.fibre, self.medium = grid, fibre, fibre_medium(fibre)
        self._are_yarns = are_yarns
        self._extinction = grid.density * np.float32(MEAN_SINE)
        self._axis, self._order = grid.moments()
        self._open = np.zeros((ORDERS, 3, *grid.shape), np.float32)
        depths = np.stack([grid.depth(direction) for direction in _DIRECTIONS])
        self.open = _fitted(depths, _DIRECTIONS, self._axis)
        # of a channel, after and before
        self._transfer = (self.medium.inclined * self.medium.albedo[:, None, None]).astype(np.float32)
        around = np.zeros((ORDERS, 3, *grid.shape), np.float32)
        for direction, depth in zip(_DIRECTIONS, depths, strict=True):
            self._add(around, self._passed(depth) / np.float32(len(_DIRECTIONS)), direction)
        # Under light from all around what fibres scatter comes evenly from all sides, but what reaches them does not.
        self._open[1:] = around[1:] / np.maximum(around[0], 1e-30)
        self._white = self._diffused(around[:1], np.ones_like(around[:1]))[0]
        # In a medium that absorbs nothing, under radiance 1 from everywhere, all radiance is 1 (diffusion.py): what
        # fibres meet of it, `others` have scattered where it has not come from the outside.
        others = np.maximum(1 - around[0], 0)
        self._correction = others / np.maximum(self._white, np.maximum(others / MOST_CORRECTED, 1e-30))
        even = np.zeros_like(around)
        even[0] = 1
        self._hidden = self._from_around(even)

    def lit(self, lights: Iterable[Light], sky: ManyLights | None) -> HairLight:
        """The light of `lights` and of the environment, `sky`."""
        grid, depths = self.grid, []
        around = np.zeros((ORDERS, 3, *grid.shape), np.float32)
        if sky is not None:
            for direction, irradiance in zip(sky.directions, sky.irradiance, strict=True):
                arriving = self._passed(grid.depth(direction)) * _channels(irradiance)
                self._add(around, arriving, direction)
        for light in lights:
            if light.kind == "directional":
                towards = -np.array(light.direction)
                depth = grid.depth(towards)
            else:
                way = np.array(light.position) - grid.centers
                towards = (way / np.maximum(np.linalg.norm(way, axis=1), 1e-30)[:, None]).T.reshape(3, *grid.shape)
                depth = grid.depth_to(np.array(light.position))
            depths.append(depth)
            irradiance = _irradiance(light, grid.centers).reshape(grid.shape)
            self._add(around, self._passed(depth) * irradiance * _channels(light.color), towards)
        phi = self._lit(around)
        scattered, inclined = (self._diffuse(phi) if self._are_yarns else
                               self._gathered(around + phi * self._correction))
        return HairLight(np.moveaxis(scattered, 0, -1), np.moveaxis(inclined, 0, -1), self._across(phi[0]), depths)

    def _add(self, light: np.ndarray, arriving: np.ndarray, direction: np.ndarray) -> None:
        """Add light that no fibre has scattered, `arriving` (3, nz, ny, nx) from `direction`, (3,) or (3, nz, ny, nx),
        to the moments in `light` (ORDERS, 3, nz, ny, nx). It counts times the extinction in its direction over the mean
        of all."""
        d = np.asarray(direction, np.float32)
        arriving = arriving * (self.grid.extinction(d) / np.maximum(self._extinction, 1e-30))
        light += arriving * ((self._legendre(d) * self._order)[:, None] - self._open)

    def _legendre(self, direction: np.ndarray) -> np.ndarray:
        """P_l of the inclination of `direction`, (3,) or (3, nz, ny, nx), to the fibres: (ORDERS, nz, ny, nx)."""
        d = np.asarray(direction, np.float32)
        legendre = np.polynomial.legendre.legvander(sum(self._axis[k] * d[k] for k in range(3)), ORDERS - 1)
        return np.moveaxis(legendre, -1, 0).astype(np.float32)

    def _diffuse(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """`scattered` and `inclined` (HairLight) of diffuse light. Cloth is as thin as a cell or two, in which straight
        ways say no more."""
        scattered = np.maximum(phi[0], 0) / np.maximum(self._white, np.maximum(self._hidden[0] / MOST_CORRECTED, 1e-30))
        inclined = phi[1:].sum(axis=1) / np.maximum(phi[0].sum(axis=0), 1e-30)
        return scattered / np.float32(4 * math.pi), np.clip(inclined, -1, 1)

    def _gathered(self, light: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """`scattered` and `inclined` (HairLight) of what fibres scatter of `light` (ORDERS, 3, nz, ny, nx)."""
        phi = self._from_around(self._turned(light))
        scattered = phi[0] / np.maximum(self._hidden[0], 1e-6)
        inclined = (phi[1:] - scattered * self._hidden[1:]).sum(axis=1) / np.maximum(phi[0].sum(axis=0), 1e-30)
        return scattered / np.float32(4 * math.pi), np.clip(inclined, -1, 1)

    def _from_around(self, given: np.ndarray) -> np.ndarray:
        """The moments of what comes along straight ways from fibres that scatter light of the moments `given`, both
        (ORDERS, 3, nz, ny, nx)."""
        series = given * (2 * np.arange(ORDERS, dtype=np.float32) + 1)[:, None, None, None, None]
        phi = np.zeros_like(given)
        for direction in _DIRECTIONS:
            legendre = self._legendre(direction)
            source = np.maximum(np.einsum("lczyx,lzyx->czyx", series, legendre), 0)
            phi += self.grid.gathered(direction, source, self.medium.kept) * legendre[:, None]
        return phi / np.float32(len(_DIRECTIONS))

    def _across(self, fluence: np.ndarray) -> np.ndarray:
        """Where light of this fluence (3, nz, ny, nx) comes from across the fibres (`origin_of`), less where it would
        come from in white fibres under light from all around, in each channel."""
        resistance = 1.5 * self._reduced(self._extinction * _channels(self.medium.kept))
        share = fluence / np.maximum(self._white, 1e-30)
        white = [share * part for part in diffuse_flux(self._white, resistance)]
        found = origin_of(fluence, diffuse_flux(fluence, resistance)) - origin_of(fluence, white)
        axis = np.moveaxis(self._axis, 0, -1)
        return found - axis * (axis * found).sum(axis=-1, keepdims=True)

    def _passed(self, depth: np.ndarray) -> np.ndarray:
        return np.exp(-_channels(self.medium.kept) * depth)

    def _lit(self, light: np.ndarray) -> np.ndarray:
        """The moments of what fibres have scattered of `light`, both (ORDERS, 3, nz, ny, nx)."""
        own = np.einsum("cll->lc", self._transfer)[..., None, None, None] * self._order[:, None]
        phi = np.zeros_like(light)
        for _ in range(_ROUNDS):
            phi = self._diffused(self._turned(light + phi) - own * phi, own)
        return phi

    def _turned(self, light: np.ndarray) -> np.ndarray:
        """The moments of `light` (ORDERS, 3, nz, ny, nx) after one fibre."""
        turned: np.ndarray = np.einsum("clm,mczyx->lczyx", self._transfer, light) * self._order[:, None]
        return turned

    def _diffused(self, given: np.ndarray, albedos: np.ndarray) -> np.ndarray:
        """What becomes of light that fibres scatter, `given` times their extinction: all (k, 3, nz, ny, nx)."""
        depth = self._extinction * _channels(self.medium.kept)
        shape = (-1, *self.grid.shape)
        sigma_t = np.broadcast_to(thinned(depth), given.shape).reshape(shape)
        scale = max(float(np.abs(given).max()), 1e-30)
        source = (depth * (given / np.float32(scale))).reshape(shape)
        phi = solve(sigma_t, albedos.reshape(shape), self._reduced(sigma_t), source)
        return phi.reshape(given.shape) * np.float32(scale)

    def _reduced(self, depth: np.ndarray) -> np.ndarray:
        return depth + np.float32(1 / min(self.grid.shape))  # a mean free path is no longer than the grid


def _fitted(depths: np.ndarray, directions: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """a, b and c (nz, ny, nx, 5) of `HairMedium.open`, by least squares. `depths` (n, nz, ny, nx) are those in the
    `directions` (n, 3), and `axis` is (3, nz, ny, nx)."""
    d = directions.astype(np.float32)
    terms = np.empty((5, *depths.shape), np.float32)
    terms[0] = 1
    terms[1:4] = d.T[:, :, None, None, None]
    terms[4] = np.einsum("nk,kzyx->nzyx", d, axis)**2
    normal = np.einsum("inzyx,jnzyx->zyxij", terms, terms) + _RIDGE * np.eye(5, dtype=np.float32)
    right = np.einsum("inzyx,nzyx->zyxi", terms, 1 / (1 + depths))
    found: np.ndarray = np.linalg.solve(normal, right[..., None])[..., 0]
    return found


def _channels(values: ArrayLike) -> np.ndarray:
    """(3,) as (3, 1, 1, 1) float32."""
    return np.asarray(values, np.float32)[:, None, None, None]


def _irradiance(light: Light, points: np.ndarray) -> np.ndarray:
    """Of a light on a surface that faces it at each of `points`, before any fibre, (points,)."""
    if light.kind == "directional":
        return np.full(len(points), light.intensity)
    way = np.asarray(light.position) - points
    distance = np.maximum(np.linalg.norm(way, axis=1), 1e-30)
    irradiance = light.intensity / distance**2
    if light.range:
        irradiance *= np.clip(1 - (distance / light.range)**4, 0, 1)
    if light.kind == "spot":
        scale, offset = light.cone
        apart = way / distance[:, None] + np.asarray(light.direction)
        irradiance *= np.clip(offset - scale * 0.5 * (apart**2).sum(axis=1), 0, 1)**2
    return irradiance
