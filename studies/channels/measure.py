"""Places and routes cores with many channels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sculler.words import Advance, silent
from sculler_model.design import Design
from sculler_sim.place.devices import find_device
from sculler_sim.place.placement import Placement, place

SEEDS = (1,)
CHANNELS = (1, 4, 16, 64, 256, 1024)

UNITS: dict[str, tuple[dict[str, Any], float, tuple[int, ...]]] = {
    "MEMS unit, 16 bits": (
        {
            "gyro": {"bits": 16, "lsb": 1e-6},
            "accel": {"bits": 16, "lsb": 1e-5},
            "sample_rate_hz": 2000.0,
        },
        2000.0,
        CHANNELS,
    ),
    "navigation grade, 24 bits": ({"sample_rate_hz": 20000.0}, 20000.0, CHANNELS[:5]),
}
"""[sensor] besides the preset stim300, the unit's rate in Hz, and how many of them."""

SMALL, LARGE = "LFE5U-25F", "LFE5U-85F"

CORES = ("compact", "pipelined")

_BLOCKS = {SMALL: 28, LARGE: 156}
"""Multiplier blocks."""


@dataclass(frozen=True)
class Measured:
    """A core with channels in a device.

    Attributes:
        unit: of `UNITS`.
        channels: C.
        core: of `CORES`.
        placement: what was found.
    """

    unit: str
    channels: int
    core: str
    placement: Placement

    @property
    def each_hz(self) -> float:
        """Samples a second of each channel, all channels alike."""
        rate = self.placement.samples_per_second
        return 0.0 if rate is None else rate / self.channels


def design_of(unit: str, channels: int, core: str = "compact") -> Design:
    """A core of so many units of a kind: four samples, five minor intervals.

    The pipelined one may have the multiplier blocks of the device that it is to go into.
    """
    sensor, _, _ = UNITS[unit]
    short, fast = unit.partition(" ")[0].lower(), core == "pipelined"
    return Design.parse(
        {
            "name": f"{short}_{channels}",
            "preset": "stim300",
            "sensor": sensor,
            "algorithm": {"samples": 4, "minors": 5},
            "hardware": {
                "core": core,
                "target": "ecp5",
                "channels": channels,
                **({"multipliers": _BLOCKS[device_of(unit, channels, core)]} if fast else {}),
            },
        }
    )


def device_of(unit: str, channels: int, core: str = "compact") -> str:
    """The small one, where the memories and multiplier blocks have room in it."""
    sensor, _, _ = UNITS[unit]
    if core == "pipelined":
        return SMALL if "gyro" in sensor and channels <= 256 else LARGE
    words = 64 if "gyro" in sensor else 128
    blocks = channels * (128 + words) / 1024
    return SMALL if blocks < 50 else LARGE


def measure(unit: str, channels: int, core: str = "compact", advance: Advance = silent) -> Measured:
    """Synthesise, place and route.

    Raises:
        InputError: Yosys or nextpnr is not installed.
        ToolError: one of them failed.
    """
    device, speed = find_device(device_of(unit, channels, core), None)
    design = design_of(unit, channels, core)
    return Measured(unit, channels, core, place(design, device, speed, SEEDS, done=advance))
