"""Signals at later clocks: the registers that line a pipeline up.

Both classes emit hardware: `slice_at` and `at_clock` put registers into the module, once for each
clock and slice, and give the value behind them.  Such registers move at every clock, so nothing may
be asked for while an `m.If` or `m.Switch` of the module is open: they would move only where its
condition holds.  That is refused.
"""

from __future__ import annotations

from amaranth import C, Cat, Module, Signal, Value
from amaranth.hdl._ast import Concat, Slice

from sculler_hdl.plan.arrival import Arrival, spans, width

APART = {"keep": 1}
"""`attrs` of a signal in registers that synthesis is not to make one with equal ones.

Equal registers are copies on purpose, each to stand near those that read it.  A mark holds among
marked registers: one without it is made one with any equal one.
"""


def refuse_conditional(m: Module, name: str) -> None:
    """Refuse to emit registers under a condition.

    Args:
        m: the module.
        name: of what would be delayed.

    Raises:
        RuntimeError: an `m.If`, `m.Switch` or `m.FSM` of the module is open.
    """
    if m.domain._depth:
        raise RuntimeError(f"{name}: delayed inside m.If or m.Switch; take it before, outside")


class SkewedSignal:
    """A signed word inside a module: its bits and when they arrive (`plan.arrival`).

    Args:
        m: the module, which gets the registers that delay bits.
        name: for those registers.
        value: the bits.
        arrival: when they are there.
        low: weight of the lowest bit, as a power of two.
        later: the bits a clock later, if registers of the module have them already.

    Raises:
        ValueError: the arrival is of another number of bits.
    """

    def __init__(
        self,
        m: Module,
        name: str,
        value: Value,
        arrival: Arrival,
        low: int = 0,
        later: Value | None = None,
    ) -> None:
        if len(value) != width(arrival):
            raise ValueError(f"{name}: {len(value)} bits do not arrive as {arrival}")
        self.m = m
        self.name = name
        self.value = value
        self.arrival = arrival
        self.low = low
        self.later = later
        self._made: dict[tuple[int, int, int], Value] = {}

    def slice_at(self, lo: int, hi: int, clock: int) -> Value:
        """Bits of weight 2^lo..2^(hi-1) at a clock: zeros below the word, its sign above.

        Emits the registers that they wait in, unless an earlier call has.

        Raises:
            ValueError: a bit is not there yet.
            RuntimeError: inside a conditional, where registers are needed.
        """
        top = self.low + len(self.value)
        parts: list[Value] = []
        if lo < min(hi, self.low):
            parts.append(C(0, min(hi, self.low) - lo))
        for first, end, arrives in spans(self.arrival, self.low):
            begin, stop = max(first, lo), min(end, hi)
            if begin < stop:
                parts.append(self._delayed(begin, stop, clock - arrives))
        if hi > top:
            sign = self._delayed(top - 1, top, clock - self.arrival[-1][1])
            parts += [sign, *[_innermost(sign)] * (hi - max(lo, top) - 1)]
        return Cat(*parts)

    def at_clock(self, clock: int) -> Value:
        """All bits at a clock, as `slice_at`."""
        return self.slice_at(self.low, self.low + len(self.value), clock)

    def _delayed(self, lo: int, hi: int, clocks: int) -> Value:
        if clocks < 0:
            raise ValueError(f"{self.name}: bits {lo}..{hi - 1} come {-clocks} clocks too late")
        key = (lo, hi, clocks)
        if key not in self._made:
            if clocks == 0:
                self._made[key] = self.value[lo - self.low : hi - self.low]
            elif clocks == 1 and self.later is not None:
                self._made[key] = self.later[lo - self.low : hi - self.low]
            else:
                refuse_conditional(self.m, self.name)
                before = self._delayed(lo, hi, clocks - 1)
                register = Signal(hi - lo, name=f"{self.name}_later{clocks}_{lo}", reset_less=True)
                self.m.d.sync += register.eq(before)
                self._made[key] = register
        return self._made[key]


def _innermost(bit: Value) -> Value:
    """A bit, taken from the signal itself and not from the word that is put together of signals.

    For bits that are repeated: Amaranth goes through all that each is taken from.
    """
    value, at = bit, 0
    while True:
        if isinstance(value, Slice):
            value, at = value.value, at + value.start
        elif isinstance(value, Concat):
            for part in value.parts:
                if at < len(part):
                    break
                at -= len(part)
            value = part
        else:
            return value[at : at + 1]


class ControlDelay:
    """A flag of one bit at every clock from `clock` on, in registers.

    Synthesis makes one of registers that are equal, and places far apart then share the wires of
    a single line; lines of one flag that differ in how they hold it stay apart.

    Args:
        m: the module.
        name: for the registers.
        value: the flag.
        clock: at which it is there.
        inverted: whether the registers hold its opposite.
        cleared: whether reset clears them.
        apart: whether they are marked (`APART`), which keeps them from all other lines.
    """

    def __init__(
        self,
        m: Module,
        name: str,
        value: Value,
        clock: int = 0,
        *,
        inverted: bool = False,
        cleared: bool = True,
        apart: bool = False,
    ) -> None:
        self.m = m
        self.name = name
        self.clock = clock
        self.inverted = inverted
        self.cleared = cleared
        self.apart = apart
        self._held: list[Value] = [~value if inverted else value]

    def at_clock(self, clock: int) -> Value:
        """The flag at a clock; emits the registers up to there, unless an earlier call has.

        Raises:
            ValueError: a clock before the flag is there.
            RuntimeError: inside a conditional, where registers are needed.
        """
        if clock < self.clock:
            raise ValueError(f"{self.name}: is there at clock {self.clock}, not at {clock}")
        while len(self._held) <= clock - self.clock:
            refuse_conditional(self.m, self.name)
            register = Signal(
                name=f"{self.name}_{self.clock + len(self._held)}",
                init=int(self.inverted),
                reset_less=not self.cleared,
                attrs=APART if self.apart else {},
            )
            self.m.d.sync += register.eq(self._held[-1])
            self._held.append(register)
        held = self._held[clock - self.clock]
        return ~held if self.inverted else held
