"""The compact core with many channels.

sample ─▶ ChannelLoader ─▶ sample memory ─▶ Engine ─▶ result memory ─▶ Reader ─▶ stream of words
          ChannelControl ──────────────────┘          and whose each result is
"""

from __future__ import annotations

from amaranth import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring

from sculler_hdl.channels.control import ChannelControl
from sculler_hdl.channels.loader import ChannelLoader
from sculler_hdl.compact.engine import Engine
from sculler_hdl.compact.reader import Reader, read_results
from sculler_hdl.lib.layout import core_members, hand_counts
from sculler_hdl.lib.losses import emit_event_counter
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.compact.digits import OPERAND
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.ports import channel_bits
from sculler_model.design import Design
from sculler_model.golden import WORD_BITS


class ChannelCore(wiring.Component):
    """Coning and sculling accumulators of many sensors, each for itself, exact in every bit.

    One engine works for all channels, on one sample after another.  What outlives a sample stands
    in block memory, a part for each channel: the newest samples, what has been summed up, and where
    the channel stands in its major interval.

    Ports (clock `clk`, synchronous `rst`; the contract is `sculler_model.golden.channel_cycles`):
        sample_valid, sample_ready; sample_gyro_x..z, sample_accel_x..z (signed counts),
        sample_fault, sample_channel, sample_restart.
        result_valid, result_ready, result_data, result_last, result_channel: the words of
        `sculler_model.golden`, and whose they are.
        samples_lost.

    Args:
        design: the design.
        primitive: as for `CompactCore`.

    Attributes:
        plan, timing, resources, block_groups, listing: as those of `CompactCore`.
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
        m, plan, design = Module(), self.plan, self.design
        m.submodules.control = control = ChannelControl(plan)
        m.submodules.loader = loader = ChannelLoader(plan)
        m.submodules.engine = engine = Engine(plan, primitive=self.primitive)
        m.submodules.reader = reader = Reader(plan)
        words = design.channels << len(loader.address)
        m.submodules.samples = samples = BlockMemory(
            plan.target, OPERAND.bits, [0] * words, primitive=self.primitive
        )
        m.submodules.results = results = BlockMemory(
            plan.target, WORD_BITS, [0] * (1 << len(reader.address)), primitive=self.primitive
        )
        take = self.sample_valid & self.sample_ready
        m.d.sync += self.sample_ready.eq(~(control.waits | engine.starting))
        m.d.comb += [
            # a sample is looked up and loaded
            control.take.eq(take),
            control.channel.eq(self.sample_channel),
            control.fault.eq(self.sample_fault),
            control.restart.eq(self.sample_restart),
            loader.take.eq(take),
            *hand_counts(self, loader),
            loader.begin.eq(control.begin),
            loader.new_slot.eq(control.slot),
            loader.zeros.eq(control.zeros),
            samples.write.eq(loader.write),
            samples.write_address.eq(Cat(loader.address, control.owner)),
            samples.write_data.eq(loader.data),
            control.loaded.eq(loader.loaded),
            control.rail.eq(loader.rail),
            control.busy.eq(engine.busy),
            control.result_taken.eq(reader.taken),
            # the engine works on it
            engine.launch.eq(control.launch),
            engine.conditions.eq(control.conditions),
            engine.at_rail.eq(control.at_rail),
            engine.slot.eq(loader.slot),
            engine.phase.eq(control.phase),
            engine.channel.eq(control.owner),
            samples.step.eq(engine.step),
            samples.address.eq(Cat(engine.sample_address, engine.owner)),
            engine.sample_data.eq(samples.data.as_signed()),
            *read_results(self, engine, results, reader),
        ]
        self._tell_owners(m, engine, reader)
        self._count_losses(m, control)
        return m

    def _tell_owners(self, m: Module, engine: Engine, reader: Reader) -> None:
        """Whose the result in each bank is."""
        shown = reader.address[-reader.bank_bits :]
        told: Value = C(0)
        for bank in range(self.plan.sizes.result_banks):
            owner = Signal(channel_bits(self.design), name=f"owner{bank}", reset_less=True)
            with m.If(engine.publish & (reader.filling == bank)):
                m.d.sync += owner.eq(engine.owner)
            told = Mux(shown == bank, owner, told)
        m.d.comb += self.result_channel.eq(told)

    def _count_losses(self, m: Module, control: ChannelControl) -> None:
        """A sample whose offer is withdrawn marks the channel that was offered, and is counted."""
        refused, withdrawn = Signal(), Signal()
        offered, whose = (Signal(channel_bits(self.design), name=n) for n in ("offered", "whose"))
        m.d.sync += [
            refused.eq(self.sample_valid & ~self.sample_ready),
            offered.eq(self.sample_channel),
            withdrawn.eq(refused & ~self.sample_valid),
            whose.eq(offered),
        ]
        m.d.comb += [
            control.lose.eq(withdrawn & (whose < self.design.channels)),
            control.lost_channel.eq(whose),
            self.samples_lost.eq(emit_event_counter(m, withdrawn, "samples_lost")),
        ]
