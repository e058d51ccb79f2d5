"""Words of a minor interval, taken where each comes by, and given one after another."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth import Cat, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay
from sculler_hdl.plan.arrival import Arrival, spans, width


class VectorLoader(wiring.Component):
    """A shift register of words: its places are filled, each as its bits come, then it moves.

        word 3 ─▶ word 2 ─▶ word 1 ─▶ word 0 = output

    Members:
        load (clock 0): the words come, each bit at the clock that its arrival says.
        shift: the next word, from the next clock on.
        word0, word1, ...: the words.
        output: the word in turn, its sign in front; from the clock after its last bits.

    Latency: 1 clock.  One set of words at a time: none is shifted before all have come.

    Args:
        arrivals: of the words, at clock 0 or later.
    """

    def __init__(self, arrivals: Sequence[Arrival]) -> None:
        self.arrivals = tuple(arrivals)
        self.bits = max(map(width, arrivals))
        super().__init__(
            {
                "load": In(1),
                "shift": In(1),
                **{f"word{i}": In(width(one)) for i, one in enumerate(arrivals)},
                "output": Out(self.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        load = ControlDelay(m, "load", self.load)
        behind: Value | None = None
        # a place holds its own word and, later on, those of the places behind it
        bits = 0
        for i in reversed(range(len(self.arrivals))):
            word, arrival = getattr(self, f"word{i}"), self.arrivals[i]
            before, bits = behind, max(bits, len(word))
            place = Signal(bits, name=f"place{i}", reset_less=True)
            if before is not None:
                with m.If(self.shift):
                    m.d.sync += place.eq(_extended(before, bits))
            for lo, hi, clock in spans(arrival):
                end = bits if hi == len(word) else hi
                with m.If(load.at_clock(clock)):
                    m.d.sync += place[lo:end].eq(_extended(word[lo:hi], end - lo))
            behind = place
        assert behind is not None
        m.d.comb += self.output.eq(_extended(behind, self.bits))
        return m


def _extended(value: Value, bits: int) -> Value:
    """So many bits of a number."""
    short = bits - len(value)
    return Cat(value, value[-1].replicate(short)) if short > 0 else value
