"""Records as textures: what a shader finds at an index."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from viewer.errors import ViewerError
from viewer.gpu.row_texture import row_texture


@pytest.mark.parametrize("dtype", ["uint8", "float16", "float32", "int32", "uint32"])
@pytest.mark.parametrize("count", [0, 3, 4096, 5000])
def test_each_record_is_at_its_index(context, dtype, count):
    texels = (np.arange(count * 3) % 251).reshape(count, 3).astype(dtype)
    texture = row_texture(context.gl, texels, ViewerError("too many"))
    assert texture.width == 4096 and texture.height == max(-(-count // 4096), 1) and texture.components == 3
    read = np.frombuffer(texture.read(alignment=1), dtype).reshape(-1, 3)
    assert np.array_equal(read[:count], texels)
    texture.release()


def test_more_than_fits_raises_the_error_given():
    gl = SimpleNamespace(info={"GL_MAX_TEXTURE_SIZE": 2})
    with pytest.raises(ViewerError, match="^too many triangles$"):
        row_texture(gl, np.zeros((5, 4), np.float32), ViewerError("too many triangles"))
