"""The integer IMU log of a known motion, and its truth: from a plan to files and an `Outcome`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import count
from math import floor, radians
from pathlib import Path
from typing import Any

import numpy as np

from sculler.formats.history import HistoryWriter
from sculler.formats.lines import ahead
from sculler.formats.log import LogWriter
from sculler.formats.truth import read_truth
from sculler.formats.truth_columns import LOCAL
from sculler.plots.allan import allan_picture
from sculler.plots.points import points_picture, points_picture_path
from sculler.runs.allan import Gathered, allan_facts
from sculler.words import Advance, silent
from sculler_model import inputs
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY, Vector
from sculler_model.motion import PLACE, Motion, Points, Vibration, delivered, through
from sculler_model.navigation import NavHistory
from sculler_model.outputs import replacing
from sculler_model.samples import (
    AllanCurve,
    Imperfect,
    Quantiser,
    end_after_stamp,
    interval_end,
    sample_stamp,
)


@dataclass(frozen=True)
class Shaking:
    """Random vibration on top of a motion, alike along or about each axis.

    Attributes:
        g: acceleration, g rms.
        rate: angular rate, °/s rms.
        low, high: band of both, Hz.
        lines: sinusoids that make it up, each axis.
        seed: of the random numbers.

    Raises:
        InputError: there is no such band.
    """

    g: float
    rate: float
    low: float
    high: float
    lines: int
    seed: int

    def __post_init__(self) -> None:
        _ = self.vibration  # refuses what is no band

    @cached_property
    def vibration(self) -> Vibration:
        """In SI."""
        return Vibration(
            STANDARD_GRAVITY * self.g,
            radians(self.rate),
            self.low,
            self.high,
            self.lines,
            self.seed,
        )


@dataclass(frozen=True)
class Given:
    """The points of a file that a motion goes through.

    Attributes:
        path: the file.
        points: of it.
        smoothness: continuous derivatives of the curve.
        passed_over: rows of the file with no number.
        local: the file tells metres from a place.
    """

    path: str
    points: Points
    smoothness: int
    passed_over: int = 0
    local: bool = False

    @property
    def seconds(self) -> float:
        """From the first point to the last."""
        return float(self.points.time[-1] - self.points.time[0])

    def motion(self) -> Motion:
        """The motion through them; raises as `sculler_model.motion.through`, naming the file."""
        try:
            return through(self.points, self.smoothness)
        except InputError as error:
            raise InputError(f"{self.path}: {error}") from error

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "from": self.path,
            "points": len(self.points),
            "points_passed_over": self.passed_over,
            "first_point_s": float(self.points.time[0]),
            "smoothness": self.smoothness,
            "attitude": "along the way" if self.points.q is None else "of the points",
        }


def read_points(
    path: str, place: Vector | None = None, smoothness: int = 3, spacing: float | None = None
) -> Given:
    """The points of a file, in any of the forms that a truth may have.

    Args:
        path: columns as `sculler.formats.truth` describes them, or `north_m,east_m,up_m`.
        place: that those metres start from: latitude, longitude (rad), height (m).
        smoothness: continuous derivatives of the curve, 2 to 4.
        spacing: s, take points so far apart only; None to take all.

    Raises:
        InputError: the file cannot be read, has a fault, or tells no places.
    """
    passed: list[int] = []
    names: list[str] = []
    blocks = list(read_truth(path, None, passed.append, place or PLACE, names.extend))
    states = NavHistory.concatenate(blocks)
    if np.isnan(states.lat[0]):
        raise InputError(
            f"{path}: no place is there, add lat_deg,lon_deg,height_m or x_m,y_m,z_m or"
            " north_m,east_m,up_m"
        )
    q = None if np.isnan(states.q[0, 0]) else states.q
    points = Points(states.time, states.lat, states.lon, states.h, q)
    if spacing is not None:
        points = points.apart(spacing)
    return Given(path, points, smoothness, sum(passed), LOCAL[0] in names)


@dataclass(frozen=True)
class Plan:
    """What to write.

    Attributes:
        design: gives the sensor.
        name: of the motion, in the catalogue.
        motion: it.
        seconds: how long.
        truth_every: seconds between the truth's rows; None for a major interval.
        shaking: vibration on top, or None.
        options: what was said of the motion, to be told again.
        given: the points that it goes through; None for a motion of the catalogue.
        seed: of the random numbers in [sensor.errors].

    Raises:
        InputError: no sample is that short, or the points end before.
    """

    design: Design
    name: str
    motion: Motion
    seconds: float
    truth_every: float | None = None
    shaking: Shaking | None = None
    options: Mapping[str, float] = field(default_factory=dict)
    given: Given | None = None
    seed: int = 1

    def __post_init__(self) -> None:
        if self.given is not None and self.seconds > self.given.seconds + 1e-9:
            raise InputError(
                f"--duration: {self.given.path} ends {self.given.seconds:.9g} s after its first"
                f" point, give at most that"
            )
        if self.samples < 1:
            raise InputError(f"--duration: {self.seconds:g} s are shorter than a sample, give more")

    @property
    def samples(self) -> int:
        """Of the log."""
        return round(self.seconds * self.design.sensor.sample_rate_hz)

    @property
    def every(self) -> float:
        """Seconds between the truth's rows."""
        return self.design.major_interval if self.truth_every is None else self.truth_every

    @property
    def begin(self) -> float:
        """Time of the truth's first row, s: the first end of an interval from time 0 on."""
        # a rate's first interval reaches before time 0, and so do some of aligned samples
        ends = (interval_end(self.design, interval) for interval in count(-1))
        return next(end for end in ends if end >= 0)

    @property
    def truth_rows(self) -> int:
        """As many as the log reaches, one at least."""
        end = sample_stamp(self.design, self.samples - 1) + end_after_stamp(self.design)
        return max(floor((end - self.begin) / self.every + 1e-9) + 1, 1)


