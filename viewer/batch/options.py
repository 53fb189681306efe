"""The options of `render` that say how many pictures are made at once, where, and what of an earlier run is kept."""

from __future__ import annotations

import click

BATCH_OPTIONS = [
    click.option("--jobs", type=click.IntRange(1, 1024), metavar="N",
                 help="Render in N processes beside this one. A model that crashes its process is reported, and the "
                      "others go on."),
    click.option("--resume", is_flag=True,
                 help="Leave out the models whose pictures are there already, made of the same files with the same "
                      "options by a run that was stopped or killed, or in which others have failed; manifest.jsonl "
                      "beside the pictures tells."),
    click.option("--retries", type=click.IntRange(0, 1000), metavar="N",
                 help="Try a model N times more if its process was killed, or memory or the disk was full. What is "
                      "wrong with a file stays wrong, so that is not tried again. Default: 1 for several models, "
                      "0 for one."),
]
BATCH = ("jobs", "resume", "retries")
"""The names of these options; no picture depends on them."""
