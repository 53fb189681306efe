"""shaders/sample/sobol.glsl against Sobol's sequence from its direction numbers, and its stratification."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.gpu.call import call_glsl
from viewer.measure.check.chi_squared import critical_value, statistic

FILE = "sample/sobol.glsl"
BITS = 24


def direction_numbers() -> np.ndarray:
    """(4, 24) integers v of fractions v / 2^24: Joe & Kuo 2008, new-joe-kuo-6, dimensions 1 to 4."""
    out = np.zeros((4, BITS), np.int64)
    out[0] = 1 << np.arange(BITS - 1, -1, -1)
    for row, (degree, a, first) in zip(out[1:], [(1, 0, [1]), (2, 1, [1, 3]), (3, 1, [1, 3, 1])]):
        for j in range(BITS):
            if j < degree:
                row[j] = first[j] << (BITS - 1 - j)
                continue
            row[j] = row[j - degree] ^ (row[j - degree] >> degree)
            for i in range(1, degree):
                if a >> (degree - 1 - i) & 1:
                    row[j] ^= row[j - i]
    return out


def points(context, count: int, seed: int) -> np.ndarray:
    """The first points of a sequence, (count, 4) integers of 2^-24."""
    found = call_glsl(FILE, "sobol_owen", index=np.arange(count, dtype=np.uint32), seed=seed, context=context)
    assert (found >= 0).all() and (found < 1).all()
    return np.rint(found.astype(np.float64) * 2**BITS).astype(np.int64)


def test_sobol_without_table(context):
    """The evaluation by blocks equals the recurrence of the direction numbers, over all 24 bits."""
    index = np.concatenate([np.arange(256), 1 << np.arange(BITS), np.random.default_rng(1).integers(0, 1 << BITS, 500)])
    bits = index[:, None] >> np.arange(BITS) & 1
    expected = np.bitwise_xor.reduce(np.where(bits[:, None] > 0, direction_numbers(), 0), axis=2)
    mirrored = call_glsl(FILE, "sobol", index=index.astype(np.uint32), context=context).astype(np.int64)
    found = sum((mirrored >> k & 1) << (BITS - 1 - k) for k in range(BITS))
    assert (found == expected).all()


@pytest.mark.parametrize("seed", [0, 1, 0xFFFFFFFF])
def test_every_pair_is_a_net(context, seed):
    """2^m points, 2^t in every elementary rectangle of 2^(t - m): t is known for these pairs of Sobol's dimensions."""
    m = 10
    found = points(context, 3 << m, seed).reshape(3, 1 << m, 4)  # also the second and third 2^m in a row
    quality = {(0, 1): 0, (0, 2): 1, (0, 3): 2, (1, 2): 1, (1, 3): 2, (2, 3): 3}
    for (i, j), t in quality.items():
        for a in range(m - t + 1):
            b = m - t - a
            cell = (found[..., i] >> (BITS - a)) << b | found[..., j] >> (BITS - b)
            for run in cell:
                assert (np.bincount(run, minlength=1 << (m - t)) == 1 << t).all(), (i, j, a, b)
    for i in range(4):
        assert (np.sort(found[..., i] >> (BITS - m), axis=1) == np.arange(1 << m)).all()


def test_scrambled_points_are_uniform(context):
    """First points of many sequences: any two dimensions fill 8 x 8 bins evenly, and low bits are fair."""
    found = np.rint(call_glsl(FILE, "sobol_owen", index=5, seed=np.arange(1 << 16), context=context) * 2**BITS)
    found = found.astype(np.int64)
    tests = [(i, j, shift) for i in range(4) for j in range(i) for shift in (0, 8, BITS - 3)]
    for i, j, shift in tests:
        counts = np.bincount((found[:, i] >> shift & 7) * 8 + (found[:, j] >> shift & 7), minlength=64)
        value, degrees = statistic(counts, np.full(64, len(found) / 64))
        assert value < critical_value(degrees, len(tests)), (i, j, shift)


def test_sequences_are_independent(context):
    """Neighbouring seeds, as pixels have: the same index of both fills 8 x 8 bins evenly, in every dimension."""
    seeds = 2 * np.arange(1 << 15)
    first, second = (call_glsl(FILE, "sobol_owen", index=3, seed=s, context=context) for s in (seeds, seeds + 1))
    tests = [(i, j) for i in range(4) for j in range(4)]
    for i, j in tests:
        counts = np.histogram2d(first[:, i], second[:, j], 8, ((0, 1), (0, 1)))[0].ravel()
        value, degrees = statistic(counts, np.full(64, len(seeds) / 64))
        assert value < critical_value(degrees, len(tests)), (i, j)


def test_shuffling(context):
    """Two sequences paired by index, like two decisions of a path, have uncorrelated errors."""
    a, b = points(context, 1 << 12, 7), points(context, 1 << 12, 8)
    correlation = np.corrcoef(a.T, b.T)[:4, 4:]
    assert np.abs(correlation).max() < 5 / np.sqrt(1 << 12)


def test_integrates_better_than_random(context):
    """For a smooth integrand of four dimensions, 256 points have a tenth of the error of random points."""
    x = call_glsl(FILE, "sobol_owen", index=np.arange(256), seed=np.arange(400)[:, None], context=context)
    f = np.prod(1 + (x.astype(np.float64) - 0.5), axis=2)
    error = np.sqrt(((f.mean(axis=1) - 1) ** 2).mean())
    random = np.sqrt(((1 + 1 / 12) ** 4 - 1) / 256)
    assert error < 0.1 * random


def test_hash_avalanche(context):
    """Each bit of the input flips each of the output with probability 1/2, within 0.04."""
    x = np.random.default_rng(2).integers(0, 1 << 32, 4096, dtype=np.uint64).astype(np.uint32)
    hashed = call_glsl(FILE, "hash(uint)", x=x, context=context)
    for k in range(32):
        changed = call_glsl(FILE, "hash(uint)", x=x ^ np.uint32(1 << k), context=context) ^ hashed
        flips = (changed[:, None] >> np.arange(32, dtype=np.uint32) & 1).mean(axis=0)
        assert np.abs(flips - 0.5).max() < 0.04, k
