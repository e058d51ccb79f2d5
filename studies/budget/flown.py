"""The campaign: one flight of an hour, sensors of a grade, their errors together and one by one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sculler.runs.campaign import Campaign, Outcome, run_campaign
from sculler.words import Advance, silent
from sculler_model.analysis.requirement import Grade
from sculler_model.outputs import make_folder, replacing

RUNS = 16
ALL, ALGORITHM = "all of them", "the algorithm alone"

DESIGN = """\
name = "ins"
[sensor]
kind = "increment"
sample_rate_hz = 100.0
gyro  = { bits = 32, lsb = 1e-10 }   # rad, 20 microarcseconds
accel = { bits = 32, lsb = 1e-8 }    # m/s
[algorithm]
family  = "frequency-taylor"
samples = 2
minors  = 1
"""

HEAD = """\
runs = {runs}
seconds = {seconds}
checkpoints = 60
[motion]
name = "flight"                    # climbs, turns, two full circles
[navigator]
height_damping = 100.0
height = "true"                    # as a perfect barometer tells it
[rtl]                              # this run goes through the hardware too
runs = 1
seconds = 20.0
"""

ONE = """\
[[design]]
file = "ins.toml"
label = "{label}"
errors = {{ {errors} }}
"""


def sources(grade: Grade) -> dict[str, dict[str, dict[str, float]]]:
    """Errors of a grade in the units of [sensor.errors], by the names of `Budget.parts`."""
    milli_g, milli_rad = 1e-3 * grade.accel_bias, 1e-3 * grade.misalignment
    return {
        "gyro bias": {"gyro": {"bias": grade.gyro_bias}},
        "gyro scale factor": {"gyro": {"scale_factor": grade.scale_factor}},
        "accelerometer": {"accel": {"bias": milli_g}},
        "misalignment": {"gyro": {"misalignment": milli_rad}},
    }


def label(nmi_per_hour: float, source: str) -> str:
    """Of a design of the campaign."""
    return f"{nmi_per_hour:g} nmi/h: {source}"


def campaign_text(runs: int, seconds: float) -> str:
    """The campaign file."""
    text = HEAD.format(runs=runs, seconds=seconds)
    for rate in (1.0, 0.1):
        alone = sources(Grade.of(rate))
        together: dict[str, dict[str, float]] = {}
        for errors in alone.values():
            for sensor, values in errors.items():
                together[sensor] = together.get(sensor, {}) | values
        chosen = {**alone, ALL: together} if rate == 1.0 else {ALL: together}
        for name, errors in chosen.items():
            text += ONE.format(label=label(rate, name), errors=_drawn(errors))
    return text + f'[[design]]\nfile = "ins.toml"\nlabel = "{ALGORITHM}"\n'


def _drawn(errors: Mapping[str, Mapping[str, float]]) -> str:
    """As TOML, every value drawn with that standard deviation."""
    parts = []
    for sensor, values in errors.items():
        inside = ", ".join(f"{key} = {{ sigma = {value:g} }}" for key, value in values.items())
        parts.append(f"{sensor} = {{ {inside} }}")
    return ", ".join(parts)


def fly(
    folder: Path, runs: int = RUNS, seconds: float = 3600.0, *, advance: Advance = silent
) -> Outcome:
    """Write the campaign's files and fly what is not flown yet.

    Args:
        folder: of the files and of what is found.
        runs: of each design.
        seconds: of the flight.
        advance: told the runs that are done.
    """
    make_folder(folder)
    files: dict[str, Any] = {"ins.toml": DESIGN, "campaign.toml": campaign_text(runs, seconds)}
    for name, text in files.items():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8")
    source = folder / "campaign.toml"
    return run_campaign(Campaign.load(source), source, folder / "flown", workers=1, advance=advance)
