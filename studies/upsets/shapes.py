"""The six cores whose state is turned over, bit by bit, and the designs that are placed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sculler_model.design import Design

MODES = ("off", "detect", "recover")
"""Of `hardware.hardening`."""


def _design(name: str, bits: int, algorithm: dict[str, Any], **hardware: Any) -> Design:
    return Design.parse(
        {
            "name": name,
            "sensor": {
                "kind": "increment",
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": bits, "lsb": 1e-8},
                "accel": {"bits": bits, "lsb": 1e-7},
            },
            "algorithm": {"family": "frequency-taylor", **algorithm},
            "hardware": {"core": "compact"} | hardware,
        }
    )


def _one(samples: int, history: int, minors: int) -> dict[str, Any]:
    return {"samples": samples, "history": history, "minors": minors}


_DENSE = {
    "family": "table",
    **_one(3, 0, 2),
    "table": {
        "denominator": 7,
        "taps": [[0, -3, 0, 0, 0, 0, 5], [], [1, 0, -2]],
        "sum_denominator": 6,
        "weights": [1, 0, -4, 5],
    },
}


def shapes(mode: str) -> dict[str, Design]:
    """The cores by what they are, hardened as told.

    Between them: both cores, four targets, with and without a vendor's blocks and a multiplier, one
    digit and two, history, a dense table, high-resolution position, results that are dropped.

    Args:
        mode: one of `MODES`.
    """
    position = {**_one(1, 1, 2), "position": "high-resolution"}
    made = {
        "8 bits, history, `generic`": _design("upset_1p1", 8, _one(1, 1, 2)),
        "24 bits, history, `ecp5`": _design("upset_2p1", 24, _one(2, 1, 2), target="ecp5"),
        "11 bits, dense table, `ice40`": _design("upset_dense", 11, _DENSE, target="ice40"),
        "8 bits, history, pipelined, `generic`": _design(
            "upset_pipelined", 8, _one(1, 1, 2), core="pipelined"
        ),
        "8 bits, no multiplier, `generic`": _design(
            "upset_serial", 8, _one(1, 1, 2), multipliers=0
        ),
        "9 bits, position, drops results, `xilinx`": _design(
            "upset_position", 9, position, target="xilinx", overrun="drop-result"
        ),
    }
    return {what: hardened(design, mode) for what, design in made.items()}


def hardened(design: Design, mode: str) -> Design:
    """The design with another `hardware.hardening`."""
    data = design.as_json()
    data["hardware"] = {**data["hardware"], "hardening": mode}
    return Design.parse(data)


@dataclass(frozen=True)
class Place:
    """A plain core and a device that it is placed in, plain and hardened.

    Attributes:
        what: the core in words.
        device, speed: as `find_device` takes them.
        design: not hardened.
        fits: the modes in which it fits into the device.
    """

    what: str
    device: str
    speed: int | None
    design: Design
    fits: tuple[str, ...] = MODES


def places() -> tuple[Place, ...]:
    """What is placed."""
    ecp5, ice40 = (
        Design.parse(
            {
                "preset": "stim300",
                "name": "stim300",
                "hardware": {"core": "compact", "target": target},
            }
        )
        for target in ("ecp5", "ice40")
    )
    pipelined = _design("upset_18", 18, _one(4, 0, 5), core="pipelined", target="ecp5")
    compact = "compact, preset `stim300`"
    return (
        Place(compact, "LFE5U-25F", 6, ecp5),
        Place(compact, "iCE40UP5K", None, ice40, MODES[:2]),  # three have 36 block memories of 30
        Place("pipelined, 18 bits, n = 4", "LFE5U-45F", 6, pipelined),
    )
