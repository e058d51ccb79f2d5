"""The core, and parts around it, with the clocks and resets that a design asks for."""

from __future__ import annotations

from typing import Any

from amaranth import ClockDomain, Elaboratable, Value
from amaranth.hdl import Fragment
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.core import Core
from sculler_hdl.lib.clock_enable import ClockEnableInserter
from sculler_hdl.lib.layout import core_members
from sculler_hdl.lib.reset import ResetRelease
from sculler_hdl.plan.ports import clock_ports, reset_name
from sculler_model.design import Design


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
        reset = getattr(self, reset_name(self.design))
        active = _add_clock(fragment, platform, self.design, "sync", self.clk, reset)
        if hardware.resets_at_once:
            fragment.add_statements("comb", self.sample_ready.eq(self.core.sample_ready & ~active))
        return fragment


class ClockedPart(wiring.Component):
    """A part around the core with clocks and resets as ports: `clk` and `bus_clk`, and of each one.

    An asynchronous reset is as that of the core; as long as it lasts nothing is taken: `ready` of
    a handshake is low, `stall` is high.  A clock enable is a member of the part itself.

    Members: `clk`, `bus_clk` and their resets as far as there are such domains, then the part's.

    Args:
        part: the part, which becomes a part of this one.
        design: of which it is.
        domains: its clock domains by the clock's port: `{"clk": "sync"}`.
        taking: those outputs by which it takes something, which are low until a reset has ended.
        stalling: those that are high as long.  Both are of the last domain.
    """

    def __init__(
        self,
        part: Any,
        design: Design,
        domains: dict[str, str],
        taking: frozenset[str] = frozenset(),
        stalling: frozenset[str] = frozenset(),
    ) -> None:
        self.part = part
        self.design = design
        self.domains = domains
        self.gated = {
            name: name in stalling
            for name in part.signature.members
            if name in taking | stalling and design.hardware.resets_at_once
        }
        resets = {port: reset_name(design, port.replace("clk", "rst")) for port in domains}
        self.resets = resets
        clocks = {name: In(1) for pair in resets.items() for name in pair}
        gated = dict.fromkeys(self.gated, Out(1))
        super().__init__(clocks | dict(part.signature.members.items()) | gated)
        for name in part.signature.members:
            if name not in self.gated:
                setattr(self, name, getattr(part, name))

    def elaborate(self, platform: object) -> Fragment:
        fragment = Fragment.get(self.part, platform)
        for port, domain in self.domains.items():
            clk, reset = getattr(self, port), getattr(self, self.resets[port])
            active = _add_clock(fragment, platform, self.design, domain, clk, reset)
        for name, high in self.gated.items():
            own, outer = getattr(self.part, name), getattr(self, name)
            shown = own | active if high else own & ~active
            fragment.add_statements("comb", outer.eq(shown))
        return fragment


def _add_clock(
    fragment: Fragment, platform: object, design: Design, name: str, clk: Value, reset: Value
) -> Value:
    """Give a fragment a clock domain with the design's kind of reset; while this one is active."""
    hardware = design.hardware
    domain = ClockDomain(name, async_reset=hardware.resets_at_once)
    domain.clk = clk
    fragment.add_domains(domain)
    active = ~reset if hardware.reset_active == "low" else reset
    if not hardware.resets_at_once:
        fragment.add_statements("comb", domain.rst.eq(active))
        return active
    release = ResetRelease()
    label = "reset_release" if name == "sync" else f"{name}_reset_release"
    fragment.add_subfragment(Fragment.get(release, platform), label)
    fragment.add_statements(
        "comb", release.clk.eq(clk), release.reset.eq(active), domain.rst.eq(release.active)
    )
    return release.active
