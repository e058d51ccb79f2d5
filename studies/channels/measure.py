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


@dataclass(frozen=True)
class Measured:
    """A core with channels in a device.

    Attributes:
        unit: of `UNITS`.
        channels: C.
        placement: what was found.
    """

    unit: str
    channels: int
    placement: Placement

    @property
    def each_hz(self) -> float:
        """Samples a second of each channel, all channels alike."""
        rate = self.placement.samples_per_second
        return 0.0 if rate is None else rate / self.channels


def design_of(unit: str, channels: int) -> Design:
    """The compact core of so many units of a kind: four samples, five minor intervals."""
    sensor, _, _ = UNITS[unit]
    short = unit.partition(" ")[0].lower()
    return Design.parse(
        {
            "name": f"{short}_{channels}",
            "preset": "stim300",
            "sensor": sensor,
            "algorithm": {"samples": 4, "minors": 5},
            "hardware": {"core": "compact", "target": "ecp5", "channels": channels},
        }
    )


def device_of(unit: str, channels: int) -> str:
    """The small one, where the memories have room in it."""
    sensor, _, _ = UNITS[unit]
    words = 64 if "gyro" in sensor else 128
    blocks = channels * (128 + words) / 1024
    return SMALL if blocks < 50 else LARGE


def measure(unit: str, channels: int, advance: Advance = silent) -> Measured:
    """Synthesise, place and route.

    Raises:
        InputError: Yosys or nextpnr is not installed.
        ToolError: one of them failed.
    """
    device, speed = find_device(device_of(unit, channels), None)
    return Measured(
        unit, channels, place(design_of(unit, channels), device, speed, SEEDS, done=advance)
    )
