"""The six cores whose state is turned over, bit by bit, and the designs that are placed."""

from __future__ import annotations

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


def placed(target: str, mode: str) -> Design:
    """The preset stim300 in the compact core of a target."""
    hardware = {"core": "compact", "target": target, "hardening": mode}
    return Design.parse({"preset": "stim300", "name": "stim300", "hardware": hardware})
