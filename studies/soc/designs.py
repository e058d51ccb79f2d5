"""Designs of chips to simulate: the usual one, and slow ones.

At 1.8432 MHz, with a sensor of 125 samples a second, a second of flight has a twentieth of the
clocks that it has at 40 MHz; an alignment of ten seconds is then a matter of half a minute.
"""

from __future__ import annotations

from typing import Any

from sculler_model.design import Design

SLOW_HZ = 16 * 115200.0
_SLOW_RATE_HZ = 125.0
_NEEDED: dict[str, Any] = {"core": "compact", "bus": {"result": "wishbone"}}


def usual_design(target: str = "ecp5") -> Design:
    """The preset `stim300`, at 40 MHz."""
    front = {"sensor": "stim300", "clock_hz": 40e6}
    hardware = {**_NEEDED, "target": target, "front": front}
    return Design.parse({"preset": "stim300", "name": "chip", "hardware": hardware})


DESIGN = usual_design()


def slow_design(name: str, algorithm: dict[str, Any], **hardware: Any) -> Design:
    """A STIM300 of 125 Hz at 115,200 baud.

    Args:
        name: of the design.
        algorithm: keys of [algorithm].
        hardware: more keys of [hardware].
    """
    front = {"sensor": "stim300", "clock_hz": SLOW_HZ, "baud": 115200.0}
    return Design.parse(
        {
            "preset": "stim300",
            "name": name,
            "sensor": {"sample_rate_hz": _SLOW_RATE_HZ},
            "algorithm": algorithm,
            "hardware": {**_NEEDED, "front": front, **hardware},
        }
    )


def spi_design(sensor: str) -> Design:
    """An ADIS part of 125 Hz."""
    return Design.parse(
        {
            "name": f"slow_{sensor}",
            "sensor": {
                "kind": "increment",
                "sample_rate_hz": _SLOW_RATE_HZ,
                "gyro": {"bits": 32, "lsb": 1e-8},
                "accel": {"bits": 32, "lsb": 1e-7},
            },
            "algorithm": {"family": "frequency-taylor", "samples": 4, "minors": 5},
            "hardware": {
                **_NEEDED,
                "front": {"sensor": sensor, "clock_hz": SLOW_HZ, "sck_hz": SLOW_HZ / 4},
            },
        }
    )


SLOW = slow_design("slow", {})
ORDER_FOUR = slow_design("slow_order", {"order": 4, "minors": 16})
TOO_SLOW = slow_design("late", {"minors": 1}, overrun="drop-result")
"""Its update takes longer than its interval."""
