"""A core placed and routed in a real device: from a plan to figures and an `Outcome`."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from sculler.words import Advance, silent
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.outputs import gathering
from sculler_sim.place import netlist, placement
from sculler_sim.place.devices import Device, find_device
from sculler_sim.place.placement import Placement, Placer

SAME = "identical to the golden model"


@dataclass(frozen=True)
class Plan:
    """What to place, and where.

    Attributes:
        design: the design.
        device_name: of the device, as `find_device` takes it.
        speed_grade: of an ECP5, 6 to 8, of a LIFCL-40, 7 to 9; None for the slowest.
        seeds: how many times to place and route; the median counts.
        check: simulate the netlist that is placed against the golden model.

    Raises:
        InputError: there is no such device or speed grade, or no model of its cells to check with.
    """

    design: Design
    device_name: str
    speed_grade: int | None = None
    seeds: int = 3
    check: bool = False

    def __post_init__(self) -> None:
        device = self.device  # refuses what is none
        if self.check and not device.routed:
            raise InputError(f"{device.name}: no models of its cells here, leave out --check")

    @property
    def device(self) -> Device:
        """The device of that name."""
        return self._found[0]

    @property
    def speed(self) -> int | None:
        """Its speed grade; None where it has but one."""
        return self._found[1]

    @property
    def steps(self) -> int:
        """Of the work, for a progress bar."""
        return self.seeds + 2 + self.check

    @cached_property
    def _found(self) -> tuple[Device, int | None]:
        return find_device(self.device_name, self.speed_grade)


@dataclass(frozen=True)
class Outcome:
    """What came of it.

    Attributes:
        plan: what was asked for.
        placement: rate, area and worst path.
        placer: has the netlist and Yosys' log.
        difference: the first difference of the netlist's results from the golden model's; None
            where there is none or it was not looked for.
    """

    plan: Plan
    placement: Placement
    placer: Placer
    difference: str | None = None

    @property
    def netlist(self) -> str | None:
        """What the check found, None without one."""
        return (self.difference or SAME) if self.plan.check else None

    def as_json(self) -> dict[str, Any]:
        """Plain data; the content of report.json."""
        data = self.placement.as_json()
        return data if self.netlist is None else data | {"netlist": self.netlist}

    def told(self) -> dict[str, str]:
        """In words, row by row."""
        rows = describe(self.placement)
        return rows if self.netlist is None else rows | {"netlist": self.netlist}

    def write(self, folder: Path) -> str:
        """Write report.json, the netlist and the log into a folder; they appear together.

        Returns:
            What was written, in words.

        Raises:
            InputError: the folder cannot be made or written to.
        """
        synthesis, name = self.placer.synthesis, f"{self.plan.design.name}_netlist.v"
        texts = {
            name: synthesis.netlist,
            "yosys.log": synthesis.log,
            "report.json": json.dumps(self.as_json(), indent=2) + "\n",
        }
        with gathering(folder) as gathered:
            for file, text in texts.items():
                (gathered / file).write_text(text, encoding="utf-8")
        return f"{folder}/: report.json, {name}, yosys.log"


def place_core(plan: Plan, *, advance: Advance = silent) -> Outcome:
    """Place and route a design's core, and check the netlist where the plan says so.

    Args:
        plan: what, and where.
        advance: told 1 after each of `plan.steps`.

    Raises:
        InputError: a tool is missing, the design is for another family or does not fit.
        ToolError: a tool fails.
    """
    design, device, speed = plan.design, plan.device, plan.speed
    placer = Placer(design, device, speed)
    advance(1)
    placed = placement.place(
        design, device, speed, range(1, plan.seeds + 1), placer=placer, done=advance
    )
    difference = None
    if plan.check:
        synthesis = placer.synthesis
        difference = netlist.check_netlist(
            design, placer.generated, synthesis.netlist, device.family
        )
        advance(1)
    return Outcome(plan, placed, placer, difference)


def describe(placement: Placement) -> dict[str, str]:
    """A placement in words, row by row."""
    area = placement.area
    rows = {"design": placement.design, "device": placement.device, "how": placement.how}
    if placement.fmax_mhz is not None:
        each = ", ".join(f"{seed.mhz:.1f}" for seed in placement.seeds)
        rows["clock rate"] = f"{placement.fmax_mhz:.1f} MHz (median of {each})"
        rows["worst path"] = placement.limited_by()
        inside = [limit.describe() for limit in placement.limits]
        rows["inside blocks"] = "; ".join(inside) or "nothing that nextpnr does not check"
    rows |= {
        "LUTs": f"{area.luts:,}",
        "flip-flops": f"{area.flip_flops:,}",
        "multipliers": f"{area.multipliers:,}",
        "block RAMs": f"{area.memories:,}",
    }
    for kind, label in _LABELS.items():
        if kind in area.usage:
            used, available = area.usage[kind]
            rows[label] = f"{used:,} of {available:,}"
    rows["latency"] = f"{placement.latency_clocks} clocks" + (
        f", {placement.latency_ns:.0f} ns" if placement.latency_ns is not None else ""
    )
    rows["throughput"] = f"{placement.clocks_per_sample:g} clocks a sample" + (
        f", {placement.samples_per_second:,.0f} samples/s"
        if placement.samples_per_second is not None
        else ""
    )
    return rows


_LABELS = {
    "TRELLIS_COMB": "LUTs with what carry chains need",
    "ICESTORM_LC": "logic cells",
    "TRELLIS_FF": "flip-flops",
    "MULT18X18D": "multipliers",
    "ICESTORM_DSP": "multipliers",
    "DP16KD": "block RAMs",
    "ICESTORM_RAM": "block RAMs",
}
