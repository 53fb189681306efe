"""The commands for browsers: page, serve."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from ..jobs.camera_options import CAMERA_OPTIONS, check_camera_options, chooses_camera
from ..jobs.options import (
    BACKEND_OPTION,
    NO_CACHE_OPTION,
    PATH_OPTIONS,
    QUIET_OPTION,
    SCENE_OPTIONS,
    TIME_OPTIONS,
    Size,
    Whole,
    is_given,
    size_option,
    with_options,
)
from .output import print_text, warn


class _Frames(click.ParamType):
    """Pictures around the model, and at how many elevations: N or NxM, as (N, M)."""

    name = "frames"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        match = re.fullmatch(r"([1-9][0-9]{0,3})(?:[xX]([1-9][0-9]{0,2}))?", value)
        if not match:
            self.fail(f"{value!r} is not N or NxM, such as 36 or 36x3.", param, ctx)
        return int(match[1]), int(match[2] or 1)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "N[xM]"


@click.command()
@click.argument("model")
@click.option("-o", "--output", required=True, metavar="FILE.html", help="The page, one file that needs no other.")
@click.option("--frames", type=_Frames(), default="36", show_default=True,
              help="Pictures around the model; NxM: at each of M elevations, 25 degrees apart.")
@size_option("800x800")
@click.option("--webp-quality", type=Whole(1, 100), default=85, show_default=True, metavar="N",
              help="How little the compression of the pictures loses, from 1 to 100.")
@with_options([*SCENE_OPTIONS, *TIME_OPTIONS, *PATH_OPTIONS, *CAMERA_OPTIONS, BACKEND_OPTION, NO_CACHE_OPTION,
               QUIET_OPTION])
def page(model: str, output: str, **options: Any) -> None:
    """Write a page of pictures of MODEL from all around: drag to turn it.

    The page is one file that needs no network and no WebGL, and shows what `render` shows. Without scripts it is a
    still. Its size is told on stderr.

    \b
    pbr-viewer page helmet.glb -o helmet.html
    pbr-viewer page helmet.glb -o helmet.html --frames 36x3 --size 600 --background none
    pbr-viewer page helmet.glb -o helmet.html --mode path --spp 64 --denoise fast
    """
    check_camera_options(options)
    from ..base.atomic import made_folders
    from ..jobs.assemble import make_environment, make_quality, make_scene, make_settings
    from ..jobs.outputs import check_output
    from ..quality import check_quality
    from ..web.page_job import check_page_options, write_page

    settings = make_settings(options)
    check_quality(options["quality"], settings, chooses=False)
    settings.check_used()
    check_page_options(Path(output), options)
    with made_folders(Path(output).parent):
        check_output(output)
        scene = make_scene(model, make_environment(options), options)
        warn(model, scene, settings, options)
        quality = make_quality(options, settings, scene, options["size"])
        write_page(model, Path(output), scene, settings, quality, options)


@click.command(context_settings={"default_map": {"denoise": "fast"}})
@click.argument("model")
@click.option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS",
              help="The address of this machine to listen at. By default only this machine can connect; 0.0.0.0 opens "
                   "the port to all who can reach it.")
@click.option("--port", type=Whole(0, 65535), default=8765, show_default=True, metavar="N",
              help="The port to listen at; 0 is any that is free.")
@click.option("--size", type=Size(), default="1280x720", show_default=True,
              help="The largest picture; in a smaller window it is smaller, in a larger one it is enlarged.")
@with_options([*SCENE_OPTIONS, *TIME_OPTIONS, *PATH_OPTIONS, *CAMERA_OPTIONS, BACKEND_OPTION, NO_CACHE_OPTION,
               QUIET_OPTION])
def serve(model: str, **options: Any) -> None:
    """Draw MODEL here, without a screen, and show it in a browser: the window, for a machine that has none.

    The address is printed. A secret token in it is the key: who has the address sees the model and turns it, others
    get nothing. All who look share one camera. Ctrl-C ends it. Needs `pip install 'pbr-viewer[serve]'`.

    \b
    pbr-viewer serve helmet.glb
    ssh -L 8765:127.0.0.1:8765 SERVER pbr-viewer serve helmet.glb
    """
    check_camera_options(options)
    from ..gpu.context import open_context
    from ..interact.window_settings import window_settings
    from ..jobs.assemble import make_camera, make_environment, make_playback, make_quality, make_scene, make_settings
    from ..web.serve_job import check_server, serve_model
    from ..web.server import listen
    from ..web.view import RemoteView

    settings = window_settings(make_settings(options), is_given)
    check_server()
    with listen(options["host"], options["port"]) as listener:  # first, since the model may take long
        scene = make_scene(model, make_environment(options), options)
        warn(model, scene, settings, options)
        camera = make_camera(model, scene, options) if chooses_camera(options) else None
        quality = make_quality(options, replace(settings, mode="pbr"), scene, options["size"])  # for keys of the mode
        view = RemoteView(lambda: open_context(options["backend"]), scene, settings, camera, options["size"],
                          not options["no_cache"], make_playback(model, scene, options), quality)
        serve_model(view, listener, options["quiet"], print_text)
