"""The loops over bytes of text, compiled by Numba (the extra `fast`).

Without Numba the readers and writers go on in numpy and Python: the same numbers and bytes, more
slowly.  So they do for little text, for which loading a compiler is not worth the while.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

from sculler.formats.compiled import decimals, printing, scanning
from sculler_model.machine_code import callable_when_compiled, compiled

WORTH_READING, WORTH_WRITING = 1 << 25, 1 << 23
"""Bytes of a text from which on it is read and written by compiled loops: to load them takes half a
second."""

WORTH_WHEN_LOADED = 1 << 20
"""The same where Numba is in use already."""


class Kernels(NamedTuple):
    """The compiled functions of `scanning` and `printing`, by their names; and the powers of ten.

    Attributes:
        upper, lower: of `decimals.upper_powers` and `decimals.lower_powers`.
    """

    scan_log: Callable[..., int]
    scan_rows: Callable[..., int]
    scan_numbers: Callable[..., int]
    longest: Callable[..., int]
    print_rows: Callable[..., int]
    print_stamped: Callable[..., int]
    print_floats: Callable[..., int]
    upper: decimals.Words
    lower: decimals.Words


def kernels(size: int, writing: bool = False) -> Kernels | None:
    """What reads or writes so many bytes of text; None for little, and where Numba is missing."""
    least = WORTH_WRITING if writing else WORTH_READING
    if "numba" in sys.modules:
        least = min(least, WORTH_WHEN_LOADED)
    return loaded() if size >= least else None


@cache
def loaded() -> Kernels | None:
    """The compiled functions; None where Numba is missing.

    Compiling takes some seconds at the very first call and is kept on disk from then on.
    """
    modules = (decimals, scanning, printing)
    try:
        callable_when_compiled(*modules)
    except ImportError:
        return None

    def made(name: str) -> Any:
        function = getattr(scanning, name, None) or getattr(printing, name)
        return compiled(function, *modules, nogil=True)

    loops = [made(name) for name in Kernels._fields[:-2]]
    return Kernels._make([*loops, decimals.upper_powers(), decimals.lower_powers()])
