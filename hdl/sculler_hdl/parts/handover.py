"""Handing results over to the host: all at once, or as a stream of words."""

from collections.abc import Iterator, Mapping

from amaranth import C, Cat, Module, Mux, Signal, Value, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import vector
from sculler_hdl.parts.losses import event_counter
from sculler_hdl.parts.words import Arrival, FlagLine, spans
from sculler_model.design import (
    AXES,
    HIGH_RESOLUTION_VECTORS,
    STATUS_BITS,
    STATUS_RAIL,
    VECTORS,
    WordLengths,
    columns_of,
)
from sculler_model.golden import COUNTER_BITS, PORT_MAJOR_BITS, WORD_BITS

RAIL = STATUS_RAIL.bit_length() - 1
RAIL_DELAY = 2
"""Clocks that the status bit of the rails comes after the others."""

LIMB = WORD_BITS
"""Bits of a result's number that are counted at a time."""

Arrivals = Mapping[str, list[Arrival]]
"""For each vector, when the bits of its three components are there.  Left out: always 0."""


def result_layout(words: WordLengths) -> data.StructLayout:
    """The vectors of a result, each as wide as its worst case."""
    names = (*VECTORS, *HIGH_RESOLUTION_VECTORS)
    ranges = {name: getattr(words, name) for name in names}
    return data.StructLayout({name: vector(r) for name, r in ranges.items() if r is not None})


def complete_clock(arrivals: Arrivals) -> int:
    """The clock at which a result's last bits are there."""
    return max(clock for three in arrivals.values() for one in three for _, clock in one)


class _Collector:
    """Takes the bits of a result where each comes by, at the clocks after `major_end`.

    The bits of each array and of alpha and nu have a line of their own, for they come from
    different places.  What is still under way at a reset may be taken all the same, but before
    anything of the next result is.
    """

    def __init__(self, m: Module, major_end: Value, clock: int, arrivals: Arrivals) -> None:
        self.arrivals = arrivals
        self.takes = _Lines(m, "takes", major_end, clock)

    def pieces(self, source: Value) -> Iterator[tuple[str, int, int, int, Value, Value]]:
        """(vector, axis, first bit, clock, pulse, bits) of each piece of the result."""
        for name, three in self.arrivals.items():
            for axis, arrival in enumerate(three):
                for lo, hi, clock in spans(arrival):
                    bits = Value.cast(source[name][axis])[lo:hi]
                    yield name, axis, lo, clock, self.takes.of(name).at(clock), bits


class _Lines:
    """A flag that moves data: one line for each array, one for the rest."""

    def __init__(self, m: Module, name: str, value: Value, clock: int = 0) -> None:
        self.within = FlagLine(m, f"{name}_within", value, clock, inverted=True, cleared=False)
        self.between = FlagLine(m, f"{name}_between", value, clock, cleared=False)
        self.rest = FlagLine(m, name, value, clock, inverted=True)

    def of(self, vector: str) -> FlagLine:
        """The one that a vector's bits are moved by."""
        if vector.endswith("_within"):
            return self.within
        return self.between if vector.endswith("_between") else self.rest


class Moves:
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


