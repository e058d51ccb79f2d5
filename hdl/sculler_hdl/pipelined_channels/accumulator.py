"""Running sums of many channels, in block memory."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder import add
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.arrival import at_once, later, limbs
from sculler_hdl.targets import Target


class ChannelAccumulator(wiring.Component):
    """A running sum for each of many words of memory: ``newest' = before + input``.

    Each limb of the sum has a memory of its own, which is read `target.memory_latency` clocks
    before the limb is added and written in the clock after.  So a step at the same address may
    follow `target.memory_latency` + 2 clocks later; at another address in the next clock.

    Members:
        address (clock `plan.clock` - `target.memory_latency`): which sum.
        step, restart (clock `plan.clock`): the sum takes in `input`; it starts from 0.
        input: as it arrives.
        before: the sum as the step finds it, as `plan.before_arrival` says.
        newest: the sum that the step made, for one clock, as `plan.arrival` says.

    Latency: 1 clock and one for each limb; one step per clock.  Nothing is cleared by a reset.

    Args:
        plan: the plan, of steps in every clock.
        target: whose memory blocks.
        words: how many sums.
        primitive: whether to instantiate the target's memory blocks.
    """

    def __init__(
        self, plan: AccumulatorPlan, target: Target, words: int, *, primitive: bool
    ) -> None:
        self.plan = plan
        self.target = target
        self.words = words
        self.primitive = primitive
        super().__init__(
            {
                "address": In(range(words)),
                "step": In(1),
                "restart": In(1),
                "input": In(plan.item.bits),
                "before": Out(plan.before.bits),
                "newest": Out(plan.total.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step = ControlDelay(m, "step", self.step, plan.clock)
        restart = ControlDelay(m, "restart", self.restart, plan.clock, cleared=False)
        first = plan.clock - self.target.memory_latency
        arrival = at_once(len(self.address), first)
        address = SkewedSignal(m, "address", self.address, arrival)
        before: list[Value] = []
        memories = []
        for q, lo, hi in limbs(plan.total.bits, plan.limb):
            memory = BlockMemory(self.target, hi - lo, [0] * self.words, primitive=self.primitive)
            m.submodules[f"sums_{q}"] = memory
            m.d.comb += [
                memory.step.eq(1),
                memory.address.eq(address.at_clock(first + q)),
                memory.write.eq(step.at_clock(plan.clock + q + 1)),
                memory.write_address.eq(address.at_clock(plan.clock + q + 1)),
            ]
            present = Signal(hi - lo, name=f"present_{q}")
            m.d.comb += present.eq(Mux(restart.at_clock(plan.clock + q), 0, memory.data))
            before.append(present)
            memories.append((memory, lo, hi))
        found = SkewedSignal(m, "before", Cat(*before), later(plan.arrival, -1))
        made = add(
            found,
            SkewedSignal(m, "input", self.input, plan.item_arrival),
            "total",
            plan.total.bits,
            plan.clock,
            plan.limb,
        )
        for memory, lo, hi in memories:
            m.d.comb += memory.write_data.eq(made.value[lo:hi])
        m.d.comb += [
            self.newest.eq(made.value),
            self.before.eq(found.value[: len(self.before)]),
        ]
        return m
