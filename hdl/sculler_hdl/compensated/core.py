"""A core with compensation before it."""

from __future__ import annotations

from amaranth import Module
from amaranth.lib import wiring

from sculler_hdl.compact.core import CompactCore
from sculler_hdl.compensated.stage import Compensator
from sculler_hdl.lib.layout import core_members, hand_counts, sample_counts
from sculler_hdl.lib.losses import Losses
from sculler_hdl.pipelined.core import PipelinedCore
from sculler_hdl.plan.compensation import plan_compensation
from sculler_hdl.plan.ports import counter_ports, result_ports
from sculler_hdl.plan.timing import timing
from sculler_model.design import Design


class CompensatedCore(wiring.Component):
    """A core that takes known errors out of the sensor's samples before it sums them up.

    sample ─▶ Compensator ─▶ the core, for wider samples ─▶ result

    Ports: those of the core for the sensor's counts.  Samples that are lost are lost before the
    compensation.

    Latency: `timing`, that of the core and `timing.compensation` clocks before it.

    Args:
        design: the design, with compensation.
        primitive: as for the cores.

    Attributes:
        plan: of the compensation.
        core: the core behind it.
        timing: clocks they take.
        resources: the plans' figures, for the manifest.
        block_groups, listing: the core's.

    Raises:
        InputError: see `plan_pipelined`.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.plan = plan_compensation(design)
        made = CompactCore if design.hardware.core == "compact" else PipelinedCore
        self.core = made(design.inner, primitive=primitive, behind=True)
        self.timing = timing(design)
        self.resources = {**self.core.resources, **self.plan.resources}
        groups = self.core.block_groups
        self.block_groups = groups and tuple(
            tuple(f"core.{block}" for block in group) for group in groups
        )
        self.listing = self.core.listing
        super().__init__(core_members(design))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.losses = losses = Losses()
        m.submodules.compensation = stage = Compensator(self.plan, primitive=self.primitive)
        m.submodules.core = core = self.core
        made = [port for ports in sample_counts(core).values() for port in ports]
        shown = [port.name for port in result_ports(self.design)]
        shown += [port.name for port in counter_ports(self.design) if port.name != "samples_lost"]
        m.d.comb += [
            losses.sample_valid.eq(self.sample_valid),
            losses.sample_ready.eq(stage.sample_ready),
            self.samples_lost.eq(losses.count),
            self.sample_ready.eq(stage.sample_ready),
            stage.sample_valid.eq(self.sample_valid),
            *hand_counts(self, stage),
            stage.fault.eq(self.sample_fault),
            stage.lost.eq(losses.lost),
            core.sample_valid.eq(stage.made_valid),
            stage.made_ready.eq(core.sample_ready),
            *(port.eq(stage.made[i][: len(port)]) for i, port in enumerate(made)),
            core.sample_fault.eq(stage.made_fault),
            core.sample_rail.eq(stage.made_rail),
            core.sample_lost.eq(stage.made_lost),
            self.result_valid.eq(core.result_valid),
            core.result_ready.eq(self.result_ready),
            *(getattr(self, name).eq(getattr(core, name)) for name in shown),
        ]
        return m