class HandOver(wiring.Component):
    """Shows a result while the next interval runs.

    The bits of a result are taken one after another as they come by; with the last ones the result
    is valid.  The sequencer sees to it that no bit of the next result comes while a result waits.

    With room for two results the bits are collected apart from the ports and go there by `Moves`:

        input ─▶ collected ─▶ output

    It is the same where results are `drop`ped, but the sequencer sees to nothing: a result that has
    not gone on from where it is collected when the next one's bits come is lost.

    Members:
        claim (clock `moves.claim`): the result of a major interval will be on its way.
        major_end (clock `clock`): it is.
        status (clock `clock` + 1): its status but for bit 2; rail (`RAIL_DELAY` later): that.
        input: the bits of its components, as `arrivals` says.
        ready, valid, taken: the host's handshake; `taken` in the clock it takes the result.
        dropped: how many results were dropped.
        shown_major, shown_status, output: what the host sees; nothing of use while `valid` is low.

    Args:
        words: the ranges of the components.
        arrivals: when their bits are there.
        clock: that `major_end` belongs to, not after the first bits.
        results: how many there is room for, 1 or 2.
        drop: whether results are dropped.

    Attributes:
        latency: clocks from an interval's last sample to `valid`.
    """

    def __init__(
        self,
        words: WordLengths,
        arrivals: Arrivals,
        clock: int,
        results: int = 1,
        drop: bool = False,
    ) -> None:
        self.layout = result_layout(words)
        self.arrivals = dict(arrivals)
        self.clock = clock
        self.majors = PORT_MAJOR_BITS // LIMB if drop else 0
        self.moves = Moves(arrivals, clock, self.majors) if results == 2 or drop else None
        self.complete = complete_clock(arrivals)
        self.latency = self.moves.latency if self.moves else self.complete + 1
        super().__init__(
            {
                "claim": In(1),
                "major_end": In(1),
                "status": In(STATUS_BITS),
                "rail": In(1),
                "input": In(self.layout),
                "ready": In(1),
                "valid": Out(1),
                "taken": Out(1),
                "dropped": Out(unsigned(COUNTER_BITS)),
                "shown_major": Out(unsigned(PORT_MAJOR_BITS)),
                "shown_status": Out(STATUS_BITS),
                "output": Out(self.layout),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        collector = _Collector(m, self.major_end, self.clock, self.arrivals)
        m.d.comb += self.taken.eq(self.valid & self.ready)
        was_taken = Signal()
        m.d.sync += was_taken.eq(self.taken)

        status_clock = self.clock + 1
        pieces: list[Piece] = []
        ports: list[Value] = []
        for bit, piece in _status(collector.takes.rest, status_clock, self.status, self.rail):
            pieces.append(piece)
            ports.append(self.shown_status[bit])
        if self.majors:
            pieces += _majors(m, collector.takes.rest, status_clock, self.majors)
            ports += [self.shown_major.word_select(i, LIMB) for i in range(self.majors)]
        else:
            m.d.comb += self.shown_major.eq(_counter(m, was_taken, PORT_MAJOR_BITS))
        for name, axis, lo, clock, pulse, bits in collector.pieces(self.input):
            pieces.append((name, clock, pulse, bits))
            ports.append(self.output[name][axis][lo : lo + len(bits)])
        if self.moves is None:
            show = collector.takes.rest.at(self.complete)
            shown = [(pulse, bits) for _, _, pulse, bits in pieces]
        else:
            going = _Going(m, self.moves, collector.takes.rest, was_taken, self.claim)
            show, shown = going.show, going.collected(pieces)
            if self.majors:
                m.d.comb += self.dropped.eq(event_counter(m, going.dropped, "results_dropped"))
        for (pulse, bits), port in zip(shown, ports, strict=True):
            with m.If(pulse):
                m.d.sync += port.eq(bits)
        m.d.sync += self.valid.eq(show | (self.valid & ~self.ready))
        return m


Piece = tuple[str, int, Value, Value]
"""Bits of a result that come together: of what, when, the pulse that takes them, the bits."""


class _Going:
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

    def __init__(self, m: Module, moves: Moves, line: FlagLine, taken: Value, claim: Value) -> None:
        self.m = m
        self.moves = moves
        waits, busy, starts, self.dropped = Signal(), Signal(), Signal(), Signal(name="dropped")
        due = line.at(moves.start + 1 - moves.way) | waits
        m.d.comb += [starts.eq(due & ~busy), self.dropped.eq(due & busy & claim)]
        m.d.sync += [
            waits.eq(due & busy & ~claim),
            busy.eq(starts | (busy & ~taken)),
        ]
        self.show = FlagLine(m, "show", starts).at(moves.way + moves.steps - 1)
        self.lines = _Lines(m, "moves", starts)

    def collected(self, pieces: list[Piece]) -> list[tuple[Value, Value]]:
        """Each piece where it is collected, with the pulse by which it goes on from there."""
        going: list[tuple[Value, Value]] = []
        for i, (name, clock, pulse, bits) in enumerate(pieces):
            held = Signal(len(bits), name=f"collected{i}_{name}", reset_less=True)
            with self.m.If(pulse):
                self.m.d.sync += held.eq(bits)
            going.append((self.lines.of(name).at(self.moves.way + self.moves.step(clock)), held))
        return going


def _status(line: FlagLine, clock: int, status: Value, rail: Value) -> list[tuple[int, Piece]]:
    """Each bit of the status of a result of `line`, by its number; the rails' comes later."""
    return [
        (
            bit,
            ("status", when, line.at(when), rail if bit == RAIL else status[bit]),
        )
        for bit in range(STATUS_BITS)
        for when in [clock + RAIL_DELAY if bit == RAIL else clock]
    ]


def _majors(m: Module, line: FlagLine, clock: int, limbs: int) -> list[Piece]:
    """The number of each result of `line`, limb by limb, one a clock."""
    number = _counter(m, line.at(clock), LIMB * limbs)
    return [
        ("major", clock + i, line.at(clock + i), number.word_select(i, LIMB)) for i in range(limbs)
    ]


class StreamHandOver(wiring.Component):
    """Hands a result over word by word (`sculler_model.golden`) while the next interval runs.

    The bits of a result are put in their places in a shift register as they come by.  The
    sequencer sees to it that no bit of the next result comes before the last word is taken.

        input ─▶ [word N-1] ─▶ ... ─▶ [word 1] ─▶ [data]

    The shift register moves one clock after `data`, which meanwhile looks one word further back,
    so that the host's `ready` drives few registers.

    Where results are `drop`ped they are collected apart from the shift register, as in `HandOver`.

    Members:
        claim (clock `moves.claim`): the result of a major interval will be on its way.
        major_end (clock `clock`): it is.
        status (clock `clock` + 1): its status but for bit 2; rail (`RAIL_DELAY` later): that.
        input: the bits of its components, as `arrivals` says.
        ready, valid: the host's handshake for each word; data, last: the word.
        taken: in the clock the host takes the last word.
        dropped: how many results were dropped.

    A word every clock.

    Args:
        words: the ranges of the components.
        column_words: words of each column.
        arrivals: when the bits of the components are there.
        clock: that `major_end` belongs to, not after the first bits.
        drop: whether results are dropped.

    Attributes:
        latency: clocks from an interval's last sample to `valid`.
    """

    def __init__(
        self,
        words: WordLengths,
        column_words: int,
        arrivals: Arrivals,
        clock: int,
        drop: bool = False,
    ) -> None:
        self.column_words = column_words
        self.arrivals = dict(arrivals)
        self.clock = clock
        self.moves = Moves(arrivals, clock, column_words) if drop else None
        self.complete = complete_clock(arrivals)
        self.latency = self.moves.latency if self.moves else self.complete + 1
        layout = result_layout(words)
        self.columns = columns_of(tuple(layout.members))
        super().__init__(
            {
                "claim": In(1),
                "major_end": In(1),
                "status": In(STATUS_BITS),
                "rail": In(1),
                "input": In(layout),
                "ready": In(1),
                "valid": Out(1),
                "taken": Out(1),
                "dropped": Out(unsigned(COUNTER_BITS)),
                "data": Out(unsigned(WORD_BITS)),
                "last": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        collector = _Collector(m, self.major_end, self.clock, self.arrivals)
        count = len(self.columns) * self.column_words
        words = [
            self.data,
            *(Signal(WORD_BITS, name=f"word{i}") for i in range(1, count)),
        ]

        # one word after another to the host
        taken, move = Signal(), Signal()
        left = Signal(range(count))  # words after the one in `data`
        m.d.comb += [
            taken.eq(self.valid & self.ready),
            self.taken.eq(taken & self.last),
        ]
        m.d.sync += move.eq(taken)
        with m.If(taken):
            m.d.sync += [
                self.data.eq(Mux(move, words[2], words[1])),
                left.eq(left - 1),
                self.last.eq(left == 1),
            ]
            with m.If(self.last):
                m.d.sync += self.valid.eq(0)
        with m.If(move):
            for word, behind in zip(words[1:], [*words[2:], C(0, WORD_BITS)], strict=True):
                m.d.sync += word.eq(behind)

        # a result's bits to their places: bit `lo` of a column's value
        rest, status_clock = collector.takes.rest, self.clock + 1
        pieces: list[Piece] = []
        places: list[tuple[str, int]] = []
        for bit, piece in _status(rest, status_clock, self.status, self.rail):
            pieces.append(piece)
            places.append(("status", bit))
        for name, axis, lo, clock, pulse, bits in collector.pieces(self.input):
            total = Value.cast(self.input[name][axis])
            if lo + len(bits) == len(total):  # the sign goes on to the column's end
                missing = WORD_BITS * self.column_words - len(total)
                bits = Cat(bits, bits[-1].replicate(missing))
            pieces.append((name, clock, pulse, bits))
            places.append((f"{name}_{AXES[axis]}", lo))
        if self.moves is None:
            begins, show = self.major_end, rest.at(self.complete)
            major = _counter(m, self.major_end, WORD_BITS * self.column_words)
            shown = [(pulse, bits) for _, _, pulse, bits in pieces]
            shown.append((self.major_end, major))
            places.append(("major", 0))
        else:
            was_taken = Signal()
            m.d.sync += was_taken.eq(self.taken)
            pieces += _majors(m, rest, status_clock, self.column_words)
            places += [("major", i * LIMB) for i in range(self.column_words)]
            going = _Going(m, self.moves, rest, was_taken, self.claim)
            begins, show = going.lines.rest.at(self.moves.way), going.show
            shown = going.collected(pieces)
            m.d.comb += self.dropped.eq(event_counter(m, going.dropped, "results_dropped"))
        with m.If(begins):
            m.d.sync += [left.eq(count - 1), self.last.eq(0)]
        for (pulse, bits), (column, lo) in zip(shown, places, strict=True):
            first = self.columns.index(column) * self.column_words
            with m.If(pulse):
                while len(bits):
                    number, offset = divmod(lo, WORD_BITS)
                    part, bits = bits[: WORD_BITS - offset], bits[WORD_BITS - offset :]
                    word = words[first + number]
                    m.d.sync += word[offset : offset + len(part)].eq(part)
                    lo += len(part)
        with m.If(show):
            m.d.sync += self.valid.eq(1)
        return m


def _counter(m: Module, step: Value, bits: int) -> Value:
    """The number of `step`s, which have to be two clocks apart or more.

    Its limbs of `LIMB` bits change one by one: it is right a clock for each of them after a step.
    """
    limbs = [Signal(min(LIMB, bits - lo), name=f"major_{lo}") for lo in range(0, bits, LIMB)]
    for i, limb in enumerate(limbs):
        with m.If(step):
            m.d.sync += limb.eq(limb + 1)
        if i + 1 < len(limbs):
            full, carry = Signal(name=f"major_full{i}"), Signal(name=f"major_carry{i}")
            m.d.sync += [full.eq(limb.all()), carry.eq(step & full)]
            step = carry
    return Cat(*limbs)
