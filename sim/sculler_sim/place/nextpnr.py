"""Packing, placing and routing by nextpnr, and what its report says."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

from sculler_model.errors import InputError
from sculler_sim.engines import cache
from sculler_sim.place.devices import Device
from sculler_sim.place.tools import NEXTPNR, ToolError

Usage = dict[str, tuple[int, int]]
"""Used and available, by nextpnr's name of the kind of cell."""

_CARRY_OUTPUTS = ("FCO", "COUT", "COUTX", "COUTY1", "COUTY2")
_LUT_OUTPUTS = ("F", "OFX", "O", "LO", "OUT", "SUM")
_NO_ROOM = re.compile(
    r"ERROR: .*?(?:no B[Ee][Ll]s remaining to implement cell type '(?P<kind>\w+)'"
    r"|(?P<route>Routing design failed|[Ff]ailed to route).*)"
)


@dataclass(frozen=True)
class WorstPath:
    """The slowest path between two registers.

    Attributes:
        start, end: the registers, in the words of the design.
        luts, carries, blocks: look-up tables, steps of carry chains and other blocks on the way.
        logic_ns, routing_ns: what they and the wires between them take, registers included.
    """

    start: str
    end: str
    luts: int
    carries: int
    blocks: int
    logic_ns: float
    routing_ns: float

    @property
    def total_ns(self) -> float:
        """The whole path."""
        return self.logic_ns + self.routing_ns

    def describe(self) -> str:
        """In a sentence."""
        kinds = ((self.luts, "LUT"), (self.carries, "carry step"), (self.blocks, "block"))
        through = " and ".join(f"{n} {kind}{'s' * (n > 1)}" for n, kind in kinds if n)
        return (
            f"from {self.start} through {through or 'wires only'} to {self.end},"
            f" {self.total_ns:.2f} ns = {self.logic_ns:.2f} logic + {self.routing_ns:.2f} routing"
        )

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


@dataclass(frozen=True)
class Routed:
    """One run of nextpnr.

    Attributes:
        mhz: clock rate of the slowest path it checks.
        path: that path.
        usage: everything placed, a harness included.
        places: column and row of each cell of the netlist, in the words of the design.
    """

    mhz: float
    path: WorstPath
    usage: Usage
    places: dict[str, tuple[int, int]]


def pack(device: Device, speed: int | None, netlist: str) -> Usage:
    """The core's own area: packed into the device's cells, not placed.

    Raises:
        InputError: nextpnr is not installed.
        ToolError: it fails.
    """
    report, _ = _run(device, speed, netlist, "--pack-only", *_alone(device))
    return {
        kind: (used, min(available, device.fewer.get(kind, available)))
        for kind, (used, available) in _usage(report).items()
    }


_HARD = ("--placer-heap-critexp", "4", "--placer-heap-timingweight", "30")
"""Tells the placer to care less for short wires and more for the slowest paths."""


def _alone(device: Device) -> tuple[str, ...]:
    """What lets a core alone have more ports than the device has pins; no other family has it."""
    return ("--out-of-context",) if device.family == "ecp5" else ()


def route(
    device: Device, speed: int | None, netlist: str, seed: int, register: Callable[[str], str]
) -> Routed:
    """Place and route the core, alone (ECP5) or in its harness.

    Args:
        device, speed: where.
        netlist: `Synthesis.placed`.
        seed: where the placer's random numbers start.
        register: gives a cell's register in the words of the design (`Names.register`).

    Raises:
        InputError: nextpnr is not installed, or it finds no room for the design.
        ToolError: it fails.
    """
    options = ("--freq", str(device.goal), "--seed", str(seed), "--timing-allow-fail")
    places: dict[str, tuple[int, int]] = {}
    report, log = _run(
        device, speed, netlist, *options, *_alone(device), *_HARD, register=register, places=places
    )
    try:
        ((_, clock),) = report["fmax"].items()
    except ValueError as error:
        raise ToolError(NEXTPNR[device.family], log) from error
    return Routed(clock["achieved"], worst_path(report, register), _usage(report), places)


