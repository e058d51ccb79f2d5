"""A design in a device: clock rate, area, worst path and what follows from them."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from statistics import median_low
from threading import Lock
from typing import Any

import sculler_sim
from sculler_hdl import Generated, generate
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim import processes
from sculler_sim.engines import cache
from sculler_sim.place import nextpnr
from sculler_sim.place.area import ROOM, Area, count
from sculler_sim.place.blocks import Limit, limits
from sculler_sim.place.devices import DEVICES, FAMILY_NAMES, Device, Family
from sculler_sim.place.floorplan import fix_blocks
from sculler_sim.place.nextpnr import Routed, Usage, WorstPath
from sculler_sim.place.synthesis import Names, Synthesis, synthesise
from sculler_sim.place.tools import NEXTPNR, YOSYS

_IN_HARNESS = "placed and routed in a shift register that stands for the pins and is not counted"

HOW: dict[Family, str] = {
    "ecp5": "placed and routed alone, out of context: no pins",
    "ice40": _IN_HARNESS,
    "nexus": f"{_IN_HARNESS}; clocked by the device's oscillator",
    "gowin": f"{_IN_HARNESS}; nextpnr has no times of the multiplier blocks",
    "gatemate": f"{_IN_HARNESS}; multipliers are made of logic cells",
    "xilinx": "estimated by synthesis alone, no clock rate",
    "intel": "estimated by synthesis alone, no clock rate",
}


@dataclass(frozen=True)
class Seed:
    """One run of place-and-route.

    Attributes:
        seed: where the placer's random numbers started.
        mhz: clock rate: of the slowest path nextpnr checks, or of a block if that is slower.
        path: the slowest path nextpnr checks.
        path_mhz: its clock rate.
    """

    seed: int
    mhz: float
    path: WorstPath
    path_mhz: float


@dataclass(frozen=True)
class Placement:
    """A design in a device.

    Attributes:
        design: its name.
        device: with its speed grade.
        area: what it takes.
        seeds: the runs, in order of their seeds; empty for an estimate.
        limits: paths inside blocks, which nextpnr does not check, the slowest first.
        latency_clocks: from an interval's last sample to its result.
        clocks_per_minor: between the ends of minor intervals in the long run.
        clocks_per_sample: between samples in the long run.
        tools: their versions.
    """

    design: str
    device: str
    area: Area
    seeds: tuple[Seed, ...]
    limits: tuple[Limit, ...]
    latency_clocks: int
    clocks_per_minor: int
    clocks_per_sample: float
    tools: dict[str, str]

    @cached_property
    def median(self) -> Seed | None:
        """The run in the middle (of an even number, the slower one); None for an estimate."""
        if not self.seeds:
            return None
        middle = median_low(seed.mhz for seed in self.seeds)
        return next(seed for seed in self.seeds if seed.mhz == middle)

    @property
    def fmax_mhz(self) -> float | None:
        """The median clock rate."""
        return self.median.mhz if self.median else None

    @property
    def samples_per_second(self) -> float | None:
        """At the median clock rate, samples always offered and results taken at once."""
        return None if self.fmax_mhz is None else self.fmax_mhz * 1e6 / self.clocks_per_sample

    @property
    def latency_ns(self) -> float | None:
        """At the median clock rate."""
        return None if self.fmax_mhz is None else self.latency_clocks * 1e3 / self.fmax_mhz

    @property
    def how(self) -> str:
        """How it was found."""
        return HOW[DEVICES[self.device.partition(" ")[0]].family]

    def limited_by(self) -> str:
        """What sets the median clock rate, in a sentence."""
        if self.median is None:
            return ""
        if self.limits and self.limits[0].mhz < self.median.path_mhz:
            return f"inside a block: {self.limits[0].describe()}"
        return self.median.path.describe()

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        return {
            **asdict(self),
            "how": self.how,
            "fmax_mhz": self.fmax_mhz,
            "latency_ns": self.latency_ns,
            "samples_per_second": self.samples_per_second,
            "limited_by": self.limited_by(),
        }


def check_target(design: Design, device: Device) -> None:
    """A design with one family's blocks goes into that family only.

    Raises:
        InputError: the design's hardware.target is another family.
    """
    target = design.hardware.target
    if target not in device.targets:
        possible = " or ".join(f'"{name}"' for name in reversed(device.targets))
        raise InputError(
            f'{design.name}: hardware.target = "{target}" has blocks that {device.name}'
            f" ({FAMILY_NAMES[device.family]}) has not, give target = {possible}, or another device"
        )


class Placer:
    """Takes one design into one device, doing each step once and only when it is needed.

    What Yosys and nextpnr found is kept in the cache folder, under a hash of the Verilog, the
    order of its blocks, the device, the seed, the tools' versions and this package's source;
    netlists are not kept.  `routed` has the runs that were asked for, by seed.
    """

    def __init__(self, design: Design, device: Device, speed: int | None) -> None:
        """Check that the tools are there and the design is for such a device.

        Raises:
            InputError: they are not, or it is not; `hardware.multipliers` are too few.
        """
        check_target(design, device)
        self.design, self.device, self.speed = design, device, speed
        tools = [YOSYS, *([NEXTPNR[device.family]] if device.routed else [])]
        self.tools = {tool.package: tool.version() for tool in tools}
        self.generated: Generated = generate(design)
        self.blocks = self.generated.manifest.block_groups or ()
        self.routed: dict[int, Routed] = {}
        self._once = Lock()
        self._synthesis: Synthesis | None = None

    @property
    def synthesis(self) -> Synthesis:
        """The core's netlist; made when first asked for."""
        with self._once:
            if self._synthesis is None:
                device = self.device
                self._synthesis = synthesise(self.generated, device.family, device.part)
            return self._synthesis

    def area(self) -> tuple[Area, tuple[Limit, ...]]:
        """The core's area, and what its blocks allow.

        Raises:
            InputError: the core does not fit.
            ToolError: a tool fails.
        """
        found = self._kept("area", self._area)
        area = Area(**found["area"] | {"usage": _as_usage(found["area"]["usage"])})
        for name, kind in ROOM.get(self.device.family, {}).items():
            used, available = area.usage.get(kind, (0, 0))
            if used > available:
                raise InputError(
                    f"{self.device.name}: {self.design.name} does not fit, {name}: {used} needed,"
                    f" {available} available; give a larger device, or a smaller core"
                    " (hardware.multipliers, hardware.core)"
                )
        return area, tuple(Limit(**limit) for limit in found["limits"])

    def _area(self) -> dict[str, Any]:
        counts = self.synthesis.counts()
        usage: Usage = {}
        if self.device.family in ROOM:
            usage = nextpnr.pack(self.device, self.speed, self.synthesis.core)
        found = limits(self.synthesis.cells().values(), self.device, self.speed)
        return {
            "area": asdict(count(self.device.family, counts, usage)),
            "limits": [asdict(limit) for limit in found],
        }

    def route(self, seed: int) -> Routed:
        """One run of place-and-route.

        Raises:
            InputError: there is no room.
            ToolError: a tool fails.
        """

        def run() -> dict[str, Any]:
            made = self.synthesis
            register = Names(made.top, made.placed).register
            netlist = made.placed
            if self.design.hardware.target == "ecp5":
                netlist = fix_blocks(netlist, made.top, self.blocks, self.device)
            return asdict(nextpnr.route(self.device, self.speed, netlist, seed, register))

        found = self._kept(f"seed {seed}", run)
        places = {name: (x, y) for name, (x, y) in found["places"].items()}
        path = WorstPath(**found["path"])
        routed = Routed(found["mhz"], path, _as_usage(found["usage"]), places)
        self.routed[seed] = routed
        return routed

    @property
    def made_of(self) -> tuple[str, ...]:
        """What the tools are given: Verilog, the order of its blocks, device; their versions."""
        tools, title = json.dumps(self.tools, sort_keys=True), self.device.title(self.speed)
        return self.generated.verilog, json.dumps(self.blocks), title, tools

    def _kept(self, what: str, find: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """A finding from the cache, or newly found."""
        source = [path.read_bytes() for path in sorted(_PACKAGE.glob("*.py"))]
        path = cache.entry(f"place-{self.design.name}", ".json", *self.made_of, what, *source)
        data = cache.kept(path)
        if data is None:
            data = find()
            cache.keep(path, data)
        return data


_PACKAGE = Path(next(iter(sculler_sim.__path__))) / "place"


def place(
    design: Design,
    device: Device,
    speed: int | None = None,
    seeds: Sequence[int] = (1, 2, 3),
    *,
    placer: Placer | None = None,
    done: Callable[[int], None] = lambda _: None,
    stage: Callable[[str], None] = lambda _: None,
) -> Placement:
    """Place and route a design with several seeds, as many at a time as there are processors.

    Args:
        design: the design.
        device, speed: where; as `find_device` gives them.
        seeds: the placer's seeds.
        placer: what does the steps, if it is to be kept for its netlist.
        done: told 1 after each step: synthesis with packing, and each seed.
        stage: told in words what is being done.

    Raises:
        InputError: a tool is missing, the design is for another family or does not fit.
        ToolError: a tool fails.
    """
    placer = placer or Placer(design, device, speed)
    stage("synthesis and packing")
    area, slow = placer.area()
    done(1)
    routed: dict[int, Routed] = {}
    if device.routed:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            jobs = {pool.submit(placer.route, seed): seed for seed in seeds}
            stage(f"place and route, {len(jobs)} seeds")
            try:
                for job in as_completed(jobs):
                    routed[jobs[job]] = job.result()
                    stage(f"place and route, {len(routed)} of {len(jobs)} seeds done")
                    done(1)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                while any(job.running() for job in jobs):
                    processes.end_all()
                    time.sleep(0.05)
                raise
    ceiling = min((limit.mhz for limit in slow), default=float("inf"))
    manifest = placer.generated.manifest
    return Placement(
        design=design.name,
        device=device.title(speed),
        area=area,
        seeds=tuple(
            Seed(seed, min(routed[seed].mhz, ceiling), routed[seed].path, routed[seed].mhz)
            for seed in seeds
            if seed in routed
        ),
        limits=slow,
        latency_clocks=manifest.latency_clocks,
        clocks_per_minor=manifest.clocks_per_minor,
        clocks_per_sample=manifest.clocks_per_major / design.samples_per_major,
        tools=placer.tools,
    )


def _as_usage(data: dict[str, list[int]]) -> Usage:
    return {kind: (used, available) for kind, (used, available) in data.items()}
