"""Receiver of an asynchronous line."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.crossing import Synchroniser
from sculler_hdl.plan.front import FrontPlan
from sculler_model.front import Uart

_DATA_BITS = 8


class UartReceiver(wiring.Component):
    """Bytes of a line: a start bit (low), 8 data bits, least significant first, parity, stop bit.

    The falling edge of a start bit starts a phase that turns once a bit.  Each bit is what two of
    three looks around its middle say, at 6, 8 and 10 sixteenths.  A start bit that is not low in
    its middle was a disturbance.  A byte whose stop bit is low, or whose parity is wrong, is
    dropped; after a low stop bit the line has to be high first.

    Members:
        rx (in): the line, high while idle; synchronised inside by two registers.
        start (out): a start bit begins, three clocks after its edge.
        data_valid, data (out): a byte is whole, in the last look at its stop bit.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: FrontPlan) -> None:
        assert isinstance(plan.link.wire, Uart)
        self.plan = plan.baud
        self.parity = plan.link.wire.parity
        super().__init__(
            {
                "rx": In(1, init=1),
                "start": Out(1),
                "data_valid": Out(1),
                "data": Out(unsigned(8)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.line = line = Synchroniser(1, init=1)
        rx = Signal(init=1)
        m.d.comb += [line.data_in.eq(self.rx), rx.eq(line.data_out)]
        phase, turned, last_look, level = self._bit(m, rx)
        number = Signal(range(_DATA_BITS + 3))  # of the bit: 0 is the start bit
        odd = Signal()  # ones so far, of data and parity
        is_stop = number == _DATA_BITS + 1 + (self.parity != "none")
        right = odd == (self.parity == "odd") if self.parity != "none" else Value.cast(1)
        with m.FSM():
            with m.State("IDLE"), m.If(~rx):
                m.d.comb += self.start.eq(1)
                m.d.sync += [phase.eq(0), number.eq(0), odd.eq(0)]
                m.next = "BITS"
            with m.State("BITS"):
                with m.If(turned):
                    m.d.sync += number.eq(number + 1)
                with m.If(last_look):
                    is_data = number <= _DATA_BITS
                    with m.If((number == 0) & level):
                        m.next = "IDLE"
                    with m.If(is_stop):
                        m.d.comb += self.data_valid.eq(level & right)
                        m.next = "IDLE"
                        with m.If(~level):
                            m.next = "LOW"
                    with m.Elif(number != 0):
                        m.d.sync += odd.eq(odd ^ level)
                        with m.If(is_data):
                            m.d.sync += self.data.eq(Cat(self.data[1:], level))
            with m.State("LOW"), m.If(rx):
                m.next = "IDLE"
        return m

    def _bit(self, m: Module, rx: Signal) -> tuple[Signal, Signal, Signal, Signal]:
        """The phase; whether it turns, the last look at a bit, and what the looks say by then."""
        bits = self.plan.bits
        phase = Signal(bits)
        following = Signal(bits + 1)
        sixteenth, coming = phase[-4:], following[-5:]
        m.d.comb += following.eq(phase + self.plan.step)
        m.d.sync += phase.eq(following)
        turned, last_look, level = Signal(), Signal(), Signal()
        looks = [(sixteenth < look) & (coming >= look) for look in (6, 8, 10)]
        seen = Signal(2)  # of the first two looks
        with m.If(looks[0]):
            m.d.sync += seen.eq(rx)
        with m.Elif(looks[1]):
            m.d.sync += seen.eq(seen + rx)
        m.d.comb += [
            turned.eq(following[-1]),
            last_look.eq(looks[2]),
            level.eq(Mux(rx, seen != 0, seen == 2)),
        ]
        return phase, turned, last_look, level
