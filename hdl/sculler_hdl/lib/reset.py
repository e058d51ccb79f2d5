"""A reset that begins at once and ends with the clock."""

from __future__ import annotations

from amaranth import C, ClockDomain, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_model.golden import RELEASE


class ResetRelease(wiring.Component):
    """Passes an asynchronous reset on; its end waits for the clock, so that all see it in one.

    `active` rises with `reset` and falls `RELEASE` rising edges of `clk` after it has fallen; after
    power-up it is high for as long.

    Members:
        clk, reset (in): the clock, and the reset, active high.
        active (out): the reset for the domain of that clock.
    """

    # Not Amaranth's `ResetSynchronizer`: its clock passes through an assignment, a delta cycle in
    # which a simulator's reset has fallen, so that there it ends a clock earlier than in Verilog.

    def __init__(self) -> None:
        super().__init__({"clk": In(1), "reset": In(1), "active": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.release = domain = ClockDomain("release", async_reset=True, local=True)
        domain.clk = self.clk
        m.d.comb += domain.rst.eq(self.reset)
        stages = [Signal(name=f"stage{number}", init=1) for number in range(RELEASE)]
        for before, stage in zip([C(0), *stages], stages, strict=False):
            m.d.release += stage.eq(before)
        m.d.comb += self.active.eq(stages[-1])
        return m
