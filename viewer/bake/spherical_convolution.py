"""Convolves an equirectangular map with rotationally symmetric (zonal) kernels, by spherical harmonics.

Such a kernel scales all harmonics of degree l by one number (Funk-Hecke; Driscoll and Healy 1994):

    f = sum_lm a_lm Y_lm   =>   (K * f) = sum_lm lambda_l a_lm Y_lm,
    lambda_l = 2 pi integral K(theta) P_l(cos theta) sin theta dtheta

So the cost does not depend on the width of the kernel, and a filter for a rough surface is as exact as one for a smooth
surface. The axis of the harmonics is +Y, as that of the maps: Y_lm = P_lm(cos theta) e^(i m phi) / sqrt(2 pi), where
the integral of P_lm^2 over cos theta is 1. The transform along longitude is then a Fourier transform, and along
latitude one small matrix product for each order m. Rows i and H-1-i have the same Legendre values up to the sign
(-1)^(l-m).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..scene.equirect import sphere_integral, texel_solid_angles

ORDERS_AT_ONCE = 16  # limits the Legendre table: 16 orders x 256 degrees x 480 rows in float32 take 8 MB


@dataclass(frozen=True)
class Filter:
    """A kernel, given by its `spectrum` lambda_0 .. lambda_L, and the rows of the map that it shall produce.

    `theta` has the polar angles of the rows of the upper half; the lower half mirrors them, and the map is twice as
    wide as high. A negative theta is beyond the pole: its row has the values at -theta, rotated by half a turn.
    """

    theta: np.ndarray
    spectrum: np.ndarray

    @property
    def height(self) -> int:
        return 2 * len(self.theta)


def convolve(radiance: np.ndarray, filters: Sequence[Filter]) -> list[np.ndarray]:
    """One filtered map, (h, 2h, 3) float32, for each filter.

    `radiance` (H, W, 3) must have an even height greater than the degree of every filter. Texels are taken as constant
    over their solid angle. The mean is removed before the transform, so a constant map is reproduced exactly, and a
    kernel with lambda_0 = 1 does not change the total. Degrees at or above a filter's height are dropped, since its map
    could not represent them.
    """
    return convolve_each([radiance], filters)[0]


def convolve_each(maps: Sequence[np.ndarray], filters: Sequence[Filter]) -> list[list[np.ndarray]]:
    """What `convolve` returns for each of several maps of one size; the Legendre functions are computed once."""
    height = len(maps[0])
    half = height // 2
    degree = max(min(len(f.spectrum), f.height) for f in filters) - 1
    means = [sphere_integral(radiance) / (4 * np.pi) for radiance in maps]
    waves_of = [_longitude_waves(radiance, mean, degree) for radiance, mean in zip(maps, means)]
    latitudes = [np.pi * (np.arange(half) + 0.5) / height] + [f.theta for f in filters]
    ends = np.cumsum([len(theta) for theta in latitudes])
    spans = [slice(end - len(theta), end) for end, theta in zip(ends, latitudes)]
    spectra = [np.asarray(f.spectrum[:min(f.height, degree + 1)], np.float32) for f in filters]
    rows_of = [[np.zeros((f.height, 3, f.height + 1), np.complex64) for f in filters] for _ in maps]

    for first, table in legendre_tables(degree, np.concatenate(latitudes)):
        for m, values in enumerate(table, start=first):
            values = values[m:]  # degrees m .. L, at every latitude of the upper half
            for waves, rows in zip(waves_of, rows_of):
                a = np.empty((degree + 1 - m, 6), np.float32)
                a[0::2] = values[0::2, spans[0]] @ waves[0, m]
                a[1::2] = values[1::2, spans[0]] @ waves[1, m]
                for spectrum, span, out in zip(spectra, spans[1:], rows):
                    count = len(spectrum) - m
                    if count <= 0:
                        continue
                    scaled = a[:count] * spectrum[m:, None]
                    even = (values[0:count:2, span].T @ scaled[0::2]).view(np.complex64)
                    odd = (values[1:count:2, span].T @ scaled[1::2]).view(np.complex64)
                    out[:len(even), :, m] = even + odd
                    out[len(even):, :, m] = (even - odd)[::-1]
    return [[_from_waves(row, mean) for row in rows] for rows, mean in zip(rows_of, means)]


def legendre_tables(degree: int, theta: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Normalised P_lm(cos theta) for m <= l <= degree, in blocks of orders: yields (first m, table), where the table is
    (orders, degree + 1, N) float32.

    Each block overwrites the one before. Its rows l < first are not set.

    The values follow from a three-term recurrence in l that starts with
    P_mm = sqrt((2m+1)/2m) sin(theta) P_(m-1)(m-1) and is stable for increasing l. It runs in float64, because rounding
    errors grow with l. The table is float32, because the values are only summed afterwards.
    """
    sines, cosines = np.sin(theta), np.cos(theta)
    sectoral = np.full(len(theta), np.sqrt(0.5))
    whole = np.empty((min(ORDERS_AT_ONCE, degree + 1), degree + 1, len(theta)), np.float32)
    for first in range(0, degree + 1, ORDERS_AT_ONCE):
        orders = np.arange(first, min(first + ORDERS_AT_ONCE, degree + 1))
        table = whole[:len(orders)]
        table[:, first:first + len(orders)] = 0  # where l < m
        last, older, scratch = (np.zeros((len(orders), len(theta))) for _ in range(3))
        for l in range(first, degree + 1):  # noqa: E741  the usual name for the degree of a harmonic
            begun = min(l - first, len(orders))  # orders m < l follow the recurrence; m = l starts
            if begun:
                m2 = (orders[:begun, None] ** 2).astype(np.float64)
                lead = np.sqrt((4.0 * l * l - 1) / (l * l - m2))
                trail = np.sqrt(np.maximum((l - 1.0) ** 2 - m2, 0) / (4.0 * (l - 1.0) ** 2 - 1))
                np.multiply(last[:begun], cosines, out=scratch[:begun])
                older[:begun] *= trail
                scratch[:begun] -= older[:begun]
                scratch[:begun] *= lead
            if begun < len(orders):
                if l > 0:
                    sectoral = sectoral * sines * np.sqrt((2 * l + 1) / (2 * l))
                scratch[begun] = sectoral
                begun += 1
            table[:begun, l] = scratch[:begun]
            older, last, scratch = last, scratch, older
        yield first, table


