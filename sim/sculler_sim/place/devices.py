"""The devices a core can be placed in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from sculler_model.errors import InputError

Family = Literal["ecp5", "ice40", "nexus", "gowin", "gatemate", "xilinx", "intel"]

FAMILY_NAMES: dict[Family, str] = {
    "ecp5": "Lattice ECP5",
    "ice40": "Lattice iCE40",
    "nexus": "Lattice Nexus",
    "gowin": "Gowin",
    "gatemate": "Cologne Chip GateMate",
    "xilinx": "Xilinx",
    "intel": "Intel",
}

_TARGETS = frozenset({"ecp5", "ice40", "nexus", "gowin", "xilinx"})
"""Families that the design file's hardware.target names; others take a generic core."""


@dataclass(frozen=True)
class Device:
    """One device, or a family of which only the area is estimated.

    Attributes:
        name: as its maker writes it.
        family: whose cells it has.
        options: what tells nextpnr the device and package; {speed} stands for the speed grade.
        part: what tells Yosys of which part of the family it is.
        pins: of the harness' ports, where nextpnr finds no pins itself.
        speeds: speed grades, the slowest first; empty if there is only one.
        goal: clock rate (MHz) asked of nextpnr: out of reach, so that it does its best.
        fewer: cells of the maker's data sheet, by nextpnr's name, where nextpnr allows more.
    """

    name: str
    family: Family
    options: tuple[str, ...] = ()
    part: str = ""
    pins: Mapping[str, str] = field(default_factory=dict)
    speeds: tuple[int, ...] = ()
    goal: int = 0
    fewer: Mapping[str, int] = field(default_factory=dict)

    @property
    def targets(self) -> tuple[str, ...]:
        """The design file's hardware.target of what can be placed in it."""
        return ("generic", self.family) if self.family in _TARGETS else ("generic",)

    @property
    def routed(self) -> bool:
        """Whether it is placed and routed; if not, the area is an estimate."""
        return bool(self.options)

    def title(self, speed: int | None) -> str:
        """The name with its speed grade."""
        return self.name if speed is None else f"{self.name} -{speed}"


def _ecp5(size: int, **fewer: int) -> Device:
    options = (f"--{size}k", "--package", "CABGA381", "--speed", "{speed}")
    return Device(f"LFE5U-{size}F", "ecp5", options, speeds=(6, 7, 8), goal=290, fewer=fewer)


def _nexus(name: str, package: str, scan_in: str, scan_out: str) -> Device:
    options = ("--device", f"{name}-{{speed}}{package}")
    pins = {"scan_in": scan_in, "scan_out": scan_out}
    return Device(name, "nexus", options, speeds=(7, 8, 9), goal=240, pins=pins)


def _gowin(name: str, part: str, device: str, family: str, *pins: str) -> Device:
    options = ("--device", device, "--vopt", f"family={family}")
    ports = dict(zip(("clk", "scan_in", "scan_out"), pins, strict=True))
    return Device(name, "gowin", options, goal=300, part=part, pins=ports)


_ALL = [
    # the 12F is sold with half of the 25F's cells, though it has them all
    _ecp5(12, TRELLIS_COMB=12_000, TRELLIS_FF=12_000, DP16KD=32),
    *map(_ecp5, (25, 45, 85)),
    Device("iCE40UP5K", "ice40", ("--up5k", "--package", "sg48"), goal=100),
    Device("iCE40HX8K", "ice40", ("--hx8k", "--package", "ct256"), goal=300),
    _nexus("LIFCL-40", "BG400C", "E17", "F13"),
    _gowin("GW2A-18", "gw2a", "GW2A-LV18PG256C8/I7", "GW2A-18", "H11", "T10", "L14"),
    _gowin("GW1NR-9", "gw1n", "GW1NR-LV9QN88PC6/I5", "GW1N-9C", "52", "3", "10"),
    Device(
        "CCGM1A1", "gatemate", ("--device", "CCGM1A1", "--vopt", "allow-unconstrained"), goal=200
    ),
    Device("xc7", "xilinx", part="xc7"),
    Device("xcup", "xilinx", part="xcup"),
    Device("cyclonev", "intel"),
]

DEVICES = {device.name: device for device in _ALL}


def find_device(name: str, speed: int | None = None) -> tuple[Device, int | None]:
    """A device by its name, in whatever case and with or without iCE40, and its speed grade.

    Args:
        name: the name.
        speed: speed grade; the slowest if left out.

    Raises:
        InputError: no such device or speed grade.
    """
    wanted = name.casefold()
    found = [d for d in _ALL if d.name.casefold() in (wanted, f"ice40{wanted}")]
    if not found:
        raise InputError(f"{name}: no such device, give one of {', '.join(DEVICES)}")
    (device,) = found
    if not device.speeds:
        if speed is not None:
            raise InputError(f"{device.name} has no speed grades here, leave out --speed {speed}")
        return device, None
    if speed is not None and speed not in device.speeds:
        grades = ", ".join(map(str, device.speeds))
        raise InputError(f"{device.name}: no speed grade {speed}, give one of {grades}")
    return device, speed or device.speeds[0]
