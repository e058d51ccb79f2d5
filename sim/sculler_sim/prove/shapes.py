"""Small designs that between them have every structure of both cores."""

from __future__ import annotations

from typing import Any

from sculler_model.design import Design


def _shape(
    name: str,
    samples: int = 1,
    history: int = 1,
    minors: int = 2,
    algorithm: dict[str, Any] | None = None,
    kind: str = "increment",
    **hardware: Any,
) -> Design:
    return Design.parse(
        {
            "name": name,
            "sensor": {
                "kind": kind,
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": 8, "lsb": 1e-8},
                "accel": {"bits": 8, "lsb": 1e-7},
            },
            "algorithm": {
                "family": "frequency-taylor",
                "samples": samples,
                "history": history,
                "minors": minors,
                **(algorithm or {}),
            },
            "hardware": hardware,
        }
    )


_DENSE = {"family": "table", "table": {"denominator": 7, "taps": [[0, -3], [1, 0, -2]]}}
_POSITION = {"position": "high-resolution"}

_ALL = [
    _shape("parallel_results"),
    _shape("one_minor", minors=1),
    _shape("compressed_table", samples=2, history=0),
    _shape("dense_table", samples=2, algorithm=_DENSE),
    _shape(
        "rate_samples", samples=2, history=0, kind="rate", algorithm={"family": "filtered-rate"}
    ),
    _shape("streaming", handover="stream"),
    _shape("shared_units", multipliers=12),
    _shape("two_results", minors=4, target="ecp5"),
    _shape("blocks_ice40", target="ice40"),
    _shape("blocks_xilinx", target="xilinx"),
    _shape("high_resolution", algorithm=_POSITION),
    _shape("dropping_results", overrun="drop-result"),
    _shape("dropping_stream", overrun="drop-result", handover="stream"),
    _shape("compact_plain", core="compact"),
    _shape("compact_one", minors=1, core="compact"),
    _shape("compact_serial", core="compact", multipliers=0),
    _shape("compact_ecp5", core="compact", target="ecp5"),
    _shape("compact_ice40", core="compact", target="ice40"),
    _shape("compact_high_resolution", core="compact", algorithm=_POSITION),
    _shape("compact_dropping", core="compact", overrun="drop-result"),
]

SHAPES: dict[str, Design] = {design.name: design for design in _ALL}
"""By name, counts of 8 bits."""
