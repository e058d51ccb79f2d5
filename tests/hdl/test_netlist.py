"""Amaranth's netlists with less work: the same text, and every combinational loop is found."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import nullcontext

import pytest
from amaranth.back import rtlil
from amaranth.hdl import Cat, Elaboratable, Module, Signal, _nir

from sculler_hdl.core import build_core
from sculler_hdl.export.netlist import _METHODS, quick_netlists
from strategies import DESIGNS

BEFORE = {name: getattr(_nir.Netlist, name) for name in ("__init__", *_METHODS)}


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
    texts = []
    for way in (nullcontext, quick_netlists):
        core = build_core(DESIGNS[name])
        with way():
            texts.append(rtlil.convert(core, name=name, emit_src=False))
    assert texts[0] == texts[1]
    assert {name: getattr(_nir.Netlist, name) for name in BEFORE} == BEFORE


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
    assert {name: getattr(_nir.Netlist, name) for name in BEFORE} == BEFORE
