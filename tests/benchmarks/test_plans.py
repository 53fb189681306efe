"""The table of both plans, on figures that are known."""

from __future__ import annotations

import pytest

from benchmarks.plans import FIGURES, summary, table, total


def row(model: str, needed: float, everything: float) -> dict[str, object]:
    return {"model": model, "apart": 1} | dict.fromkeys(FIGURES, needed) | {f"all_{key}": everything for key in FIGURES}


def test_the_last_row_is_the_sum() -> None:
    whole = total([row("a", 1.0, 2.0), row("b", 3.0, 12.0)])
    assert (whole["first_frame_s"], whole["all_first_frame_s"], whole["apart"]) == (4.0, 14.0, 1)
    assert "| all together | 4.00 / 14.00 | 4.0 / 14.0 | 4.0 / 14.0 | 4 / 14 | 4 / 14 | 4 / 14 | 4.0 / 14.0 | 1 |" in \
        table([whole])


def test_ratios_are_of_single_models() -> None:
    lines = summary([row("a", 1.0, 2.0), row("b", 3.0, 12.0), row("c", 1.0, 9.0)])
    assert lines[0] == "- first frame: everything takes 4.00 times what is needed (median of 3 models; 2.00 to 9.00)"


def test_a_model_that_failed_says_why() -> None:
    cells = table([{"model": "a", "error": "no picture"}])[-1].strip("|").split("|")
    assert cells[1].strip() == "no picture" and len(cells) == len(FIGURES) + 2


@pytest.mark.parametrize("key", FIGURES)
def test_every_figure_has_a_column(key: str) -> None:
    assert f" {FIGURES[key]} |" in table([])[0]
