"""The decoders that run in another process (viewer/base/apart.py): libraries in C++ whose input may be hostile."""

from __future__ import annotations

import numpy as np


def draco(data: bytes) -> dict[str, np.ndarray]:
    """The "faces" (F, 3) uint32 of a Draco mesh, and each attribute (N, C) by its unique id in decimal digits.

    Raises ValueError for data that is broken, or no mesh.
    """
    import DracoPy

    try:
        mesh = DracoPy.decode(data)
        arrays = {str(attribute["unique_id"]): np.asarray(attribute["data"]) for attribute in mesh.attributes}
        return {"faces": np.asarray(mesh.faces, np.uint32).reshape(-1, 3), **arrays}
    except Exception as error:  # of several classes, none of them the library's own
        raise ValueError("is broken") from error


def ktx2(data: bytes, channels: int) -> dict[str, np.ndarray]:
    """The "pixels" (H, W, channels) uint8 of the largest level of a KTX2 image with Basis Universal texels.

    Raises ValueError for data that is broken.
    """
    import opengl_basisu

    try:
        return {"pixels": opengl_basisu.open(data).transcode("rgba8").data[..., :channels]}
    except Exception as error:
        raise ValueError("is broken") from error


def blosc(data: bytes, lengths: list[int]) -> dict[str, np.ndarray]:
    """The "bytes" (N,) uint8 of chunks of Blosc 1, which stand one after the other and have these lengths.

    Raises ValueError for data that is broken.
    """
    from numcodecs import blosc as decoder

    decoder.use_threads = False
    ends = np.cumsum(lengths).tolist()
    try:
        parts = [decoder.decompress(data[end - length:end]) for length, end in zip(lengths, ends)]
    except Exception as error:  # of several classes, none of them the library's own
        raise ValueError("are broken") from error
    return {"bytes": np.frombuffer(b"".join(parts), np.uint8)}


def step(data: bytes) -> dict[str, np.ndarray]:
    """The "bytes" (N,) uint8 of a GLB file with the solids of a STEP file as triangles.

    They are at most a hundredth of the length of an edge from the faces, and their normals at most 0.2 radians apart.
    Raises ValueError for data that is broken.
    """
    import cascadio

    glb = cascadio.to_glb_bytes(data, cascadio.STEP, tol_linear=0.01, tol_angular=0.2, tol_relative=True,
                                use_parallel=False)  # each thread would reserve memory
    if not glb:
        raise ValueError("is broken")
    return {"bytes": np.frombuffer(glb, np.uint8)}
