"""Compressed buffer views: EXT_meshopt_compression and KHR_meshopt_compression."""

from __future__ import annotations

from .element import Element

EXTENSIONS = ("KHR_meshopt_compression", "EXT_meshopt_compression")
"""Both describe a view by the same properties. The first also allows version 1 of the vertex codec and colours."""
_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTER_STRIDES = {"NONE": range(4, 257, 4), "OCTAHEDRAL": (4, 8), "QUATERNION": (8,), "EXPONENTIAL": range(4, 257, 4),
                   "COLOR": (4, 8)}
_INDEX_STRIDES = (2, 4)


def compression(view: Element) -> Element | None:
    """What says how the buffer view is compressed; None if it is not."""
    return next((found for found in map(view.extension, EXTENSIONS) if found is not None), None)


def decoded_size(view: Element, compressed: Element) -> int:
    """The bytes that the view holds when it is decoded. Raises InputError if its properties contradict each other."""
    count, stride = compressed.integer("count", low=1), compressed.integer("byteStride", low=1)
    mode, name = compressed.string("mode"), compressed.string("filter", "NONE")
    if mode not in _MODES:
        raise compressed.error(f"{mode[:20]!r} is not a mode of this compression", "mode")
    if name not in _FILTER_STRIDES or (name != "NONE" and mode != "ATTRIBUTES"):
        raise compressed.error(f"{name[:20]!r} is not a filter of mode {mode}", "filter")
    if stride not in (_FILTER_STRIDES[name] if mode == "ATTRIBUTES" else _INDEX_STRIDES):
        raise compressed.error(f"{stride} bytes are no stride of mode {mode} with filter {name}", "byteStride")
    if mode == "TRIANGLES" and count % 3:
        raise compressed.error(f"{count} indices do not form complete triangles", "count")
    declared = view.integer("byteLength", low=1)
    if declared != count * stride:
        problem = f"{declared} bytes, but its compressed data holds {count} elements of {stride} bytes"
        raise view.error(problem, "byteLength")
    return count * stride


def decode(compressed: Element, data: memoryview) -> memoryview:
    """The bytes of a view whose `decoded_size` was checked, from its compressed `data`. Raises InputError."""
    import meshopt

    count, stride = compressed.integer("count"), compressed.integer("byteStride")
    try:
        array = meshopt.decode_gltf_buffer(data, count, stride, compressed.string("mode"),
                                           compressed.string("filter", "NONE"))
    except ValueError as error:  # in the library's own numbers
        raise compressed.error(f"the compressed data is broken, or does not hold {count} elements") from error
    return memoryview(array).cast("B")
