"""A core placed and routed in a real device: from a plan to figures and an `Outcome`."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from sculler.plots.floorplan import floor_picture
from sculler.plots.pictures import left_out
from sculler.words import Advance, silent
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.outputs import gathering
from sculler_sim import processes
from sculler_sim.package.constraints import constraints
from sculler_sim.package.contents import contents
from sculler_sim.place import netlist, placement
from sculler_sim.place.devices import Device, find_device
from sculler_sim.place.parts import floor_parts, in_words, what_helps
from sculler_sim.place.placement import Placement, Placer
from sculler_sim.place.tools import ToolError

SAME = "identical to the golden model"


@dataclass(frozen=True)
class Plan:
    """What to place, and where.

    Attributes:
        design: the design.
        device_name: of the device, as `find_device` takes it.
        speed_grade: of an ECP5, 6 to 8, of a LIFCL-40, 7 to 9; None for the slowest.
        seeds: how many times to place and route; the median counts.
        time_limit_s: seconds after which it gives up; None for none.
        check: simulate the netlist that is placed against the golden model.

    Raises:
        InputError: there is no such device or speed grade, or no model of its cells to check with.
    """

    design: Design
    device_name: str
    speed_grade: int | None = None
    seeds: int = 3
    check: bool = False
    time_limit_s: float | None = None

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
        if self.placement.median is not None:
            path, plan = self.placement.median.path, self.plan
            rows["would help"] = "; ".join(what_helps(path, plan.design, plan.device, plan.speed))
        return rows if self.netlist is None else rows | {"netlist": self.netlist}

    def write(self, folder: Path) -> str:
        """Write report, netlist, log, constraints and the floor plan into a folder, together.

        The floor plan is left out where nothing is placed or matplotlib is missing.

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
        median = self.placement.median
        picture = median is not None and left_out() is None
        if median is not None:
            texts |= constraints(contents(self.placer.generated, round(median.mhz, 3)))
        with gathering(folder) as gathered:
            for file, text in texts.items():
                (gathered / file).write_text(text, encoding="utf-8")
            if median is not None and picture:
                places = self.placer.routed[median.seed].places
                title = f"{self.placement.design} in {self.placement.device}, {median.mhz:.1f} MHz"
                floor_picture(gathered / "floorplan.png", floor_parts(places), title)
        files = [*texts, *(["floorplan.png"] if picture else [])]
        return f"{folder}/: {', '.join(files)}"


def place_core(
    plan: Plan, *, advance: Advance = silent, tell: Callable[[str], None] = lambda _: None
) -> Outcome:
    """Place and route a design's core, and check the netlist where the plan says so.

    Args:
        plan: what, and where.
        advance: told 1 after each of `plan.steps`.
        tell: told in words which stage is under way.

    Raises:
        InputError: a tool is missing, the design is for another family or does not fit; the time
            limit is over.
        ToolError: a tool fails.
    """
    if plan.check and plan.design.channels > 1:
        raise InputError("--check: not built for a core with channels, leave it out")
    stage = _Stage(tell)
    with _limited(plan.time_limit_s, stage):
        return _place_core(plan, advance, stage)


class _Stage:
    """What is under way, for the progress bar and for the message when time is over."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.now, self._tell = "starting", tell

    def __call__(self, stage: str) -> None:
        self.now = stage
        self._tell(stage)


@contextmanager
def _limited(seconds: float | None, stage: _Stage) -> Iterator[None]:
    """Within it tools are killed when the time is over.

    Raises:
        InputError: it was.
    """
    if seconds is None:
        yield
        return
    over = threading.Event()

    def end() -> None:
        over.set()
        while not finished.wait(0.1):  # those too that start meanwhile
            processes.end_all()

    finished = threading.Event()
    timer = threading.Timer(seconds, end)
    timer.daemon = True
    timer.start()
    try:
        yield
    except (ToolError, RuntimeError):
        if not over.is_set():
            raise
        raise InputError(
            f"--time-limit {seconds:g}: not done by then ({stage.now}); what is done is kept: run"
            " it again to go on, give more time, fewer --seeds or a smaller design"
        ) from None
    finally:
        finished.set()
        timer.cancel()


def _place_core(plan: Plan, advance: Advance, stage: _Stage) -> Outcome:
    """As `place_core`."""
    design, device, speed = plan.design, plan.device, plan.speed
    placer = Placer(design, device, speed)
    advance(1)
    placed = placement.place(
        design, device, speed, range(1, plan.seeds + 1), placer=placer, done=advance, stage=stage
    )
    difference = None
    if plan.check:
        stage("simulating the netlist")
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
        path = placement.median.path if placement.median else None
        if path is not None:
            rows["that is"] = in_words(path)
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
