"""Amaranth's netlists with less work: the same text, and every combinational loop is found."""

from __future__ import annotations

import gc
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import nullcontext

import pytest
from amaranth.back import rtlil
from amaranth.hdl import (
    Cat,
    DriverConflict,
    Elaboratable,
    Module,
    Signal,
    SyntaxError,
    _ast,
    _nir,
)
from amaranth.hdl._mem import MemoryData

from sculler_hdl.core import build_core
from sculler_hdl.export.netlist import _REPLACED, quick_netlists, rtlil_text
from sculler_hdl.export.parts import prepared
from strategies import DESIGNS


def _present() -> list[object]:
    """Amaranth's functions as they are now; None for one that is inherited."""
    names = [(owner, name) for owner, functions in _REPLACED.items() for name in functions]
    return [vars(owner).get(name) for owner, name in [(_nir.Netlist, "__init__"), *names]]


BEFORE = _present()


class Chain(Elaboratable):
    """Bits of one signal made of each other: whole cells make a loop, bits need not."""

    def __init__(self, *, closed: bool) -> None:
        self.given, self.closed = Signal(), closed

    def elaborate(self, platform: object) -> Module:
        m = Module()
        bits, by = Signal(4), Signal(4)
        m.d.comb += [by.eq(~bits), bits.eq(Cat(by[3] if self.closed else self.given, by[:3]))]
        return m


@pytest.mark.parametrize("name", ["smallest", "stim300_4x5"])
def test_the_text_is_the_same(name: str) -> None:
    plain = rtlil.convert(build_core(DESIGNS[name]), name=name, emit_src=False)
    with quick_netlists():
        assert rtlil.convert(build_core(DESIGNS[name]), name=name, emit_src=False) == plain
    design, parts = prepared(build_core(DESIGNS[name]), name)
    assert rtlil_text(design, name) == plain
    assert all(f"module \\{path}\n" in plain for path in parts)
    assert _present() == BEFORE


def test_what_is_done_with_is_let_go_at_once() -> None:
    """Not when Python looks for garbage, in which a large core's would stay until then."""
    large = _ast.Assign, _nir.Operator, _nir.FlipFlop, rtlil.Wire, rtlil.Cell

    def held() -> list[int]:
        counts = Counter(map(type, gc.get_objects()))
        return [counts[each] for each in large]

    gc.collect()
    before = held()
    gc.disable()
    try:
        design, _ = prepared(build_core(DESIGNS["smallest"]), "smallest")
        rtlil_text(design, "smallest")
        after = held()
    finally:
        gc.enable()
    assert after == before


def test_a_loop_of_bits_is_found_and_one_of_cells_alone_is_none() -> None:
    """In Amaranth's own words."""
    said = []
    for way in (nullcontext, quick_netlists):
        with way(), pytest.raises(_nir.CombinationalCycle) as found:
            rtlil.convert(Chain(closed=True), ports=[])
        said.append(str(found.value))
    assert said[0] == said[1]
    chain = Chain(closed=False)
    with quick_netlists():
        text = rtlil.convert(chain, ports=[chain.given])
    assert "$not" in text


class Twice(Elaboratable):
    """Two modules that drive the same bit."""

    def elaborate(self, platform: object) -> Module:
        m = Module()
        bits = Signal(4)
        for part in "ab":
            m.submodules[part] = one = Module()
            one.d.comb += bits[2].eq(1)
        return m


def test_a_bit_that_is_driven_twice_is_named_in_the_same_words() -> None:
    said = []
    for way in (nullcontext, quick_netlists):
        with way(), pytest.raises(DriverConflict) as found:
            rtlil.convert(Twice(), ports=[])
        said.append(str(found.value))
    assert said[0] == said[1]


class Wrong(Elaboratable):
    """A module with statements that Amaranth refuses."""

    def __init__(self, kind: str) -> None:
        self.kind = kind

    def elaborate(self, platform: object) -> Module:
        m, one = Module(), Signal(4)
        row = MemoryData(shape=4, depth=4, init=[])[0]
        if self.kind == "reads a row":
            m.d.comb += one.eq(Cat(row, one)[:4])
        elif self.kind == "assigns to a sum":
            m.d.comb += (one + 1).eq(3)
        else:
            m.d.comb += one[0].eq(1)
            m.d.sync += one[:2].eq(0)
        return m


@pytest.mark.filterwarnings("ignore::amaranth.hdl.UnusedElaboratable")
@pytest.mark.parametrize(
    ("kind", "plain", "quick"),
    [
        ("reads a row", ValueError, TypeError),
        ("assigns to a sum", ValueError, ValueError),
        ("drives a bit in two domains", SyntaxError, DriverConflict),
    ],
)
def test_what_amaranth_refuses_is_refused(
    kind: str, plain: type[Exception], quick: type[Exception]
) -> None:
    """Some of it later, and in other words."""
    with pytest.raises(plain):
        rtlil.convert(Wrong(kind), ports=[])
    with quick_netlists(), pytest.raises(quick):
        rtlil.convert(Wrong(kind), ports=[])
    gc.collect()  # here Amaranth warns of the modules that came to nothing


def test_another_threads_netlists_stay() -> None:
    with ThreadPoolExecutor(1) as pool, quick_netlists():
        theirs, ours = pool.submit(_nir.Netlist).result(), _nir.Netlist()
    assert vars(theirs)
    assert not vars(ours)


def test_another_thread_waits_for_its_turn() -> None:
    """One that began first and ended first would leave the other's functions behind."""

    def takes_its_turn() -> None:
        with quick_netlists():
            pass

    with ThreadPoolExecutor(1) as pool:
        with quick_netlists():
            theirs = pool.submit(takes_its_turn)
            assert not wait([theirs], timeout=0.2).done
        theirs.result()
    assert _present() == BEFORE