@dataclass(frozen=True)
class Outcome:
    """What was written.

    Attributes:
        plan: what was asked for.
        output, truth: the files.
        full_scale: the largest count as a share of full scale.
        pictures: files drawn.
        beyond_range: samples in which an axis stayed at the end of the sensor's range.
        allan: Allan deviations of the samples less the perfect ones; None if not asked for.
        allan_picture: drawn of them.
    """

    plan: Plan
    output: Path
    truth: Path
    full_scale: float
    pictures: tuple[Path, ...] = ()
    beyond_range: int = 0
    allan: AllanCurve | None = None
    allan_picture: Path | None = None

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        plan, design = self.plan, self.plan.design
        data: dict[str, Any] = {
            "motion": plan.name,
            "design": design.name,
            "options": dict(plan.options),
            "seconds": plan.samples * design.sample_interval,
            "samples": plan.samples,
            "full_scale": self.full_scale,
            "truth_every_s": plan.every,
            "truth_rows": plan.truth_rows,
            "output": str(self.output),
            "truth": str(self.truth),
        }
        if plan.given is not None:
            data |= plan.given.as_json()
        if (errors := design.sensor.errors) is not None:
            data["errors"] = errors.model_dump(mode="json", exclude_none=True)
            data |= {"error_seed": plan.seed, "samples_beyond_range": self.beyond_range}
        if self.pictures:
            data["plots"] = [str(path) for path in self.pictures]
        if self.allan is not None:
            data["allan"] = allan_facts(self.allan, design, self.allan_picture)
        if (shaking := plan.shaking) is not None:
            data["vibration"] = {
                "g_rms": shaking.g,
                "rate_deg_per_s_rms": shaking.rate,
                "band_hz": [shaking.vibration.low, shaking.vibration.high],
                "lines": shaking.vibration.lines,
                "seed": shaking.seed,
            }
        return data

    def told(self) -> dict[str, str]:
        """In words, row by row."""
        data = self.as_json()
        shown = {
            "motion": data["motion"],
            "log": f"{data['samples']:,} samples, {data['seconds']:,.6g} s, for {data['design']}",
            "largest count": f"{100 * data['full_scale']:.3g} % of full scale",
            "truth": f"{data['truth_rows']:,} rows, every {data['truth_every_s']:g} s",
        }
        if "from" in data:
            shown["through"] = (
                f"{data['points']:,} points of {data['from']}, time 0 is its"
                f" {data['first_point_s']:.9g} s; {data['smoothness']} continuous derivatives,"
                f" attitude {data['attitude']}"
            )
            if data["points_passed_over"]:
                shown["passed over"] = f"{data['points_passed_over']:,} rows with no number"
        if "vibration" in data:
            found = data["vibration"]
            low, high = found["band_hz"]
            shown["vibration"] = (
                f"{found['g_rms']:g} g and {found['rate_deg_per_s_rms']:g} °/s rms an axis,"
                f" {low:g} to {high:g} Hz, {found['lines']} lines, seed {found['seed']}"
            )
        if "errors" in data:
            shown["sensor errors"] = f"of [sensor.errors], seed {data['error_seed']}"
        if data.get("samples_beyond_range"):
            shown["beyond range"] = f"{data['samples_beyond_range']:,} samples stayed at its end"
        if self.pictures:
            shown["pictures"] = ", ".join(data["plots"])
        if "allan" in data:
            found = data["allan"]
            shown["Allan deviation"] = (
                f"{found['picture']}: within a factor of {found['worst_ratio']:.3g} of what was"
                f" asked for, from {found['tau_s'][0]:.3g} to {found['tau_s'][-1]:.3g} s, chance"
                " allowed for"
            )
        return shown | {"wrote": f"{data['output']}, {data['truth']}"}


