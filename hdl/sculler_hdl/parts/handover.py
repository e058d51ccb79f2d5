"""Hand-over: the finished result's own storage and its handshake."""

from amaranth import Module, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import vector
from sculler_model.cycles import PORT_MAJOR_BITS
from sculler_model.vectors import VECTORS
from sculler_model.wordlength import WordLengths


def result_layout(words: WordLengths) -> data.StructLayout:
    """The six vectors of a result, each as wide as its worst case."""
    return data.StructLayout({name: vector(getattr(words, name)) for name in VECTORS})


class HandOver(wiring.Component):
    """Holds a result while the next interval runs.

    `load` copies `input` and `input_status` and raises `valid` in the next clock; `taken` is high
    in the clock the host takes the result.  The sequencer sees to it that `load` never comes
    while a result waits.  Everything is 0 after reset.

    Latency 1 from `load` to `valid`.
    """

    latency = 1

    def __init__(self, words: WordLengths) -> None:
        layout = result_layout(words)
        super().__init__(
            {
                "load": In(1),
                "input": In(layout),
                "input_status": In(2),
                "ready": In(1),
                "valid": Out(1),
                "taken": Out(1),
                "major": Out(unsigned(PORT_MAJOR_BITS)),
                "status": Out(2),
                "output": Out(layout),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        next_major = Signal(unsigned(PORT_MAJOR_BITS))
        m.d.comb += self.taken.eq(self.valid & self.ready)
        with m.If(self.taken):
            m.d.sync += self.valid.eq(0)
        with m.If(self.load):
            m.d.sync += [
                self.valid.eq(1),
                self.output.eq(self.input),
                self.status.eq(self.input_status),
                self.major.eq(next_major),
                next_major.eq(next_major + 1),
            ]
        return m
