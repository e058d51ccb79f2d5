"""The compact core: small, exact, one multiplication at a time.

sample ─▶ Loader ─▶ sample memory ─▶ Engine ─▶ result memory ─▶ Reader ─▶ stream of words
             Control ──────────────────┘
"""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.compact.control import Control
from sculler_hdl.compact.engine import Engine
from sculler_hdl.compact.loader import Loader
from sculler_hdl.compact.reader import Reader, read_results
from sculler_hdl.lib.layout import hand_counts
from sculler_hdl.lib.losses import Losses, emit_event_counter
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.lib.one_core import OneCore, agreed_members
from sculler_hdl.plan.compact.digits import OPERAND
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_model.design import Design
from sculler_model.golden import WORD_BITS, words_per_result


def ties(design: Design) -> dict[str, wiring.Member]:
    """Further members of a core that is one of several copies which agree on all they do.

    Members:
        agreed_ready (in): a sample that is offered is taken.
        agreed_samples_lost, agreed_results_dropped (in): what its counters count on from.
        storing, digit (out), agreed_digit (in): as those of `Engine`.
        stores (out): where a word of the result is stored, if one is, and that it is the last.
        at_status (out): the word on `result_data` is the lowest of the status.
        ends_major (out): the sample that ends a major interval was taken in the clock before.
        restart (in), where `hardware.hardening` is "recover": as a reset.
    """
    address = (words_per_result(design) - 1).bit_length()
    return {
        **agreed_members(design),
        "storing": Out(1),
        "digit": Out(OPERAND.bits),
        "agreed_digit": In(OPERAND.bits),
        "stores": Out(2 + address),
        "at_status": Out(1),
        "ends_major": Out(1),
    }


class CompactCore(OneCore):
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
        tied: whether it is one of the copies of a hardened core (`ties`).
        behind: whether it stands behind compensation, which tells of losses and rails
            (`behind_members`).

    Attributes:
        plan: what it is built of.
        timing: the clocks it takes.
        resources: the plan's figures, for the manifest.
        block_groups: None, it does not matter where its one multiplier block stands.
        listing: its schedule as text.
    """

    def _prepare(self) -> None:
        self.plan = plan_compact(self.design)
        self.timing = self.plan.timing
        self.resources = self.plan.resources
        self.block_groups = None
        self.listing = self.plan.listing

    def _ties(self) -> dict[str, wiring.Member]:
        return ties(self.design)

    def _made(self) -> Module:
        m, plan = Module(), self.plan
        m.submodules.control = control = Control(plan)
        m.submodules.loader = loader = Loader(plan, told=self.behind)
        m.submodules.engine = engine = Engine(plan, primitive=self.primitive, tied=self.tied)
        m.submodules.reader = reader = Reader(plan, tied=self.tied)
        losses = None if self.behind else Losses(tied=self.tied)
        if losses is not None:
            m.submodules.losses = losses
        m.submodules.samples = samples = BlockMemory(
            plan.target, OPERAND.bits, [0] * (1 << len(loader.address)), primitive=self.primitive
        )
        m.submodules.results = results = BlockMemory(
            plan.target, WORD_BITS, [0] * (1 << len(reader.address)), primitive=self.primitive
        )
        ready = self.agreed_ready if self.tied else self.sample_ready
        take = self.sample_valid & ready
        # once high it stays so until a sample is taken: nothing else makes these true
        waits = loader.busy | engine.starting | (control.has_work & engine.busy) | control.blocked
        m.d.sync += self.sample_ready.eq(~(take | waits))
        m.d.comb += [
            # a sample is loaded
            loader.take.eq(take),
            *hand_counts(self, loader),
            samples.write.eq(loader.write),
            samples.write_address.eq(loader.address),
            samples.write_data.eq(loader.data),
            control.take.eq(take),
            control.fault.eq(self.sample_fault),
            control.lost.eq(self.sample_lost if losses is None else losses.lost),
            control.rail.eq(loader.rail),
            *self._counted(losses, ready),
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
            *read_results(self, engine, results, reader),
        ]
        if self.design.drops_results:
            held = self.agreed_results_dropped if self.tied else None
            dropped = emit_event_counter(m, reader.dropped, "results_dropped", held)
            m.d.comb += self.results_dropped.eq(dropped)
        if self.behind:
            m.d.comb += loader.told_rail.eq(self.sample_rail)
        if self.tied and losses is not None:
            m.d.comb += [losses.held.eq(self.agreed_samples_lost), *self._tied(engine, reader)]
            m.d.sync += self.ends_major.eq(take & control.conditions.major_end)
        return m

    def _tied(self, engine: Engine, reader: Reader) -> list[object]:
        """What one of several copies tells the others, and is told."""
        return [
            engine.agreed_digit.eq(self.agreed_digit),
            self.digit.eq(engine.digit),
            self.storing.eq(engine.storing),
            self.stores.eq(
                Cat(engine.publish, engine.store, Mux(engine.store, engine.store_address, 0))
            ),
            self.at_status.eq(reader.at_status),
        ]

    def _counted(self, losses: Losses | None, ready: Value) -> list[object]:
        """What counts samples that are lost, unless what stands before the core does."""
        if losses is None:
            return []
        return [
            losses.sample_valid.eq(self.sample_valid),
            losses.sample_ready.eq(ready),
            self.samples_lost.eq(losses.count),
        ]
