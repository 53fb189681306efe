"""Broken copies of a file, the same in every run."""

from __future__ import annotations

import random
from collections.abc import Iterator

_HEADER = 160
"""Half of all changes are among the first bytes, where counts and offsets stand."""


def mutations(data: bytes, count: int, seed: int = 0) -> Iterator[bytes]:
    """`count` copies of `data`, each cut off or with some bytes changed, overwritten or moved."""
    rng = random.Random(seed)
    for _ in range(count):
        broken = bytearray(data)
        if rng.random() < 0.15:
            yield bytes(broken[:rng.randrange(len(broken))])
            continue
        for _ in range(rng.choice((1, 1, 1, 2, 4, 16))):
            place = rng.randrange(min(len(broken), _HEADER) if rng.random() < 0.5 else len(broken))
            kind = rng.random()
            if kind < 0.3:
                broken[place] ^= 1 << rng.randrange(8)
            elif kind < 0.6:
                broken[place] = rng.choice((0, 1, 127, 128, 254, 255, rng.randrange(256)))
            elif kind < 0.8:
                end = min(place + 4, len(broken))
                word = rng.choice((b"\xff" * 4, bytes(4), b"\xff\xff\xff\x7f", b"\0\0\0\x80", rng.randbytes(4)))
                broken[place:end] = word[:end - place]
            else:
                source, length = rng.randrange(len(broken)), rng.randrange(1, 32)
                broken[place:place + length] = broken[source:source + length]
        yield bytes(broken)
