"""Handing results over to the host as a stream of words."""

from __future__ import annotations

from itertools import pairwise

from amaranth import C, Cat, Module, Mux, Signal, Value, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.losses import emit_event_counter
from sculler_hdl.pipelined.collector import Collector, Piece, Transfer, emit_counter
from sculler_hdl.pipelined.handover import result_layout
from sculler_hdl.plan.arrival import width
from sculler_hdl.plan.transfer import HandOverPlan
from sculler_model.design import AXES, STATUS_BITS, columns_of
from sculler_model.golden import COUNTER_BITS, WORD_BITS

PART = 8
"""Words of the shift register that move together."""


class StreamHandOver(wiring.Component):
    """Hands a result over word by word (`sculler_model.golden`) while the next interval runs.

    The bits of a result are put in their places in a shift register as they come by.  The
    sequencer sees to it that no bit of the next result comes before the last word is taken.

        input ─▶ [word N-1] ─▶ ... ─▶ [word 1] ─▶ [data]

    The shift register moves in parts of `PART` words: the first a clock after `data`, each a clock
    after the one before.  Where what is behind has not moved yet, it is looked at one word further
    back.  So the host's `ready` drives few registers, and what moves a part can lie beside it.  A
    mark goes along with the last word; a part that it has left moves no more, for the next result
    may be put there.

    Where results are dropped they are collected apart from the shift register, as in `HandOver`.

    Members:
        claim (clock `plan.moves.claim`): the result of a major interval will be on its way.
        major_end (clock `plan.clock`): it is; late (clock `plan.late`), if there is that clock:
            once more.
        status (clock `plan.status_clock`): its status but for bit 2; rail (`RAIL_DELAY` later):
            that.
        input: the bits of its components, as `plan.arrivals` says.
        number: of its number, as `plan.number` says, if it comes with the result.
        ready, valid: the host's handshake for each word; data, last: the word.
        taken: in the clock the host takes the last word.
        dropped: how many results were dropped.

    Latency: `plan.latency`, from an interval's last sample to `valid`; then a word every clock.

    Args:
        plan: the plan.

    Raises:
        ValueError: the plan is not of a stream.
    """

    def __init__(self, plan: HandOverPlan) -> None:
        if plan.column_words is None:
            raise ValueError("the plan hands whole results over")
        self.plan = plan
        self.column_words = plan.column_words
        self.columns = columns_of(tuple(plan.ranges))
        super().__init__(
            {
                "claim": In(1),
                "major_end": In(1),
                **({"late": In(1)} if plan.late is not None else {}),
                **({} if plan.number is None else {"number": In(width(plan.number))}),
                "status": In(STATUS_BITS),
                "rail": In(1),
                "input": In(result_layout(plan)),
                "ready": In(1),
                "valid": Out(1),
                "taken": Out(1),
                "dropped": Out(unsigned(COUNTER_BITS)),
                "data": Out(unsigned(WORD_BITS)),
                "last": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        collector = Collector(m, plan, self.major_end, self.late if plan.late is not None else None)
        count = len(self.columns) * self.column_words
        words = [
            self.data,
            *(Signal(WORD_BITS, name=f"word{i}") for i in range(1, count)),
        ]
        rest = collector.takes.rest
        pieces = collector.status(self.status, self.rail)
        pieces += map(self._extended, collector.components(self.input))
        if plan.number is not None:
            begins, show = self.major_end, rest.at_clock(plan.complete)
            pieces += map(self._filled, collector.number(self.number, plan.number))
        elif plan.moves is None:
            begins, show = self.major_end, rest.at_clock(plan.complete)
            major = emit_counter(m, self.major_end, WORD_BITS * self.column_words)
            pieces.append(Piece("major", 0, 0, plan.clock, self.major_end, major))
        else:
            was_taken = Signal()
            m.d.sync += was_taken.eq(self.taken)
            pieces += collector.majors()
            transfer = Transfer(m, plan.moves, rest, was_taken, self.claim)
            begins, show = transfer.lines.rest.at_clock(plan.moves.way), transfer.show
            pieces = transfer.collected(pieces)
            dropped = emit_event_counter(m, transfer.dropped, "results_dropped")
            m.d.comb += self.dropped.eq(dropped)
        self._shift(m, words, begins)
        for piece in pieces:
            self._put(m, words, piece)
        with m.If(show):
            m.d.sync += self.valid.eq(1)
        return m

    def _shift(self, m: Module, words: list[Signal], begins: Value) -> None:
        """One word after another to the host; `begins`: the next result comes."""
        marks = [self.last, *(Signal(name=f"mark{i}") for i in range(1, len(words)))]
        taken = Signal()
        m.d.comb += [
            taken.eq(self.valid & self.ready),
            self.taken.eq(taken & self.last),
        ]
        moves = self._moves(m, taken, begins, marks)
        beyond = C(0, WORD_BITS + 1)
        lanes = [Cat(word, mark) for word, mark in zip(words, marks, strict=True)]
        behind = [*lanes[1:], beyond, beyond]
        with m.If(taken):
            m.d.sync += lanes[0].eq(Mux(moves[0], behind[1], behind[0]))
            with m.If(self.last):
                m.d.sync += self.valid.eq(0)
        for i, lane in enumerate(lanes[1:], start=1):
            part, place = divmod(i - 1, PART)
            at_end = place == PART - 1 and part + 1 < len(moves)
            with m.If(moves[part]):
                later = Mux(moves[part + 1], behind[i + 1], behind[i]) if at_end else behind[i]
                m.d.sync += lane.eq(later)
        with m.If(begins):
            m.d.sync += marks[-1].eq(1)

    def _moves(self, m: Module, taken: Value, begins: Value, marks: list[Signal]) -> list[Signal]:
        """What moves each part: what has moved the one before, until the mark has left."""
        moves = [Signal(name=f"move{first}") for first in range(1, len(marks), PART)]
        m.d.sync += moves[0].eq(taken & ~self.last)
        for part, (before, move) in enumerate(pairwise(moves), start=1):
            busy, leaves = Signal(name=f"busy{part}"), move & marks[1 + part * PART]
            m.d.sync += [
                move.eq(before & busy & ~leaves),
                busy.eq(begins | (busy & ~leaves)),
            ]
        return moves

    def _extended(self, piece: Piece) -> Piece:
        """A piece of a component; its sign goes on to the column's end."""
        total = len(Value.cast(self.input[piece.of][piece.axis]))
        if piece.low + len(piece.bits) < total:
            return piece
        sign = piece.bits[-1].replicate(WORD_BITS * self.column_words - total)
        return piece._replace(bits=Cat(piece.bits, sign))

    def _filled(self, piece: Piece) -> Piece:
        """A piece of the number; zeros go on to the column's end."""
        total = len(self.number)
        if piece.low + len(piece.bits) < total:
            return piece
        zeros = C(0, WORD_BITS * self.column_words - total)
        return piece._replace(bits=Cat(piece.bits, zeros))

    def _put(self, m: Module, words: list[Signal], piece: Piece) -> None:
        """A piece into its place: bit `low` of a column's value."""
        column = piece.of if piece.of in self.columns else f"{piece.of}_{AXES[piece.axis]}"
        first = self.columns.index(column) * self.column_words
        low, bits = piece.low, piece.bits
        with m.If(piece.pulse):
            while len(bits):
                number, offset = divmod(low, WORD_BITS)
                part, bits = bits[: WORD_BITS - offset], bits[WORD_BITS - offset :]
                m.d.sync += words[first + number][offset : offset + len(part)].eq(part)
                low += len(part)
