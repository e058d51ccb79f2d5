"""The bits of a result, taken where each comes by, and on their way to the ports."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from amaranth import Cat, Module, Signal, Value

from sculler_hdl.lib.delay import ControlDelay
from sculler_hdl.plan.arrival import Arrival, spans
from sculler_hdl.plan.transfer import (
    LIMB,
    RAIL_DELAY,
    HandOverPlan,
    Origin,
    TransferPlan,
    origin_of,
)
from sculler_model.design import STATUS_BITS, STATUS_RAIL

RAIL = STATUS_RAIL.bit_length() - 1
"""Number of the status bit that comes after the others."""


class Piece(NamedTuple):
    """Bits of a result that come together.

    Attributes:
        of: the vector that they are of, or status, or major.
        axis, low: of which component, from which bit on; for the status and the number axis is 0.
        clock: at which they are there.
        pulse: which takes them then.
        bits: what they are.
    """

    of: str
    axis: int
    low: int
    clock: int
    pulse: Value
    bits: Value


class Renewed(ControlDelay):
    """A flag that comes once more, much later, and goes on from there: no register between.

    Args:
        early, late: the flag, and the same when it comes once more.
    """

    def __init__(self, early: ControlDelay, late: ControlDelay) -> None:
        self.early, self.late = early, late

    def at_clock(self, clock: int) -> Value:
        """The flag at a clock."""
        return (self.late if clock >= self.late.clock else self.early).at_clock(clock)


class Lines:
    """A flag that moves data: one line for each array, one for the rest.

    They come from different places.  What is still under way at a reset may be taken all the same,
    but before anything of the next result is.
    """

    def __init__(
        self,
        m: Module,
        name: str,
        value: Value,
        clock: int = 0,
        late: ControlDelay | None = None,
    ) -> None:
        self.rest = ControlDelay(m, name, value, clock, inverted=True)
        if late is not None:
            self.rest = Renewed(self.rest, late)
        self._by_origin = {
            Origin.WITHIN: ControlDelay(
                m, f"{name}_within", value, clock, inverted=True, cleared=False
            ),
            Origin.BETWEEN: ControlDelay(m, f"{name}_between", value, clock, cleared=False),
            Origin.REST: self.rest,
        }

    def of(self, piece: str) -> ControlDelay:
        """The one that a vector, the status or the number is moved by."""
        return self._by_origin[origin_of(piece)]


class Collector:
    """Takes the bits of a result where each comes by, at the clocks after `major_end`.

    Args:
        m: the module, which gets the registers.
        plan: when the bits come.
        major_end: a result comes, at `plan.clock`.
        late: the same at `plan.late`, if there is such a clock.

    Attributes:
        takes: `major_end` at later clocks.
    """

    def __init__(
        self, m: Module, plan: HandOverPlan, major_end: Value, late: Value | None = None
    ) -> None:
        self.m = m
        self.plan = plan
        renewed = None
        if late is not None and plan.late is not None:
            renewed = ControlDelay(m, "takes_late", late, plan.late, inverted=True)
        self.takes = Lines(m, "takes", major_end, plan.clock, renewed)

    def status(self, status: Value, rail: Value) -> list[Piece]:
        """Each bit of the status; the rails' comes later."""
        pieces = []
        for bit in range(STATUS_BITS):
            late = RAIL_DELAY if bit == RAIL else 0
            clock = self.plan.status_clock + late
            pulse = self.takes.rest.at_clock(clock)
            pieces.append(Piece("status", 0, bit, clock, pulse, rail if late else status[bit]))
        return pieces

    def majors(self) -> list[Piece]:
        """The number of each result, limb by limb, one a clock."""
        line, clock, limbs = self.takes.rest, self.plan.status_clock, self.plan.majors
        number = emit_counter(self.m, line.at_clock(clock), LIMB * limbs)
        return [
            Piece(
                "major",
                0,
                i * LIMB,
                clock + i,
                line.at_clock(clock + i),
                number.word_select(i, LIMB),
            )
            for i in range(limbs)
        ]

    def number(self, number: Value, arrival: Arrival) -> Iterator[Piece]:
        """Each piece of a number that comes with its result."""
        for lo, hi, clock in spans(arrival):
            yield Piece("major", 0, lo, clock, self.takes.rest.at_clock(clock), number[lo:hi])

    def components(self, source: Value) -> Iterator[Piece]:
        """Each piece of the components in `source`, a vector of three by name."""
        for name, three in self.plan.arrivals.items():
            for axis, arrival in enumerate(three):
                for lo, hi, clock in spans(arrival):
                    bits = Value.cast(source[name][axis])[lo:hi]
                    yield Piece(name, axis, lo, clock, self.takes.of(name).at_clock(clock), bits)


class Transfer:
    """Results go on from where they are collected.

    Args:
        m: the module.
        moves: when their bits do.
        line: `major_end`.
        taken: the clock before the host took a result whole.
        claim: the next result will be on its way: what has not gone by then is dropped.

    Attributes:
        dropped: the result that waits is dropped.
        lines: the decision that a result goes, by what is moved.
        show: its last bits go.
    """

    def __init__(
        self, m: Module, moves: TransferPlan, line: ControlDelay, taken: Value, claim: Value
    ) -> None:
        self.m = m
        self.moves = moves
        waits, busy, starts, self.dropped = Signal(), Signal(), Signal(), Signal(name="drops")
        due = line.at_clock(moves.start + 1 - moves.way) | waits
        m.d.comb += [starts.eq(due & ~busy), self.dropped.eq(due & busy & claim)]
        m.d.sync += [
            waits.eq(due & busy & ~claim),
            busy.eq(starts | (busy & ~taken)),
        ]
        self.show = ControlDelay(m, "show", starts).at_clock(moves.way + moves.steps - 1)
        self.lines = Lines(m, "moves", starts)

    def collected(self, pieces: list[Piece]) -> list[Piece]:
        """Each piece where it is collected, with the pulse by which it goes on from there."""
        going = []
        for i, piece in enumerate(pieces):
            held = Signal(len(piece.bits), name=f"collected{i}_{piece.of}", reset_less=True)
            with self.m.If(piece.pulse):
                self.m.d.sync += held.eq(piece.bits)
            clock = self.moves.way + self.moves.step(piece.clock)
            pulse = self.lines.of(piece.of).at_clock(clock)
            going.append(piece._replace(pulse=pulse, bits=held))
        return going


def emit_counter(m: Module, step: Value, bits: int, held: Value | None = None) -> Value:
    """The number of `step`s, which have to be two clocks apart or more.

    Its limbs of `LIMB` bits change one by one: it is right a clock for each of them after a step.
    It counts on from `held`, where that is given, instead of its own number.
    """
    limbs = [Signal(min(LIMB, bits - lo), name=f"major_{lo}") for lo in range(0, bits, LIMB)]
    for i, limb in enumerate(limbs):
        number = limb
        if held is not None:
            number = held.word_select(i, LIMB)[: len(limb)]
            m.d.sync += limb.eq(number)
        with m.If(step):
            m.d.sync += limb.eq(number + 1)
        if i + 1 < len(limbs):
            full, carry = Signal(name=f"major_full{i}"), Signal(name=f"major_carry{i}")
            m.d.sync += [full.eq(limb.all()), carry.eq(step & full)]
            step = carry
    return Cat(*limbs)
