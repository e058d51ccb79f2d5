"""The compact core: small, exact, one multiplication at a time.

sample ─▶ Loader ─▶ sample memory ─▶ Engine ─▶ result memory ─▶ Reader ─▶ stream of words
             Control ──────────────────┘
"""

from __future__ import annotations

from amaranth import Cat, Module
from amaranth.lib import wiring

from sculler_hdl.compact.control import Control
from sculler_hdl.compact.engine import Engine
from sculler_hdl.compact.loader import Loader
from sculler_hdl.compact.memory import BlockMemory
from sculler_hdl.compact.reader import Reader
from sculler_hdl.lib.layout import core_members
from sculler_hdl.lib.losses import Losses, emit_event_counter
from sculler_hdl.plan.compact.digits import OPERAND
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_model.design import AXES, Design
from sculler_model.golden import WORD_BITS


class CompactCore(wiring.Component):
    """Coning and sculling accumulators of one design, exact in every bit.

    Ports (clock `clk`, synchronous `rst`; the handshake contract is `sculler_model.golden`):
        sample_valid, sample_ready; sample_gyro_x..z, sample_accel_x..z (signed counts),
        sample_fault.
        result_valid, result_ready, result_data, result_last: the words of `sculler_model.golden`.
        samples_lost, and results_dropped where the design drops results.

    Args:
        design: the design.
        primitive: whether to instantiate the target's own blocks; False infers all of them, with
            the same behaviour on every clock.

    Attributes:
        plan: what it is built of.
        timing: the clocks it takes.
        resources: the plan's figures, for the manifest.
        block_groups: None, it does not matter where its one multiplier block stands.
        listing: its schedule as text.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.plan = plan_compact(design)
        self.timing = self.plan.timing
        self.resources = self.plan.resources
        self.block_groups = None
        self.listing = self.plan.listing
        super().__init__(core_members(design))

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        m.submodules.control = control = Control(plan)
        m.submodules.loader = loader = Loader(plan)
        m.submodules.engine = engine = Engine(plan, primitive=self.primitive)
        m.submodules.reader = reader = Reader(plan)
        m.submodules.losses = losses = Losses()
        m.submodules.samples = samples = BlockMemory(
            plan.target, OPERAND.bits, [0] * (1 << len(loader.address)), primitive=self.primitive
        )
        m.submodules.results = results = BlockMemory(
            plan.target, WORD_BITS, [0] * (1 << len(reader.address)), primitive=self.primitive
        )
        take = self.sample_valid & self.sample_ready
        # once high it stays so until a sample is taken: nothing else makes these true
        waits = loader.busy | engine.starting | (control.has_work & engine.busy) | control.blocked
        m.d.sync += self.sample_ready.eq(~(take | waits))
        m.d.comb += [
            # a sample is loaded
            loader.take.eq(take),
            *(
                getattr(loader, sensor)[i].eq(getattr(self, f"sample_{sensor}_{axis}"))
                for sensor in ("gyro", "accel")
                for i, axis in enumerate(AXES)
            ),
            samples.write.eq(loader.write),
            samples.write_address.eq(loader.address),
            samples.write_data.eq(loader.data),
            control.take.eq(take),
            control.fault.eq(self.sample_fault),
            control.lost.eq(losses.lost),
            control.rail.eq(loader.rail),
            losses.sample_valid.eq(self.sample_valid),
            losses.sample_ready.eq(self.sample_ready),
            self.samples_lost.eq(losses.count),
            control.loaded.eq(loader.loaded),
            control.result_taken.eq(reader.taken),
            # the engine works on it
            engine.launch.eq(loader.loaded & control.has_work),
            engine.conditions.eq(control.conditions),
            engine.at_rail.eq(control.at_rail),
            engine.slot.eq(loader.slot),
            samples.step.eq(engine.step),
            samples.address.eq(engine.sample_address),
            engine.sample_data.eq(samples.data.as_signed()),
            results.write.eq(engine.store),
            results.write_address.eq(Cat(engine.store_address, reader.filling ^ engine.bank)),
            results.write_data.eq(engine.store_data),
            # the result is read
            reader.publish.eq(engine.publish),
            reader.ready.eq(self.result_ready),
            results.step.eq(1),
            results.address.eq(reader.address),
            self.result_valid.eq(reader.valid),
            self.result_data.eq(results.data),
            self.result_last.eq(reader.last),
        ]
        if self.design.drops_results:
            dropped = emit_event_counter(m, reader.dropped, "results_dropped")
            m.d.comb += self.results_dropped.eq(dropped)
        return m
