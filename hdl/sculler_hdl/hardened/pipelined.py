"""The hardened pipelined core: copies of it that take the same samples, and what they agree on."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring

from sculler_hdl.hardened.copies import Copies, any_of, copies_of, handshake
from sculler_hdl.lib.layout import core_members
from sculler_hdl.pipelined.core import PipelinedCore
from sculler_hdl.plan.ports import result_ports
from sculler_hdl.plan.timing import LOOKING, timing
from sculler_model.design import STATUS_UPSET, Design


class HardenedPipelinedCore(wiring.Component):
    """A pipelined core that tells of upsets, or recovers from them, as `hardware.hardening` says.

    "detect": two copies.  The first one's outputs go to the ports, and where the other differs an
    upset is told.  Nothing is taken or given unless both are ready for it, and a result is shown
    when it has been looked at, `LOOKING` clocks after both have it.

    "recover": three copies.  The majority of their outputs goes to the ports.  The numbers they
    count are the majority's too.  A copy whose handshakes differ is started again in the clock
    after the one that takes the last sample of a major interval; the next sample waits for it.  All
    else in a copy heals by itself when the next interval begins.

    Ports: those of `PipelinedCore` with whole results, and
        upset: an upset was seen, and not all results that may be hurt have been taken.
    Status bit 4 is high as long as that is (`sculler_model.golden`).

    Latency: that of the pipelined core; "detect": `LOOKING` clocks more.

    Args:
        design: the design.
        primitive: as for `PipelinedCore`.

    Attributes:
        plan, block_groups, listing: as those of `PipelinedCore`, of one copy.
        timing: clocks it takes.
        resources: how many copies there are, and the figures of one.

    Raises:
        InputError: see `plan_pipelined`.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.copies = copies_of(PipelinedCore, design, primitive)
        first = self.copies[0]
        self.plan = first.plan
        self.timing = timing(design)
        self.resources = {"copies": len(self.copies), **first.resources}
        self.block_groups, self.listing = None, None
        super().__init__(core_members(design))

    def elaborate(self, platform: object) -> Module:
        m, hold = Module(), Signal()
        copies = Copies(m, self, self.copies, self.design, self.timing)
        copies.connect_samples(hold)
        for name in (*copies.counters, "result_major"):
            m.d.comb += getattr(self, name).eq(copies.connect(name))
        made, valid = Signal(), Signal()
        m.d.comb += made.eq(handshake(copies.every("result_valid")))
        m.d.comb += valid.eq(made & self._looked_at(m, made) if copies.pair else made)
        results = [port.name for port in result_ports(self.design) if port.name != "result_major"]
        always = Value.cast(1)
        looked = dict.fromkeys(("sample_ready", "result_valid", "ends_major"), always)
        if copies.pair:
            looked |= dict.fromkeys((*copies.counters, "result_major"), always)
            looked |= dict.fromkeys(results, made)
        else:
            looked["result_status"] = made
        seen = copies.differences(looked)
        if not copies.pair:
            seen = copies.restarts(seen, copies.common("ends_major"), hold)
        upset = copies.tell(any_of(seen), valid & self.result_ready)
        for name in results:
            m.d.comb += getattr(self, name).eq(copies.common(name))
        m.d.comb += [
            self.upset.eq(upset),
            self.result_valid.eq(valid),
            self.result_status.eq(copies.common("result_status") | Mux(upset, STATUS_UPSET, 0)),
        ]
        for copy in self.copies:
            m.d.comb += copy.result_ready.eq(self.result_ready & valid)
        return m

    @staticmethod
    def _looked_at(m: Module, made: Value) -> Value:
        """Whether a result has been there for `LOOKING` clocks."""
        been = Signal(LOOKING)
        m.d.sync += been.eq(Mux(made, Cat(made, been[:-1]), 0))
        return been[-1]
