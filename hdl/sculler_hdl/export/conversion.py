"""RTLIL of a core: Amaranth's own conversion, without what a large core need not wait for.

A core of 16 samples and 16 of history has a million nets.  Amaranth makes each an object, looks at
each whenever it is put into another value, and walks all paths from each back to look for loops;
Python looks through all of them again and again for garbage.  That takes two thirds of the time.
The text is the same without it.  No core has a combinational loop: Verilator and Yosys would name
it, in the tests of every design.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from amaranth.back import rtlil
from amaranth.hdl import _nir

from sculler_hdl.export.parts import Elaborated

_ALLOCATIONS = 10_000  # between two looks at the newest objects; old ones are not looked at again


def to_rtlil(core: Elaborated, name: str) -> str:
    """The RTLIL text of a core.

    Args:
        core: the core; its parts are known afterwards.
        name: of the top module.
    """
    with _unchecked():
        return rtlil.convert(core, name=name, emit_src=False)


@contextmanager
def rare_collection() -> Iterator[None]:
    """Garbage is looked for among new objects only: nearly all stay until the text is done."""
    before = gc.get_threshold()
    gc.set_threshold(_ALLOCATIONS, 1000, 1000)
    try:
        yield
    finally:
        gc.set_threshold(*before)


@contextmanager
def _unchecked() -> Iterator[None]:
    """Amaranth's netlist does not check every net, nor every path for loops."""
    replaced = [
        (_nir.Value, "__new__", staticmethod(_new_value)),
        (_nir.Netlist, "check_comb_cycles", lambda netlist: None),
    ]
    before = [(owner, name, vars(owner)[name]) for owner, name, _ in replaced]
    try:
        for owner, name, function in replaced:
            setattr(owner, name, function)
        yield
    finally:
        for owner, name, function in before:
            setattr(owner, name, function)


def _new_value(cls: type, nets: Any = ()) -> Any:
    return tuple.__new__(cls, (nets,) if type(nets) is _nir.Net else nets)