def _run(
    device: Device,
    speed: int | None,
    netlist: str,
    *options: str,
    register: Callable[[str], str] | None = None,
    places: dict[str, tuple[int, int]] | None = None,
) -> tuple[dict[str, Any], str]:
    """Run nextpnr; its report and what it said.  `places` is filled if given."""
    tool = NEXTPNR[device.family]
    where = [option.format(speed=speed) for option in device.options]
    files = ["--json", "netlist.json", "--report", "report.json"]
    if places is not None:
        files += ["--write", "placed.json"]
    with cache.workshop() as work:
        (work / "netlist.json").write_text(netlist, encoding="utf-8")
        if device.pins:
            (work / "pins").write_text(_pins(device), encoding="utf-8")
            files += ["--pdc", "pins"] if device.family == "nexus" else ["--vopt", "cst=pins"]
        status, log = tool.run(work, *where, *files, *options)
        if status:
            _complain_if_full(device, log)
            raise ToolError(tool, log)
        report = json.loads((work / "report.json").read_text(encoding="utf-8"))
        if places is not None and register is not None:
            placed = json.loads((work / "placed.json").read_text(encoding="utf-8"))
            places.update(_places(placed, register))
    return report, log


_SITE = re.compile(r"X(\d+)/?Y(\d+)")


def _places(
    netlist: Mapping[str, Any], register: Callable[[str], str]
) -> dict[str, tuple[int, int]]:
    """Column and row of the cells of a netlist that nextpnr wrote, by their names in the design."""
    found = {}
    for module in netlist["modules"].values():
        for name, cell in module["cells"].items():
            site = _SITE.match(str(cell["attributes"].get("NEXTPNR_BEL", "")))
            if site is not None:
                found[register(name)] = (int(site[1]), int(site[2]))
    return found


def _pins(device: Device) -> str:
    """Pins of the harness' ports in the words of the family's tool."""
    line = {
        "nexus": "ldc_set_location -site {{{pin}}} [get_ports {{{port}}}]\n",
        "gowin": 'IO_LOC "{port}" {pin};\n',
    }[device.family]
    return "".join(line.format(port=port, pin=pin) for port, pin in device.pins.items())


def _complain_if_full(device: Device, log: str) -> None:
    found = _NO_ROOM.search(log)
    if found is None:
        return
    if found["kind"] is None:
        raise InputError(
            f"{device.name}: nextpnr finds no way to route the design, give a larger device"
        )
    kind = found["kind"]
    line = re.search(rf"{kind}: +(\d+)/ *(\d+)", log)
    needed = f", {line[1]} needed, {line[2]} available" if line else ""
    raise InputError(
        f"{device.name}: the design and the registers around it do not fit: too many"
        f" {kind}{needed}, give a larger device"
    )


def _usage(report: Mapping[str, Any]) -> Usage:
    return {
        kind: (count["used"], count["available"]) for kind, count in report["utilization"].items()
    }


def worst_path(report: Mapping[str, Any], register: Callable[[str], str]) -> WorstPath:
    """The slowest path between registers in a report of nextpnr's (--report).

    Raises:
        KeyError, ValueError: the report is not what we know.
    """
    inside = [
        path["path"]
        for path in report["critical_paths"]
        if path["from"] == path["to"] and not path["from"].startswith("<async>")
    ]
    steps = max(inside, key=lambda steps: sum(step["delay"] for step in steps))
    luts = carries = blocks = 0
    for step in steps:
        if step["type"] != "logic":
            continue
        port = step["to"]["port"]
        if port in _CARRY_OUTPUTS:
            carries += 1
        elif port in _LUT_OUTPUTS:
            luts += 1
        else:
            blocks += 1
    routing = sum(step["delay"] for step in steps if step["type"] == "routing")
    return WorstPath(
        register(steps[0]["from"]["cell"]),
        register(steps[-1]["to"]["cell"]),
        luts,
        carries,
        blocks,
        sum(step["delay"] for step in steps) - routing,
        routing,
    )
