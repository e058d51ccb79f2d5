"""What a conversion came to: as plain data for JSON and the origin file, as rows for a reader."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sculler.formats.log import COUNTS
from sculler.readers.mounting import Mounting
from sculler.readers.recording import Recording
from sculler.readers.running_sums import Differences
from sculler.readers.timing import Timing
from sculler.runs.conversion import timing_told
from sculler.runs.conversion.channels import ChannelConversions
from sculler.runs.conversion.counts import Biases, Conversion
from sculler.runs.conversion.plan import Plan
from sculler.words import warning_rows


@dataclass(frozen=True)
class Outcome:
    """What a conversion came to.

    Attributes:
        plan: what was asked for.
        output: the integer log.
        log_format: of the file, found out where it was not asked for.
        recording: its units, clock, notes and warnings.
        conversion: samples, largest counts and remainders.
        mounting, biases: that were taken into account.
        timing: what the stamps showed; None without any.
        differences: what undid running sums; None where there were none.
        left_out_s: time at the ends that no even step covers, s; None if nothing was resampled.
        doubts: what the numbers themselves gave to doubt.
    """

    plan: Plan
    output: Path
    log_format: str
    recording: Recording
    conversion: Conversion | ChannelConversions
    mounting: Mounting
    biases: Biases
    timing: Timing | None = None
    differences: Differences | None = None
    left_out_s: float | None = None
    doubts: list[str] = field(default_factory=list)

    @property
    def warnings(self) -> list[str]:
        """What to look at before trusting the log."""
        warnings = [*self.recording.warnings, *self.conversion.hints(), *self.doubts]
        if self.timing is not None:
            plan = self.plan
            warnings += timing_told.warnings(self.timing, plan.design, plan.gaps, plan.steps)
        return warnings

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        plan, datagrams = self.plan, self.recording.datagrams
        data = self._numbers() | {
            "axes": plan.axes or "x,y,z",
            "mounting": self.mounting.rows(),
            "biases": asdict(self.biases),
            "misalignment": self.mounting.misalignment,
            "timing": None,
            "datagrams": None if datagrams is None else asdict(datagrams),
            "warnings": self.warnings,
        }
        if self.timing is not None:
            timing = timing_told.as_json(self.timing, plan.design, plan.gaps, plan.steps)
            data["timing"] = timing
            if self.left_out_s is not None:
                timing["left_out_s"] = self.left_out_s
        if plan.calibration is not None:
            data["notes"]["calibration"] = f"errors of {plan.calibration} taken out"
        if self.differences is not None:
            data["notes"]["running sums"] = self.differences.told()
        return data

    def _numbers(self) -> dict[str, Any]:
        """Samples, units, counts."""
        design = self.plan.design
        bits = {"gyro": design.sensor.gyro.bits, "accel": design.sensor.accel.bits}
        lsb = {"gyro": design.sensor.gyro.lsb, "accel": design.sensor.accel.lsb}
        units = {"gyro": self.recording.gyro.name, "accel": self.recording.accel.name}
        return {
            "log": str(self.plan.log),
            "format": self.log_format,
            "output": str(self.output),
            "design": design.name,
            "kind": design.sensor.kind,
            "samples": self.conversion.samples,
            "seconds": self.conversion.samples * design.sample_interval / design.channels,
            "notes": dict(self.recording.notes),
            "sensors": {
                sensor: {
                    "unit": units[sensor],
                    "unchanged": self.conversion.passes(sensor),
                    "made": self.conversion.made(sensor),
                    "lsb": lsb[sensor],
                    "bits": bits[sensor],
                }
                for sensor in ("gyro", "accel")
            },
            "columns": {
                column: {
                    "largest_count": int(largest),
                    "share_of_full_scale": int(largest) / 2 ** (bits[column.split("_")[0]] - 1),
                    "remainder": left,
                }
                for column, largest, left in zip(
                    COUNTS, self.conversion.largest, self.conversion.remainder, strict=True
                )
            },
        }


def told(data: Mapping[str, Any]) -> dict[str, str]:
    """`Outcome.as_json` in words: name and value of what is worth saying."""
    rows = {
        "read": f"{data['log']} (format {data['format']})",
        "samples": f"{data['samples']:,}, {data['seconds']:,.6g} s",
    }
    rows |= {sensor: facts["made"] for sensor, facts in data["sensors"].items()}
    rows |= data["notes"]
    if data["timing"] is not None:
        rows["time"] = timing_told.words(data["timing"])
    return rows | warning_rows(data["warnings"]) | {"wrote": data["output"]}
