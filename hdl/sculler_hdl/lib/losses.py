"""What a core could not take or hand over, and the counters that tell of it."""

from amaranth import Module, Signal, Value, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_model.golden import COUNTER_BITS


def emit_event_counter(m: Module, event: Value, name: str, held: Value | None = None) -> Value:
    """Put a counter of events into a module; it stays at its highest number.

    Events have to be two clocks apart or more.

    Args:
        m: the module, which gets the registers.
        event: high in the clock of an event; the number follows in the next.
        name: for the registers.
        held: what it counts on from, instead of its own number.
    """
    count, full = Signal(unsigned(COUNTER_BITS), name=name), Signal(name=f"{name}_full")
    m.d.sync += full.eq(count.all())
    number = count if held is None else held
    if held is not None:
        m.d.sync += count.eq(number)
    with m.If(event & ~full):
        m.d.sync += count.eq(number + 1)
    return count


class Losses(wiring.Component):
    """Sees samples whose offer is withdrawn before they are taken (`sculler_model.golden`).

    Members:
        sample_valid, sample_ready (in): the sample port's handshake.
        lost (out): a sample was lost after the last one taken; for the one taken in this clock.
        count (out): losses since reset.
        held (in), where it is `tied`: what it counts on from, instead of its own number.

    Args:
        tied: see `held`.
    """

    def __init__(self, *, tied: bool = False) -> None:
        self.tied = tied
        held = {"held": In(unsigned(COUNTER_BITS))} if tied else {}
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": In(1),
                "lost": Out(1),
                "count": Out(unsigned(COUNTER_BITS)),
                **held,
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        held = self.held if self.tied else None
        refused = Signal()
        withdrawn = Signal()
        untold = Signal()
        m.d.sync += [
            refused.eq(self.sample_valid & ~self.sample_ready),
            withdrawn.eq(refused & ~self.sample_valid),
            untold.eq(self.lost & ~(self.sample_valid & self.sample_ready)),
        ]
        m.d.comb += [
            self.lost.eq(untold | withdrawn),
            self.count.eq(emit_event_counter(m, withdrawn, "samples_lost", held)),
        ]
        return m
