"""The devices a core can be placed in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from sculler_model.errors import InputError

Family = Literal["ecp5", "ice40", "xilinx"]

FAMILY_NAMES: dict[Family, str] = {
    "ecp5": "Lattice ECP5",
    "ice40": "Lattice iCE40",
    "xilinx": "Xilinx 7 series",
}


@dataclass(frozen=True)
class Device:
    """One device, or a family of which only the area is estimated.

    Attributes:
        name: as its maker writes it.
        family: whose cells it has; the design file's hardware.target.
        options: what tells nextpnr the device and package.
        speeds: speed grades, the slowest first; empty if there is only one.
        goal: clock rate (MHz) asked of nextpnr: out of reach, so that it does its best.
        fewer: cells of the maker's data sheet, by nextpnr's name, where nextpnr allows more.
    """

    name: str
    family: Family
    options: tuple[str, ...] = ()
    speeds: tuple[int, ...] = ()
    goal: int = 0
    fewer: Mapping[str, int] = field(default_factory=dict)

    @property
    def routed(self) -> bool:
        """Whether it is placed and routed; if not, the area is an estimate."""
        return bool(self.options)

    def title(self, speed: int | None) -> str:
        """The name with its speed grade."""
        return self.name if speed is None else f"{self.name} -{speed}"


def _ecp5(size: int, **fewer: int) -> Device:
    options = (f"--{size}k", "--package", "CABGA381")
    return Device(f"LFE5U-{size}F", "ecp5", options, (6, 7, 8), goal=290, fewer=fewer)


_ALL = [
    # the 12F is sold with half of the 25F's cells, though it has them all
    _ecp5(12, TRELLIS_COMB=12_000, TRELLIS_FF=12_000, DP16KD=32),
    *map(_ecp5, (25, 45, 85)),
    Device("iCE40UP5K", "ice40", ("--up5k", "--package", "sg48"), goal=100),
    Device("iCE40HX8K", "ice40", ("--hx8k", "--package", "ct256"), goal=300),
    Device("xc7", "xilinx"),
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
