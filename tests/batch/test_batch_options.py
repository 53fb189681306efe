"""What the options of batches refuse."""

from __future__ import annotations

import sys

import pytest
from command_line import SCENES, names
from needs import needs

MODEL = SCENES / "unlit.glb"


@pytest.mark.parametrize("arguments, words", [
    (["--dask", MODEL], "is no address, such as tcp://host:8786; a MODEL after it needs --dask=local"),
    ([MODEL, "--dask=tcp://a:1", "--jobs", "2"], "--jobs and --dask cannot be used together"),
    ([MODEL, "--scheduler-file", "s.json", "--jobs", "2"], "--jobs and --scheduler-file cannot be used together"),
    ([MODEL, "--scheduler-file", "s.json", "--dask"], "--dask and --scheduler-file cannot be used together"),
    ([MODEL, "--jobs", "0"], "0 is not from 1 to 1024"),
])
def test_what_contradicts_itself_is_wrong_usage(run, folder, arguments, words):
    outcome = run("render", "-o", "out/", *arguments)
    assert outcome.status == 2 and words in outcome.error and names(folder) == []


@needs("batch")
def test_a_scheduler_that_is_not_there_is_one_line(run, folder):
    outcome = run("render", MODEL, "-o", "out/", "--scheduler-file", "none.json")
    assert (outcome.status, outcome.error) == (1, "none.json: no such file")
    (folder / "broken.json").write_text("{}")
    outcome = run("render", MODEL, "-o", "out/", "--scheduler-file", "broken.json")
    assert (outcome.status, outcome.error) == (
        1, "broken.json: is not the file of a Dask scheduler: it names no address")


def test_without_dask_the_extra_is_named(run, folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    outcome = run("render", MODEL, "-o", "out/", "--dask")
    assert (outcome.status, outcome.error) == (2, "--dask needs Dask: pip install 'pbr-viewer[batch]'")