def write_motion(
    plan: Plan,
    output: Path,
    truth: Path,
    *,
    pictures: bool = False,
    allan: Path | None = None,
    advance: Advance = silent,
) -> Outcome:
    """Write the log that the design's sensor gives of the motion, and the motion's truth.

    Args:
        plan: what to write.
        output, truth: the files, each appears whole or not at all.
        pictures: draw a motion that goes through points beside them.
        allan: a picture of the Allan deviations of the samples less the perfect ones.
        advance: told the samples and rows that were written.

    Raises:
        InputError: a count does not fit the sensor, or a file cannot be written.
    """
    design, motion = plan.design, plan.motion
    if plan.shaking is not None:
        motion = plan.shaking.vibration.on(motion)
    quantise = Quantiser(design)
    imperfect = Imperfect(design, plan.seed)
    if pictures and plan.given is not None:
        inputs.claim(points_picture_path(output))
    gathered = None if allan is None else Gathered(design, plan.samples)
    with replacing(output) as temporary:
        with LogWriter(temporary) as log:
            for perfect in ahead(delivered(motion, design, plan.samples)):
                counts = quantise(imperfect(perfect))
                log.write(counts)
                if gathered is not None:
                    gathered.add(counts, perfect)
                advance(len(perfect))
        with replacing(truth) as temporary_truth, HistoryWriter(temporary_truth) as rows:
            for states in motion.states(plan.truth_rows, plan.every, plan.begin):
                rows.write(states)
                advance(len(states))
    drawn: tuple[Path, ...] = ()
    if pictures and plan.given is not None:
        drawn = (points_picture(motion, plan.given.points, plan.seconds, output),)
    full_scale = max(quantise.report().full_scale)
    curve = None if gathered is None else gathered.record.curve()
    if curve is not None and allan is not None:
        allan_picture(allan, curve, design)
    beyond = imperfect.beyond_range
    return Outcome(plan, output, truth, full_scale, drawn, beyond, curve, allan)
