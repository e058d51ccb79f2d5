"""Design files with a sensor so fine that its LSB does not show in what is navigated."""

from __future__ import annotations

from pathlib import Path

_DESIGN = """
name = "fine"
[sensor]
kind = "{kind}"
sample_rate_hz = {rate}
gyro = {{ bits = 32, lsb = {gyro} }}
accel = {{ bits = 32, lsb = {accel} }}
[algorithm]
family = "{family}"
samples = {samples}
minors = {minors}
[hardware]
core = "{core}"
"""


def fine_design_file(
    folder: Path,
    samples: int,
    minors: int,
    rate: float = 1000.0,
    kind: str = "increment",
    core: str = "pipelined",
) -> Path:
    """A design without history, its file named after the arguments.

    Args:
        folder: where to write.
        samples: a minor interval.
        minors: minor intervals a major interval.
        rate: samples a second.
        kind: of the sensor, `increment` (frequency-taylor) or `rate` (filtered-rate).
        core: of the hardware.
    """
    increments = kind == "increment"
    path = folder / f"{kind}_{samples}_{minors}_{rate:g}_{core}.toml"
    path.write_text(
        _DESIGN.format(
            kind=kind,
            rate=rate,
            samples=samples,
            minors=minors,
            core=core,
            family="frequency-taylor" if increments else "filtered-rate",
            gyro=1e-11 if increments else 1e-8,
            accel=1e-9 if increments else 1e-6,
        )
    )
    return path
