"""Blocks without warnings leave the filters as the first of them found them, also if they overlap."""

from __future__ import annotations

import warnings

import pytest

from viewer.base.quiet import without_warnings


def test_nothing_is_shown_in_a_block_and_everything_after_it():
    with warnings.catch_warnings(record=True) as shown:
        warnings.simplefilter("always")
        with without_warnings():
            warnings.warn("inside", stacklevel=1)
        warnings.warn("after", stacklevel=1)
    assert [str(warning.message) for warning in shown] == ["after"]


def test_blocks_that_overlap_as_those_of_two_threads_do_leave_nothing_behind():
    first, second = without_warnings(), without_warnings()
    with pytest.warns(UserWarning, match="after"):
        first.__enter__()
        second.__enter__()
        first.__exit__(None, None, None)
        warnings.warn("between", stacklevel=1)
        second.__exit__(None, None, None)
        warnings.warn("after", stacklevel=1)


def test_an_exception_ends_the_block():
    with pytest.warns(UserWarning, match="after"):
        with pytest.raises(ValueError), without_warnings():
            raise ValueError
        warnings.warn("after", stacklevel=1)
