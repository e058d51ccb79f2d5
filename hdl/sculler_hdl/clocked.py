"""The core with the clock, the reset and the clock enable that its design asks for."""

from __future__ import annotations

from amaranth import ClockDomain, Elaboratable
from amaranth.hdl import Fragment
from amaranth.lib import wiring
from amaranth.lib.wiring import In

from sculler_hdl.core import Core
from sculler_hdl.lib.clock_enable import ClockEnableInserter
from sculler_hdl.lib.layout import core_members
from sculler_hdl.lib.reset import ResetRelease
from sculler_hdl.plan.ports import clock_ports


class ClockedCore(wiring.Component):
    """A core as its Verilog module shows it: with `clk`, its reset and, if asked for, `clk_en`.

    An asynchronous reset acts at once and ends with the clock (`ResetRelease`); `sample_ready` is
    low as long.

    Members: those of `sculler_hdl.plan.ports.clock_ports`, then the core's own.

    Args:
        core: the core, which becomes a part of this one.
    """

    def __init__(self, core: Core) -> None:
        self.core = core
        self.design = design = core.design
        clocks = {port.name: In(port.bits) for port in clock_ports(design)}
        super().__init__(clocks | core_members(design))
        for name in core.signature.members:
            if not (name == "sample_ready" and design.hardware.resets_at_once):
                setattr(self, name, getattr(core, name))

    def elaborate(self, platform: object) -> Fragment:
        hardware = self.design.hardware
        core: Elaboratable = self.core
        if hardware.clock_enable:
            core = ClockEnableInserter(self.clk_en)(core)
        fragment = Fragment.get(core, platform)  # what follows is in the core's own module
        domain = ClockDomain("sync", async_reset=hardware.resets_at_once)
        domain.clk = self.clk
        fragment.add_domains(domain)
        reset = ~self.rst_n if hardware.reset_active == "low" else self.rst
        if not hardware.resets_at_once:
            fragment.add_statements("comb", domain.rst.eq(reset))
            return fragment
        release = ResetRelease()
        fragment.add_subfragment(Fragment.get(release, platform), "reset_release")
        fragment.add_statements(
            "comb",
            release.clk.eq(self.clk),
            release.reset.eq(reset),
            domain.rst.eq(release.active),
            self.sample_ready.eq(self.core.sample_ready & ~release.active),
        )
        return fragment
