"""A page of pictures of a model from all around, which needs nothing but itself: drag to turn."""

from __future__ import annotations

import base64
import hashlib
import html
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..base.messages import one_line
from ..image.image import Image
from ..measure.html_page import html_page
from ..measure.report.page import embedded

_HERE = Path(__file__).resolve().parent
MOST_PIXELS = 16383
"""Along a side of a picture: WebP has no more."""
ELEVATION_STEP = 25.0
"""Degrees between two rows."""
HIGHEST = 85.0
"""No row is nearer to a pole, where nothing would tell left from right."""
_BODY = """<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; \
style-src 'unsafe-inline'; script-src 'sha256-{digest}'">
<h1>{title}</h1>
<div id="model" aria-label="{title}"><img id="picture" src="{still}" width="{width}" height="{height}" \
alt="{title}, a picture by pbr-viewer" decoding="sync" draggable="false"></div>
<p class="soft"><span id="how"></span> <span id="from"></span>
<noscript>This is one of {count} pictures; with scripts, the model turns.</noscript></p>
<p class="soft">{about}</p>
<script type="application/json" id="pictures">{pictures}</script>
<script>{script}</script>"""


@dataclass(frozen=True)
class Turn:
    """Where the pictures are taken from: `columns` around the model, from `azimuth` on, at each of the `elevations`,
    which rise. All in degrees. `row` is the elevation that is shown first."""

    columns: int
    azimuth: float
    elevations: tuple[float, ...]
    row: int

    @classmethod
    def of(cls, columns: int, rows: int, azimuth: float, elevation: float) -> Turn:
        """`rows` elevations about `elevation`, ELEVATION_STEP apart, or less where they would come too near a pole.
        One row is at `elevation`, wherever that is."""
        if rows == 1:
            return cls(columns, azimuth, (elevation,), 0)
        step = min(ELEVATION_STEP, 2 * HIGHEST / (rows - 1))
        lowest = min(max(elevation - step * ((rows - 1) // 2), -HIGHEST), HIGHEST - step * (rows - 1))
        elevations = tuple(lowest + step * k for k in range(rows))
        return cls(columns, azimuth, elevations, min(range(rows), key=lambda k: abs(elevations[k] - elevation)))

    @property
    def count(self) -> int:
        return self.columns * len(self.elevations)

    @property
    def turns(self) -> list[float]:
        """How far the camera has turned about the model in each column, in radians."""
        return [math.tau * k / self.columns for k in range(self.columns)]


def encoded(image: Image, quality: int) -> bytes:
    """The displayed picture as WebP; `quality` is from 1 to 100, as WebP counts it."""
    from PIL import Image as Pillow

    file = io.BytesIO()
    Pillow.fromarray(image.srgb).save(file, format="WEBP", quality=quality, method=4)
    return file.getvalue()


def turning_page(name: str, turn: Turn, pictures: Sequence[bytes], size: tuple[int, int], about: str) -> str:
    """The page of `pictures`, WebP of `size` pixels, row by row from the lowest elevation. `name` is the model's, and
    `about` says how the pictures were made; both are plain text."""
    links = [f"data:image/webp;base64,{base64.b64encode(picture).decode()}" for picture in pictures]
    script = (_HERE / "turning.js").read_text(encoding="utf-8")
    grid = {"columns": turn.columns, "rows": len(turn.elevations), "column": 0, "row": turn.row,
            "azimuth": turn.azimuth, "elevations": turn.elevations, "pictures": links}
    title = one_line(name)
    body = _BODY.format(
        digest=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(), title=html.escape(title),
        still=links[turn.row * turn.columns], width=size[0], height=size[1], count=len(links),
        about=html.escape(one_line(about)), pictures=embedded(grid), script=script)
    return html_page(title, body, (_HERE / "turning.css").read_text(encoding="utf-8"))
