"""JSON of files, whose errors are told in the file's own terms."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ..errors import InputError


def parse_json(path: Path, text: bytes, takes_nan: bool = False) -> Any:
    """The value that the JSON `text` of the file `path` stands for. Raises InputError.

    NaN and infinity, which JSON does not have and some programs write, are errors, unless the caller `takes_nan` to
    say where they stand.
    """
    try:
        return json.loads(text.decode("utf-8-sig"), parse_constant=float if takes_nan else _reject_constant)
    except UnicodeDecodeError as error:
        raise InputError(path, f"byte {error.start}", "the JSON is not valid UTF-8") from error
    except json.JSONDecodeError as error:
        raise InputError(path, f"line {error.lineno}", f"not valid JSON: {error.msg}") from error
    except RecursionError as error:
        raise InputError(path, "", "not valid JSON: nested too deeply") from error
    except _WrongConstant as error:
        raise InputError(path, "", f"not valid JSON: {error} is not a number") from error
    except ValueError as error:  # of CPython, which limits the digits that it converts
        raise InputError(path, "", "not valid JSON: a number has thousands of digits") from error


class _WrongConstant(ValueError):
    """NaN or Infinity, which Python's parser takes."""


def _reject_constant(name: str) -> None:
    raise _WrongConstant(name)
