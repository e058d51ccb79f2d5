"""Sums of cross products of many channels."""

from __future__ import annotations

from amaranth import Cat, Module, Signal, Value
from amaranth.lib.wiring import In

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.pipelined.cross_array import CrossArray, Steps
from sculler_hdl.pipelined_channels.accumulator import ChannelAccumulator
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.cross_array import CrossArrayPlan
from sculler_hdl.targets import Target
from sculler_model.design import AXES


class ChannelCrossArray(CrossArray):
    """As a `CrossArray`, but that each channel has totals of its own.

    If axes take turns, a channel's x, y and z stand in one memory.

    Members:
        launch: as of `CrossArray`.
        restart, channel (clock -`lead`): with a launch: the totals start from 0; whose they are.
        coning, sculling: the newest totals, for one clock.

    Args:
        plan, lead: as of `CrossArray`; the plan's axes may take turns, nothing else.
        target: whose memory blocks.
        channels: how many channels.
        primitive: whether to instantiate the target's multiplier blocks.
        in_blocks: whether to instantiate its memory blocks.
    """

    def __init__(
        self,
        plan: CrossArrayPlan,
        lead: int,
        target: Target,
        channels: int,
        *,
        primitive: bool,
        in_blocks: bool,
        inverted: bool = False,
    ) -> None:
        self.target = target
        self.channels = channels
        self.in_blocks = in_blocks
        further = {"restart": In(1), "channel": In(range(channels))}
        super().__init__(
            plan, lead, primitive=primitive, inverted=inverted, tell_unread=True, further=further
        )

    def _total(
        self, m: Module, name: str, lane: int, added: SkewedSignal, launch: Steps, last: Steps
    ) -> None:
        plan, turns = self.plan, self.plan.folding.axes == 3
        words = 2 * (1 << len(self.channel)) + self.channels if turns else self.channels
        adder = ChannelAccumulator(
            plan.accumulators[name], self.target, words, primitive=self.in_blocks
        )
        m.submodules[f"{name}_{AXES[lane]}_total"] = adder
        steps, clock, near = plan.steps_of(name), adder.plan.clock, self._near(name, lane)
        begins = clock - self.target.memory_latency
        m.d.comb += [
            adder.input.eq(self._signed(m, name, added, launch, near)),
            adder.step.eq(launch.during(steps, clock, near)),
            adder.restart.eq(self._restart(m, name, lane).during(steps, clock)),
            adder.address.eq(self._address(m, name, lane, launch, begins)),
            getattr(self, name)[lane].eq(adder.newest),
        ]

    def _restart(self, m: Module, name: str, lane: int) -> Steps:
        """The flag that a total starts from 0, as it goes along with a launch."""
        flag, value = f"restart_{name}_{AXES[lane]}", self.restart & self.launch
        return Steps(m, ControlDelay(m, flag, value, -self.lead, cleared=False))

    def _address(self, m: Module, name: str, lane: int, launch: Steps, clock: int) -> Value:
        """The place of a total in its memory, from a clock on for all steps of a launch."""
        label = f"channel_{name}_{AXES[lane]}"
        channel = SkewedSignal(m, label, self.channel, at_once(len(self.channel), -self.lead))
        if self.plan.folding.axes == 1:
            return channel.at_clock(clock)
        held = Signal(len(self.channel), name=f"{label}_held", reset_less=True)
        whose = channel.at_clock(clock - 1)
        with m.If(launch.flag.at_clock(clock - 1)):
            m.d.sync += held.eq(whose)
        return Cat(held, launch.during([1], clock), launch.during([2], clock))
