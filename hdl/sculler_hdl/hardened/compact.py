"""The hardened compact core: copies of it that take the same samples and agree on what they do.

samples ─┬─▶ copy 0 ─┐
         ├─▶ copy 1 ─┼─▶ agreement ─▶ result, with status bit 4
         └─▶ copy 2 ─┘       └─▶ which differs ─▶ started again at the next major interval
"""

from __future__ import annotations

from amaranth import Module, Mux, Signal, Value
from amaranth.lib import wiring

from sculler_hdl.compact.core import CompactCore
from sculler_hdl.hardened.copies import Copies, any_of, copies_of, handshake
from sculler_hdl.lib.layout import core_members
from sculler_model.design import STATUS_UPSET, Design


class HardenedCompactCore(wiring.Component):
    """A compact core that tells of upsets, or recovers from them, as `hardware.hardening` says.

    "detect": two copies.  The first one's outputs go to the ports, and where the other differs an
    upset is told.  Nothing is taken or given unless both are ready for it.

    "recover": three copies.  The majority of their outputs goes to the ports.  Each digit that is
    stored is the majority's too, so that what accumulates is right in all of them.  A copy that
    differs is started again when the last sample of a major interval has been taken.  In the next
    interval it sees its samples come as the others do, and it agrees with them when its history has
    filled.  While it starts no sample is taken.

    Ports: those of `CompactCore`, and
        upset: an upset was seen, and not all results that may be hurt have been taken.
    Status bit 4 is high as long as that is (`sculler_model.golden`).

    Latency: that of the compact core.

    Args:
        design: the design.
        primitive: as for `CompactCore`.

    Attributes:
        plan, timing, block_groups, listing: as those of `CompactCore`.
        resources: how many copies there are, and the figures of one.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.copies = copies_of(CompactCore, design, primitive)
        first = self.copies[0]
        self.plan, self.timing = first.plan, first.timing
        self.resources = {"copies": len(self.copies), **first.resources}
        self.block_groups, self.listing = first.block_groups, first.listing
        super().__init__(core_members(design))

    def elaborate(self, platform: object) -> Module:
        m, hold = Module(), Signal()
        copies = Copies(m, self, self.copies, self.design, self.timing)
        copies.connect_samples(hold)
        copies.connect("digit")
        for name in copies.counters:
            m.d.comb += getattr(self, name).eq(copies.connect(name))
        valid, last = Signal(), Signal()
        m.d.comb += [
            valid.eq(handshake(copies.every("result_valid"))),
            last.eq(copies.common("result_last")),
        ]
        seen = copies.differences(self._looked(copies, valid))
        if not copies.pair:
            seen = copies.restarts(seen, copies.common("ends_major"), hold)
        upset = copies.tell(any_of(seen), valid & self.result_ready & last)
        mark = Mux(upset & copies.common("at_status"), STATUS_UPSET, 0)
        m.d.comb += [
            self.upset.eq(upset),
            self.result_valid.eq(valid),
            self.result_last.eq(last),
            self.result_data.eq(copies.common("result_data") | mark),
        ]
        for copy in self.copies:
            m.d.comb += copy.result_ready.eq(self.result_ready & valid)
        return m

    @staticmethod
    def _looked(copies: Copies, valid: Value) -> dict[str, Value]:
        """The outputs that are compared, each with when it means anything.

        Where the majority mends at once what one copy holds, in counters and words of results, no
        difference is looked for.
        """
        always, storing = Value.cast(1), copies.common("storing")
        looked = dict.fromkeys(
            ("sample_ready", "result_valid", "ends_major", "storing", "stores"), always
        )
        looked |= {"digit": storing, "result_last": valid, "at_status": valid}
        if copies.pair:
            looked |= dict.fromkeys(copies.counters, always) | {"result_data": valid}
        return looked