def _longitude_waves(radiance: np.ndarray, mean: np.ndarray, degree: int) -> np.ndarray:
    """Integrals over longitude times e^(-i m phi), for even and odd l - m: (2, degree + 1, H/2, 6) float32 (re, im)."""
    height, width = radiance.shape[:2]
    half = height // 2
    weights = texel_solid_angles(height, width)[:half, None, None] / np.sqrt(2 * np.pi)
    m = np.arange(degree + 1)
    phase = np.exp(-1j * m * (np.pi / width - np.pi))
    waves = np.empty((2, degree + 1, half, 3), np.complex64)
    for channel in range(3):  # one by one: the copies made by the transform are the bake's peak of memory
        upper = radiance[:half, :, channel] - np.float32(mean[channel])
        lower = radiance[:half - 1:-1, :, channel] - np.float32(mean[channel])
        for parity, rows in enumerate((upper + lower, upper - lower)):
            transform = np.fft.rfft(rows, axis=1)[:, :degree + 1]
            waves[parity, :, :, channel] = (transform * (weights[:, 0] * phase)).T
    return waves.view(np.float32)


def _from_waves(rows: np.ndarray, mean: np.ndarray) -> np.ndarray:
    """Back from the coefficients of e^(i m phi), (h, 3, h + 1) complex64, to the map (h, 2h, 3) float32."""
    width = 2 * rows.shape[0]
    phase = np.exp(1j * np.arange(rows.shape[2]) * (np.pi / width - np.pi)) * (width / np.sqrt(2 * np.pi))
    values = np.fft.irfft(rows * phase.astype(np.complex64), n=width, axis=2)
    return np.ascontiguousarray(values.swapaxes(1, 2), np.float32) + mean.astype(np.float32)
