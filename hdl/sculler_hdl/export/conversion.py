"""RTLIL of a core by Amaranth's own conversion, and memory management to suit it.

A core of 16 samples and 16 of history has a million nets.  Amaranth makes each an object, and
Python looks through all of them again and again for garbage, which takes a third of the time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from amaranth.back import rtlil

from sculler_hdl.export.parts import Elaborated

_ALLOCATIONS = 10_000  # between two looks at the newest objects; old ones are not looked at again


def to_rtlil(core: Elaborated, name: str) -> str:
    """The RTLIL text of a core.

    Args:
        core: the core; its parts are known afterwards.
        name: of the top module.
    """
    text: str = rtlil.convert(core, name=name, emit_src=False)
    return text


@contextmanager
def rare_collection() -> Iterator[None]:
    """Garbage is looked for among new objects only: nearly all stay until the text is done."""
    before = gc.get_threshold()
    gc.set_threshold(_ALLOCATIONS, 1000, 1000)
    try:
        yield
    finally:
        gc.set_threshold(*before)
