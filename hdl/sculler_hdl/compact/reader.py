"""Hands a result over from the result memory, word by word."""

from __future__ import annotations

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.compact.pipeline import memory_latency
from sculler_model.design import Design
from sculler_model.stream import words_per_result


class Reader(wiring.Component):
    """Streams one bank of the result memory while the engine fills the other.

    Members:
        publish (in): the bank being filled is complete; it is shown from the next clock on, and
            the other is filled.
        filling (out): the bank being filled.
        address (out): of the result memory: the word, then the bank.
        valid, last (out), ready (in): the stream's, its data being the memory's.
        taken (out): the last word is taken in this clock.

    A word is valid `memory_latency` + 1 clocks after the one before was taken, and that latency
    after the clock following `publish`.
    """

    def __init__(self, design: Design) -> None:
        self.words = words_per_result(design)
        self.wait = memory_latency(design.hardware.target)
        super().__init__(
            {
                "publish": In(1),
                "filling": Out(1),
                "address": Out((self.words - 1).bit_length() + 1),
                "valid": Out(1),
                "last": Out(1),
                "ready": In(1),
                "taken": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        word = Signal(range(self.words))
        waiting = Signal()  # a result that is not yet taken whole
        ahead = Signal(range(self.wait + 1))  # clocks until the word is there
        m.d.comb += [
            self.address.eq(Cat(word, ~self.filling)),
            self.valid.eq(waiting & (ahead == 0)),
            self.last.eq(word == self.words - 1),
            self.taken.eq(self.valid & self.ready & self.last),
        ]
        with m.If(ahead != 0):
            m.d.sync += ahead.eq(ahead - 1)
        with m.If(self.valid & self.ready):
            m.d.sync += [word.eq(word + 1), ahead.eq(self.wait)]
        with m.If(self.taken):
            m.d.sync += [word.eq(0), waiting.eq(0)]
        with m.If(self.publish):
            m.d.sync += [waiting.eq(1), ahead.eq(self.wait), self.filling.eq(~self.filling)]
        return m
