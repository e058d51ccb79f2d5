"""Handing whole results over to the host."""

from __future__ import annotations

from amaranth import Module, Signal, Value, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.layout import vector
from sculler_hdl.lib.losses import emit_event_counter
from sculler_hdl.pipelined.collector import Collector, Piece, Transfer, emit_counter
from sculler_hdl.plan.transfer import LIMB, HandOverPlan
from sculler_model.design import STATUS_BITS
from sculler_model.golden import COUNTER_BITS, PORT_MAJOR_BITS


def result_layout(plan: HandOverPlan) -> data.StructLayout:
    """The vectors of a result, each as wide as its worst case."""
    return data.StructLayout({name: vector(range_) for name, range_ in plan.ranges.items()})


class HandOver(wiring.Component):
    """Shows a result while the next interval runs.

    The bits of a result are taken one after another as they come by; with the last ones the result
    is valid.  The sequencer sees to it that no bit of the next result comes while a result waits.

    With room for two results the bits are collected apart from the ports and go there by a
    `TransferPlan`:

        input ─▶ collected ─▶ output

    It is the same where results are dropped, but the sequencer sees to nothing: a result that has
    not gone on from where it is collected when the next one's bits come is lost.

    Members:
        claim (clock `plan.moves.claim`): the result of a major interval will be on its way.
        major_end (clock `plan.clock`): it is; late (clock `plan.late`), if there is that clock:
            once more.
        status (clock `plan.status_clock`): its status but for bit 2; rail (`RAIL_DELAY` later):
            that.
        input: the bits of its components, as `plan.arrivals` says.
        ready, valid, taken: the host's handshake; `taken` in the clock it takes the result.
        dropped: how many results were dropped.
        held_major, where it is `tied`: what the number of the result counts on from, instead of
            itself.
        shown_major, shown_status, output: what the host sees; nothing of use while `valid` is low.

    Latency: `plan.latency`, from an interval's last sample to `valid`.

    Args:
        plan: the plan.
        tied: see `held_major`.
    """

    def __init__(self, plan: HandOverPlan, *, tied: bool = False) -> None:
        self.plan = plan
        self.tied = tied
        layout = result_layout(plan)
        super().__init__(
            {
                "claim": In(1),
                "major_end": In(1),
                **({"late": In(1)} if plan.late is not None else {}),
                "status": In(STATUS_BITS),
                "rail": In(1),
                "input": In(layout),
                "ready": In(1),
                "valid": Out(1),
                "taken": Out(1),
                "dropped": Out(unsigned(COUNTER_BITS)),
                "shown_major": Out(unsigned(PORT_MAJOR_BITS)),
                "shown_status": Out(STATUS_BITS),
                "output": Out(layout),
                **({"held_major": In(PORT_MAJOR_BITS)} if tied else {}),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        collector = Collector(m, plan, self.major_end, self.late if plan.late is not None else None)
        m.d.comb += self.taken.eq(self.valid & self.ready)
        was_taken = Signal()
        m.d.sync += was_taken.eq(self.taken)

        pieces = collector.status(self.status, self.rail)
        if plan.majors:
            pieces += collector.majors()
        else:
            held = self.held_major if self.tied else None
            number = emit_counter(m, was_taken, PORT_MAJOR_BITS, held)
            m.d.comb += self.shown_major.eq(number)
        pieces += collector.components(self.input)
        if plan.moves is None:
            show = collector.takes.rest.at_clock(plan.complete)
        else:
            transfer = Transfer(m, plan.moves, collector.takes.rest, was_taken, self.claim)
            show, pieces = transfer.show, transfer.collected(pieces)
            if plan.majors:
                dropped = emit_event_counter(m, transfer.dropped, "results_dropped")
                m.d.comb += self.dropped.eq(dropped)
        for piece in pieces:
            with m.If(piece.pulse):
                m.d.sync += self._place(piece).eq(piece.bits)
        m.d.sync += self.valid.eq(show | (self.valid & ~self.ready))
        return m

    def _place(self, piece: Piece) -> Value:
        """The ports' bits that a piece is shown on."""
        if piece.of == "status":
            return self.shown_status[piece.low]
        if piece.of == "major":
            return self.shown_major.word_select(piece.low // LIMB, LIMB)
        return self.output[piece.of][piece.axis][piece.low : piece.low + len(piece.bits)]
