"""The options of `render` that say how many pictures are made at once, where, and what of an earlier run is kept."""

from __future__ import annotations

from typing import Any

import click

from ..errors import UsageError
from ..jobs.options import Whole

LOCAL = "local"
"""The address that stands for a cluster of this machine, or for that of DASK_SCHEDULER_ADDRESS."""


class Address(click.ParamType):
    """The address of a scheduler, or LOCAL."""

    name = "address"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value != LOCAL and "://" not in value:
            problem = f"{value!r} is no address, such as tcp://host:8786; a MODEL after it needs --dask={LOCAL}."
            self.fail(problem, param, ctx)
        return value


BATCH_OPTIONS = [
    click.option("--jobs", type=Whole(1, 1024), metavar="N",
                 help="Render in N worker processes. If a model crashes its process, that is reported, and the other "
                      "models are still rendered."),
    click.option("--dask", is_flag=False, flag_value=LOCAL, type=Address(), metavar="[ADDRESS]",
                 help="Render on the workers of the Dask scheduler at ADDRESS, such as tcp://host:8786. They need the "
                      "files at the same paths. Without ADDRESS: the scheduler that DASK_SCHEDULER_ADDRESS names, or "
                      "else --jobs workers on this machine. Write `--dask=local` if a MODEL follows."),
    click.option("--scheduler-file", metavar="FILE.json",
                 help="Like --dask, with the scheduler that wrote this file (`dask scheduler --scheduler-file`)."),
    click.option("--resume", is_flag=True,
                 help="Continue an interrupted run: skip the models whose pictures exist and were made from the same "
                      "files with the same options, as recorded in manifest.jsonl beside the pictures."),
    click.option("--retries", type=Whole(0, 1000), metavar="N",
                 help="Try a model up to N more times if its process was killed, or if memory or the disk was full. "
                      "Errors in a file are not tried again. Default: 1 for several models, 0 for one."),
]
BATCH = ("jobs", "dask", "scheduler_file", "resume", "retries")
"""The names of these options; no picture depends on them."""


def check_batch_options(chosen: dict[str, Any]) -> None:
    """Raises UsageError for options that contradict each other."""
    if chosen["dask"] is not None and chosen["scheduler_file"] is not None:
        raise UsageError("--dask and --scheduler-file cannot be used together")
    existing = "--scheduler-file" if chosen["scheduler_file"] is not None else "--dask"
    if chosen["jobs"] is not None and (chosen["scheduler_file"] is not None or chosen["dask"] not in (None, LOCAL)):
        raise UsageError(f"--jobs and {existing} cannot be used together: the cluster has its own workers")
