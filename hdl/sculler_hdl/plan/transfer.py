"""When the bits of a result are there, are collected, and go on to the ports.

`sculler_hdl.pipelined.handover` builds what is planned here.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

from sculler_hdl.plan.arrival import Arrival
from sculler_model.design import (
    FOURTH_ORDER_VECTORS,
    HIGH_RESOLUTION_VECTORS,
    THIRD_ORDER_VECTORS,
    VECTORS,
    Interval,
    WordLengths,
)
from sculler_model.golden import PORT_MAJOR_BITS, WORD_BITS

RAIL_DELAY = 2
"""Clocks that the status bit of the rails comes after the others."""

LIMB = WORD_BITS
"""Bits of a result's number that are counted at a time."""

Arrivals = Mapping[str, list[Arrival]]
"""For each vector, when the bits of its three components are there.  Left out: always 0."""


class Origin(Enum):
    """The part of the core that bits of a result come from."""

    WITHIN = "within"
    BETWEEN = "between"
    REST = "rest"


ORIGINS: Mapping[str, Origin] = {
    "coning_within": Origin.WITHIN,
    "sculling_within": Origin.WITHIN,
    "coning_between": Origin.BETWEEN,
    "sculling_between": Origin.BETWEEN,
}
"""Of the vectors that come from an array; all else is the rest."""


def origin_of(piece: str) -> Origin:
    """Where a vector, or another piece of a result, comes from."""
    return ORIGINS.get(piece, Origin.REST)


def complete_clock(arrivals: Arrivals) -> int:
    """The clock at which a result's last bits are there."""
    return max(clock for three in arrivals.values() for one in three for _, clock in one)


class TransferPlan:
    """When the bits of a result go on from where they are collected to the ports.

    In `steps` clocks, those that came last in the last: so most go as soon as they have come, and
    no wire tells all of them to go.

    Args:
        arrivals: when the bits are there.
        clock: of `major_end`, a clock before the result's status is there.
        majors: limbs of the result's number that go with it, one a clock from its status on.

    Attributes:
        way: clocks from the decision that a result goes to where its first bits do: registers on
            the way to all of them.
        start: the clock before the first bits go, if the ports are free.
        latency: clocks from an interval's last sample to `valid`.
        refill: clocks from when a result is taken to when one that waits is on the ports.
        least_gap: clocks from one interval's last sample to the next one's, at least.
        possible: that the next result's bits come late enough if it is let in when, of the two
            before, the first has been taken.
        claim: the last clock in which it may still be decided that the result before goes, so that
            its bits have gone when this one's come.
    """

    way = 3

    def __init__(self, arrivals: Arrivals, clock: int, majors: int = 0) -> None:
        complete = max(complete_clock(arrivals), clock + majors)
        self.steps = min(6, complete - clock + 2 - self.way)
        self.start = complete - self.steps + 1
        self.latency = complete + 2
        self.refill = self.way + self.steps + 2
        comes = {
            *range(clock + 1, clock + 1 + max(majors, 1)),
            clock + 1 + RAIL_DELAY,
            *(when for three in arrivals.values() for one in three for _, when in one),
        }
        self.least_gap = max(self.start + 1 + self.step(when) - when for when in comes)
        self.claim = min(when - self.step(when) for when in comes) - self.way
        self.possible = all(when > self.step(when) + self.way for when in comes)

    def step(self, clock: int) -> int:
        """The step in which bits go that come at a clock."""
        return max(clock - self.start, 0)


class HandOverPlan:
    """The plan of a `HandOver` or a `StreamHandOver`.

    Args:
        words: the ranges of the components.
        arrivals: when their bits are there.
        clock: that `major_end` belongs to, not after the first bits.
        results: how many there is room for, 1 or 2; a stream has room for 1.
        drop: whether results are dropped.
        column_words: words of each column of a stream; None hands whole results over.
        late: that `late` belongs to, a flag of its own for the bits that come from then on; None if
            there is none.
        number: when the bits of the result's number are there, if it comes with the result.

    Attributes:
        ranges: of the components of each vector.
        status_clock: at which the status is there, but for the rails' bit.
        complete: the clock at which a result's last bits are there.
        moves: when bits go on from where they are collected, if they are collected apart.
        majors: limbs of the result's number that go with it; 0 if results are counted at the ports.
        latency: clocks from an interval's last sample to `valid`.
    """

    def __init__(
        self,
        words: WordLengths,
        arrivals: Arrivals,
        clock: int,
        results: int = 1,
        *,
        drop: bool = False,
        column_words: int | None = None,
        late: int | None = None,
        number: Arrival | None = None,
    ) -> None:
        names = (
            *VECTORS,
            *HIGH_RESOLUTION_VECTORS,
            *THIRD_ORDER_VECTORS,
            *FOURTH_ORDER_VECTORS,
        )
        ranges = {name: getattr(words, name) for name in names}
        self.ranges: dict[str, Interval] = {n: r for n, r in ranges.items() if r is not None}
        self.arrivals = dict(arrivals)
        self.clock = clock
        self.late = late
        self.number = number
        self.status_clock = clock + 1
        self.column_words = column_words
        self.complete = complete_clock(arrivals)
        if number is not None:
            self.complete = max(self.complete, *(clock for _, clock in number))
        self.majors = (column_words or PORT_MAJOR_BITS // LIMB) if drop else 0
        apart = drop or results == 2
        self.moves = TransferPlan(arrivals, clock, self.majors) if apart else None
        self.latency = self.moves.latency if self.moves else self.complete + 1
