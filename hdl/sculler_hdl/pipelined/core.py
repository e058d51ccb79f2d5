"""The pipelined core: up to one six-axis sample per clock, exact results once a major interval.

    sample ─▶ Sequencer ─▶ Datapath ─▶ HandOver or StreamHandOver ─▶ result
              Losses

The clock in which a sample is taken is clock 0 for all that follows from it.  Numbers travel as
skewed words (`plan.arrival`): the low bits of a sum are worked on first, the high bits in the
clocks after.  Each part's plan says at which clock it takes and gives what; the flags of a sample
travel beside it (`ControlDelay`) and are looked at at those clocks.
"""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.layout import sample_counts
from sculler_hdl.lib.losses import Losses
from sculler_hdl.lib.one_core import OneCore, agreed_members
from sculler_hdl.pipelined.datapath import Datapath
from sculler_hdl.pipelined.handover import HandOver
from sculler_hdl.pipelined.rails import emit_rail, emit_told_rail
from sculler_hdl.pipelined.sequencer import Sequencer
from sculler_hdl.pipelined.stream import StreamHandOver
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.pipelined import plan_pipelined
from sculler_hdl.plan.schedule import STATUS_CLOCK
from sculler_model.design import AXES, Design
from sculler_model.golden import PORT_MAJOR_BITS


def ties(design: Design) -> dict[str, wiring.Member]:
    """Further members of a core that is one of several copies which agree on all they do.

    Members:
        agreed_ready (in): a sample that is offered is taken.
        agreed_samples_lost, agreed_result_major (in): what its counters count on from.
        ends_major (out): the sample that ends a major interval is taken in this clock.
        restart (in), where `hardware.hardening` is "recover": as a reset.
    """
    return {
        **agreed_members(design),
        "agreed_result_major": In(PORT_MAJOR_BITS),
        "ends_major": Out(1),
    }


class PipelinedCore(OneCore):
    """Coning and sculling accumulators of one design, exact in every bit.

    Ports (clock `clk`, synchronous `rst`; the handshake contract is `sculler_model.golden`):
        sample_valid, sample_ready; sample_gyro_x..z, sample_accel_x..z (signed counts),
        sample_fault.
        result_valid, result_ready; result_major (unsigned), result_status (4 bits), and
        result_NAME for each of `sculler_model.design.COMPONENTS`, signed, worst-case wide; or
        result_data, result_last, the stream of words.
        samples_lost, and results_dropped where the design drops results.

    Throughput: one sample every `timing.spacing` clocks.  Within a major interval nothing stalls;
    the last sample of an interval waits while there is no room for its result (`timing.results`).

    Latency: `timing.latency`, from an interval's last sample to `result_valid`.

    Args:
        design: the design.
        primitive: whether to instantiate the target's own multiplier blocks.
        tied: whether it is one of the copies of a hardened core (`ties`), which hands whole results
            over and drops none.
        behind: whether it stands behind compensation, which tells of losses and rails
            (`behind_members`).

    Attributes:
        plan: what it is built of.
        timing: clocks it takes.
        resources: the plan's figures, for the manifest.
        block_groups: names of its multiplier blocks in groups (`Schedule.block_groups`).
        listing: None, there is no schedule to read.

    Raises:
        InputError: see `plan_pipelined`.
    """

    def _prepare(self) -> None:
        self.plan = plan_pipelined(self.design)
        self.timing = self.plan.timing
        self.schedule = self.plan.schedule
        results = self.timing.results
        self.sequencer = Sequencer(self.design, self.timing.spacing, results, tied=self.tied)
        made = self.schedule.handover(results)
        stream = self.design.hardware.handover == "stream"
        self.handover: HandOver | StreamHandOver = (
            StreamHandOver(made) if stream else HandOver(made, tied=self.tied)
        )
        self.resources = self.plan.resources
        self.block_groups = tuple(map(tuple, self.schedule.block_groups))
        self.listing = None

    def _ties(self) -> dict[str, wiring.Member]:
        return ties(self.design)

    def _made(self) -> Module:
        m = Module()
        m.submodules.sequencer = sequencer = self.sequencer
        m.submodules.handover = handover = self.handover
        losses = None if self.behind else Losses(tied=self.tied)
        if losses is not None:
            m.submodules.losses = losses
        m.d.comb += [
            sequencer.sample_valid.eq(self.sample_valid),
            sequencer.sample_fault.eq(self.sample_fault),
            sequencer.result_taken.eq(handover.taken),
            sequencer.sample_lost.eq(self.sample_lost if losses is None else losses.lost),
        ]
        if losses is not None:
            m.d.comb += [
                losses.sample_valid.eq(self.sample_valid),
                losses.sample_ready.eq(self.agreed_ready if self.tied else sequencer.sample_ready),
            ]
        m.d.comb += self.sample_ready.eq(sequencer.sample_ready)
        if losses is not None:
            m.d.comb += self.samples_lost.eq(losses.count)
        if isinstance(handover, HandOver) and self.tied and losses is not None:
            m.d.comb += [
                sequencer.agreed_ready.eq(self.agreed_ready),
                losses.held.eq(self.agreed_samples_lost),
                handover.held_major.eq(self.agreed_result_major),
                self.ends_major.eq(sequencer.major_end),
            ]
        datapath = Datapath(
            m,
            self.schedule,
            sequencer,
            sample_counts(self),
            handover.input,
            primitive=self.primitive,
        )
        datapath.emit()
        self._status(m, datapath)
        self._results(m, datapath.control["gyro"].major_end)
        return m

    def _status(self, m: Module, datapath: Datapath) -> None:
        """The status of the interval so far, to the hand-over at the clocks it asks for."""
        sequencer, handover, control = self.sequencer, self.handover, datapath.control["gyro"]
        status = Signal(3)
        news = Cat(sequencer.short, sequencer.fault, sequencer.lost)
        with m.If(control.taken.at_clock(1)):
            m.d.sync += status.eq(Mux(sequencer.first, 0, status) | news)
        held = SkewedSignal(m, "status", status, at_once(3, 2))  # the next sample starts another
        short, fault, lost = held.at_clock(STATUS_CLOCK)
        if self.behind:
            rail = emit_told_rail(m, self.sample_rail, control.taken, control.major_end)
        else:
            rail = emit_rail(m, datapath.samples.first, control.taken, control.major_end)
        m.d.comb += [
            handover.major_end.eq(control.major_end.at_clock(handover.plan.clock)),
            handover.status.eq(Cat(short, fault, 0, lost)),
            handover.rail.eq(rail),
        ]
        if datapath.finishing is not None:
            m.d.comb += handover.late.eq(datapath.finishing)

    def _results(self, m: Module, ended: ControlDelay) -> None:
        """From the hand-over to the ports."""
        handover = self.handover
        m.d.comb += [
            handover.ready.eq(self.result_ready),
            self.result_valid.eq(handover.valid),
        ]
        if self.design.drops_results and handover.plan.moves is not None:
            m.d.comb += [
                handover.claim.eq(ended.at_clock(handover.plan.moves.claim)),
                self.results_dropped.eq(handover.dropped),
            ]
        if isinstance(handover, StreamHandOver):
            m.d.comb += [self.result_data.eq(handover.data), self.result_last.eq(handover.last)]
            return
        m.d.comb += [
            self.result_major.eq(handover.shown_major),
            self.result_status.eq(handover.shown_status),
        ]
        for name in self.design.vectors:
            for i, axis in enumerate(AXES):
                m.d.comb += getattr(self, f"result_{name}_{axis}").eq(handover.output[name][i])
