"""What a demo came to, and the two files that say so in its folder."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sculler.formats.comparison import Difference
from sculler.runs.engines import SimulationEngine
from sculler.words import three_digits
from sculler_model.design import Design
from sculler_model.outputs import replacing

CORRECTED, UNCORRECTED = "corrected", "uncorrected"
"""The host with the core's coning and sculling, and an integrator of the plain sums."""
QUANTITIES = ("attitude_arcsec", "velocity_m_s", "position_m")
LABELS = ("attitude", "velocity", "position")
UNITS = ("arcsec", "m/s", "m")

_SIMULATED = {
    "verilator": "what the Verilog gave in Verilator",
    "amaranth": "what the core gave in Amaranth's simulator",
}


@dataclass(frozen=True)
class Outcome:
    """What a demo came to.

    Attributes:
        design: that was generated and run.
        folder: where everything is.
        seconds: length of the motion.
        samples, majors: samples of the log, and results of the core.
        engine: what simulated the hardware.
        difference: the first between the hardware's vectors and the model's; None if they agree.
        navigation_identical: whether the states navigated with both agree to the last bit.
        errors_at_end: of `CORRECTED` and `UNCORRECTED`, the sizes of the errors by `QUANTITIES`.
        warnings: what could not be done here, and why.
        steps_s: what each step took.
        pictures: the files; none if none were drawn.
    """

    design: Design
    folder: Path
    seconds: float
    samples: int
    majors: int
    engine: SimulationEngine
    difference: Difference | None
    navigation_identical: bool
    errors_at_end: dict[str, dict[str, float]]
    warnings: list[str]
    steps_s: dict[str, float]
    pictures: list[Path]

    @property
    def identical(self) -> bool:
        """Whether the hardware and the model gave the same integers."""
        return self.difference is None

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "design": self.design.name,
            "seconds": self.seconds,
            "samples": self.samples,
            "majors": self.majors,
            "identical": self.identical,
            "navigation_identical": self.navigation_identical,
            "errors_at_end": self.errors_at_end,
            "engine": self.engine,
            "warnings": self.warnings,
            "steps_s": self.steps_s,
            "pictures": [str(picture) for picture in self.pictures],
            "folder": str(self.folder),
        }

    def write(self) -> None:
        """`summary.json`, and a README of the folder.

        Raises:
            InputError: a file cannot be written.
        """
        for name, text in (
            ("summary.json", json.dumps(self.as_json(), indent=2)),
            ("README.md", "\n".join(self._readme())),
        ):
            with replacing(self.folder / name) as temporary:
                temporary.write_text(text + "\n", encoding="utf-8")

    def _readme(self) -> list[str]:
        good, bad = (self.errors_at_end[name] for name in (CORRECTED, UNCORRECTED))
        lines = [
            "# sculler demo",
            "",
            f"{self.seconds:g} s of a vehicle at 30 m/s in a 6 °/s turn, coning (0.1° at 50 Hz)"
            " and sculling (0.1° of roll",
            "with 10 m/s² at 35 Hz), as a STIM300 would sense it.  Everything here was made by"
            " `sculler demo`.",
            "",
            "| file | what it is |",
            "|---|---|",
            f"| `imu.csv` | the integer IMU log, {self.samples:,} samples |",
            f"| `{self.design.name}/` | the generated Verilog, its manifest and its own test bench"
            " |",
            f"| `rtl.csv` | {_SIMULATED[self.engine]} |",
            "| `model.csv` | what the golden model gave: "
            + ("the same integers |" if self.identical else "NOT the same |"),
            "| `nav_truth.csv`, `nav_corrected.csv`, `nav_uncorrected.csv` | attitude, velocity"
            " and position after every major interval |",
            "| `errors.png` | attitude, velocity and position errors against the truth |",
            "| `track.png` | the ground track |",
            "| `coning.png` | what the algorithm leaves of such coning, by frequency (closed form)"
            " |",
            "| `summary.json` | the figures |",
            "",
            f"| error after {self.seconds:g} s | corrected | uncorrected |",
            "|---|---:|---:|",
            *(
                f"| {label} ({unit}) | {three_digits(good[key])} | {three_digits(bad[key])} |"
                for label, unit, key in zip(LABELS, UNITS, QUANTITIES, strict=True)
            ),
        ]
        return lines if self.pictures else [line for line in lines if ".png" not in line]
