"""Every path at the log's own stamps: a motion whose timing error shows.

A body spins and rocks by 30° at 1 Hz in roll and pitch, so that a millisecond is hundreds of
arcseconds.  Logs, truths and results are all on clocks of their own, and what `navigate` finds at
the stamps must be what the motion is there, to 0.05″.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import degrees, pi, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.history import HistoryWriter
from sculler.plots.pictures import TimeAxis
from sculler_model.design import Design
from sculler_model.motion import Curve, Motion, Turn, X, spin_rock_size
from sculler_model.navigation import navigation_errors
from sculler_model.samples import end_after_stamp, interval_end, interval_ends, sample_stamp

Run = Callable[..., Any]

ROCKING = ("--rocking", 30, "--frequency", 1, "--arm", 0.1)
MOTION = spin_rock_size(radians(48), radians(11), 500.0, rocking=radians(30), hertz=1.0, arm=0.1)
BOUND = 0.05
"""Arcseconds of attitude at any of the log's own stamps."""

_DESIGN = """
name = "d"
[sensor]
kind = "{kind}"
sample_rate_hz = {rate}
gyro = {{ bits = 32, lsb = {gyro} }}
accel = {{ bits = 32, lsb = {accel} }}
[algorithm]
family = "{family}"
samples = {samples}
history = {history}
minors = {minors}
{more}
"""
SINC = 'filter = { kind = "sinc" }'


def design_file(
    folder: Path,
    family: str,
    rate: float,
    samples: int,
    minors: int,
    history: int = 0,
    kind: str = "rate",
    more: str = "",
) -> Path:
    """A design with LSBs that do not show."""
    path = folder / "d.toml"
    gyro, accel = (1e-11, 1e-9) if kind == "increment" else (5e-9, 1e-6)
    text = _DESIGN.format(
        kind=kind, rate=rate, gyro=gyro, accel=accel, family=family, samples=samples,
        history=history, minors=minors, more=more,
    )  # fmt: skip
    path.write_text(text)
    return path


def navigated(run: Run, toml: Path, vectors: Path, *options: object) -> dict[str, Any]:
    out = vectors.with_name("nav.csv")
    outcome = run("navigate", toml, vectors, "-o", out, "--no-plots", "--json", *options)
    assert outcome.status == 0, outcome
    said: dict[str, Any] = json.loads(outcome.out)
    return said


INCREMENTS = {"kind": "increment"}
FAMILIES = {
    "increments": ("frequency-taylor", 1000.0, 2, 5, 0, "increment", ""),
    "increments with history": ("frequency-taylor", 1000.0, 2, 5, 1, "increment", ""),
    "dense increments with history": ("time-taylor", 1000.0, 3, 3, 1, "increment", ""),
    "filtered rates": ("filtered-rate", 4000.0, 2, 10, 0, "rate", ""),
    "filtered rates with history": ("filtered-rate", 4000.0, 2, 10, 1, "rate", ""),
    "filtered rates, Boole's weights": ("filtered-rate", 4000.0, 4, 5, 0, "rate", ""),
    "Newton-Cotes rates": (
        "tuned", 4000.0, 3, 7, 0, "rate", f'sum = "newton-cotes"\n{SINC}',
    ),
    "plain sums of rates": ("tuned", 1000.0, 3, 3, 0, "rate", f'sum = "plain"\n{SINC}'),
    "plain sums of rates with history": (
        "tuned", 1000.0, 2, 5, 2, "rate", f'sum = "plain"\n{SINC}',
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAMILIES)
def test_motion_model_navigate(run: Run, tmp_path: Path, name: str) -> None:
    family, rate, samples, minors, history, kind, more = FAMILIES[name]
    toml = design_file(tmp_path, family, rate, samples, minors, history, kind, more)
    log, truth, vectors = (tmp_path / f"{what}.csv" for what in ("imu", "truth", "vectors"))
    words = ("--design", toml, "-o", log, "--truth", truth, "--duration", 4, *ROCKING)
    assert run("motion", "spin-rock-size", *words).status == 0
    assert run("model", toml, log, "-o", vectors).status == 0
    for options in ((), ("--start", interval_end(Design.load(toml), 30))):
        said = navigated(run, toml, vectors, "--truth", truth, "--third-order", *options)
        assert said["errors"]["interpolated"] == 0
        assert said["errors"]["attitude_arcsec"]["total"]["max"] < BOUND
        assert said["errors"]["position_m"]["horizontal"]["max"] < 1e-3
        assert said["errors"]["left_out_s"]["truth_after"] < 1e-9
        if options:
            assert said["start_s"] == pytest.approx(options[1], abs=1e-12)


CLOCKS = (0.0, 4000.5, 1.4e9)


def rate_log(path: Path, clock: float, times: Any, values: Any) -> Path:
    """A foreign log: stamps with as many digits as they need, and floats."""
    head = "t,wx,wy,wz,ax,ay,az"
    rows = [
        ",".join([f"{clock + t:.6f}", *map(repr, row)])
        for t, row in zip(times.tolist(), values.tolist(), strict=True)
    ]
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def truth_file(path: Path, clock: float, times: Any, motion: Motion = MOTION) -> Path:
    """What the motion is at stamps of the log's clock, as that writes them."""
    states = motion.state(times)
    told = np.array([float(f"{clock + t:.6f}") for t in times.tolist()])
    object.__setattr__(states, "time", told)
    with HistoryWriter(path) as writer:
        writer.write(states)
    return path


COLUMNS = ("--time-column", "t", "--gyro-columns", "wx,wy,wz", "--accel-columns", "ax,ay,az")
RATES = (*COLUMNS, "--gyro-unit", "rad/s", "--accel-unit", "m/s2")
SUMS = (*COLUMNS, "--gyro-unit", "rad", "--accel-unit", "m/s")


def converted(
    run: Run,
    folder: Path,
    toml: Path,
    clock: float,
    log: Path,
    end: Any,
    *options: object,
    motion: Motion = MOTION,
) -> dict[str, Any]:
    """Errors at all the ends of major intervals, by way of `convert` and `model`."""
    imu, vectors = folder / "imu.csv", folder / "vectors.csv"
    outcome = run("convert", log, "--design", toml, "-o", imu, *options)
    assert outcome.status == 0, outcome
    assert run("model", toml, imu, "-o", vectors).status == 0
    truth = truth_file(folder / "truth.csv", clock, end, motion)
    said = navigated(run, toml, vectors, "--truth", truth, "--third-order")
    assert said["errors"]["interpolated"] == 0
    assert said["errors"]["instants"] >= len(end) - 2
    assert said["start_s"] == pytest.approx(clock + end[0], abs=0.03)
    errors: dict[str, Any] = said["errors"]
    return errors


ROLLING = Motion(
    radians(48),
    radians(11),
    500.0,
    turns=(Turn(X, Curve(waves=((radians(30), 2 * pi, 0.3),))),),
    name="rocking",
)
"""About one axis: no coning, whatever the filter."""

UNFILTERED = 'sum = "newton-cotes"\nfilter = { kind = "digital", numerator = [1.0] }'


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize(
    ("motion", "family", "rate", "samples", "history", "more"),
    [
        (ROLLING, "filtered-rate", 200.0, 2, 0, ""),
        (ROLLING, "filtered-rate", 200.0, 4, 0, ""),
        (ROLLING, "filtered-rate", 200.0, 2, 1, ""),
        (MOTION, "tuned", 1000.0, 2, 0, UNFILTERED),
    ],
    ids=["two samples", "four samples", "history", "about all axes at 1 kHz"],
)
def test_a_rate_log_at_its_own_stamps(
    run: Run,
    tmp_path: Path,
    clock: float,
    motion: Motion,
    family: str,
    rate: float,
    samples: int,
    history: int,
    more: str,
) -> None:
    """At 200 Hz 4152″ rms one sample late; at the log's own stamps next to nothing is left."""
    seconds = 10 if rate < 1000 else 4
    toml = design_file(tmp_path, family, rate, samples, 1, history, more=more)
    h = 1 / rate
    t = h * np.arange(round(seconds * rate))
    values = motion.rates(len(t), h, filtered=False)
    log = rate_log(tmp_path / "log.csv", clock, t, values)
    end = interval_ends(Design.load(toml), np.arange(len(t) // samples))
    assert set(np.round(end / h).astype(int)) < set(range(len(t)))  # stamps of the log
    errors = converted(run, tmp_path, toml, clock, log, end, *RATES, motion=motion)
    assert errors["attitude_arcsec"]["total"]["max"] < BOUND
    # one sample off, the motion shows: 133 °/s rms about each axis that rocks
    late, there = motion.state(end + h), motion.state(end)
    off = navigation_errors(replace(late, time=there.time), there).attitude
    assert 3600 * degrees(np.sqrt(np.mean(np.sum(off**2, axis=1)))) > 3600 * 130 * h


@pytest.mark.parametrize("clock", CLOCKS)
def test_a_rate_log_for_increments(run: Run, tmp_path: Path, clock: float) -> None:
    toml = design_file(tmp_path, "frequency-taylor", 400.0, 2, 2, kind="increment")
    h = 1 / 400
    t = h * np.arange(4001)
    log = rate_log(tmp_path / "log.csv", clock, t, MOTION.rates(len(t), h, filtered=False))
    # the increments begin at the first rate
    end = interval_ends(Design.load(toml), np.arange(-1, 1000))
    errors = converted(run, tmp_path, toml, clock, log, end, *RATES)
    assert errors["attitude_arcsec"]["total"]["max"] < BOUND


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("steps", ["even", "resample"])
def test_an_increment_log(run: Run, tmp_path: Path, clock: float, steps: str) -> None:
    toml = design_file(tmp_path, "frequency-taylor", 400.0, 2, 2, 1, kind="increment")
    h = 1 / 400
    t = h * np.arange(1, 4001)
    log = rate_log(tmp_path / "log.csv", clock, t, MOTION.increments(len(t), h))
    end = interval_ends(Design.load(toml), np.arange(-1, 1000))
    errors = converted(run, tmp_path, toml, clock, log, end, *SUMS, "--steps", steps)
    assert errors["attitude_arcsec"]["total"]["max"] < BOUND


def _decimal_text(path: Path, stamps: list[Fraction], values: Any, digits: int = 9) -> None:
    """Stamps in seconds with digits that a float has no room for."""
    rows = [
        ",".join([_decimal(stamp, digits), *map(repr, row)])
        for stamp, row in zip(stamps, values.tolist(), strict=True)
    ]
    path.write_text("\n".join([",".join(HEAD), *rows]) + "\n")


def _decimal(stamp: Fraction, digits: int) -> str:
    whole, rest = divmod(round(stamp * 10**digits), 10**digits)
    return f"{whole}.{rest:0{digits}}"


def _euroc(path: Path, stamps: list[Fraction], values: Any) -> None:
    """Rates with whole nanoseconds."""
    head = ["#timestamp [ns]", *(f"{name}_RS_S_{axis}" for name in "wa" for axis in "xyz")]
    rows = [
        ",".join([str(round(stamp * 10**9)), *map(repr, row)])
        for stamp, row in zip(stamps, values.tolist(), strict=True)
    ]
    path.write_text("\n".join([",".join(head), *rows]) + "\n")


def _ros(path: Path, stamps: list[Fraction], values: Any) -> None:
    """Rates with whole seconds and nanoseconds in two columns."""
    head = ["header.stamp.secs", "header.stamp.nsecs"]
    head += [
        f"{name}.{axis}" for name in ("angular_velocity", "linear_acceleration") for axis in "xyz"
    ]
    rows = [
        ",".join([*map(str, divmod(round(stamp * 10**9), 10**9)), *map(repr, row)])
        for stamp, row in zip(stamps, values.tolist(), strict=True)
    ]
    path.write_text("\n".join([",".join(head), *rows]) + "\n")


def _kfgins(path: Path, stamps: list[Fraction], values: Any) -> None:
    rows = [
        " ".join([_decimal(stamp, 9), *map(repr, row)])
        for stamp, row in zip(stamps, values.tolist(), strict=True)
    ]
    path.write_text("\n".join(rows) + "\n")


def _kfgins_binary(path: Path, stamps: list[Fraction], values: Any) -> None:
    np.column_stack([[float(stamp) for stamp in stamps], values]).astype("<f8").tofile(path)


def _npz_seconds(path: Path, stamps: list[Fraction], values: Any) -> None:
    time = np.array([float(stamp) for stamp in stamps])
    np.savez(path, time=time, dtheta=values[:, :3], dvel=values[:, 3:])


def _npz_microseconds(path: Path, stamps: list[Fraction], values: Any) -> None:
    time = np.array([round(stamp * 10**6) for stamp in stamps], np.int64)
    np.savez(path, time=time, time_unit="us", dtheta=values[:, :3], dvel=values[:, 3:])


def _parquet(path: Path, stamps: list[Fraction], values: Any, kind: str) -> None:
    pa, pq = (pytest.importorskip(name) for name in ("pyarrow", "pyarrow.parquet"))
    time: Any = pa.array([round(stamp * 10**9) for stamp in stamps], pa.int64())
    if kind == "timestamp":
        time = time.cast(pa.timestamp("ns"))
    elif kind == "seconds":
        time = pa.array([float(stamp) for stamp in stamps], pa.float64())
    table = {"t": time} | {name: pa.array(values[:, k]) for k, name in enumerate(HEAD[1:])}
    pq.write_table(pa.table(table), path)


HEAD = ("t", "wx", "wy", "wz", "ax", "ay", "az")
CSV = ("--format", "csv")
EPOCH = {  # writer, file, kind of values, sample rate, options
    "decimals": (_decimal_text, "log.csv", "sums", 300, (*CSV, *SUMS)),
    "decimals, rates": (_decimal_text, "log.csv", "rates", 1200, (*CSV, *RATES)),
    "EuRoC": (_euroc, "log.csv", "rates", 1200, ("--format", "euroc")),
    "ROS": (_ros, "log.csv", "rates", 1200, ("--format", "ros")),
    "KF-GINS": (_kfgins, "log.txt", "sums", 300, ("--format", "kfgins")),
    "KF-GINS binary": (_kfgins_binary, "log.bin", "sums", 400, ("--format", "kfgins-binary")),
    "npz in s": (_npz_seconds, "log.npz", "sums", 400, ()),
    "npz in us": (_npz_microseconds, "log.npz", "sums", 400, ()),
    "Parquet in ns": (partial(_parquet, kind="ns"), "log.parquet", "sums", 300, SUMS),
    "Parquet time stamps": (partial(_parquet, kind="timestamp"), "log.parquet", "sums", 300, SUMS),
    "Parquet in s": (partial(_parquet, kind="seconds"), "log.parquet", "sums", 400, SUMS),
}  # fmt: skip


@pytest.mark.parametrize("name", EPOCH)
def test_stamps_since_1970_lose_no_digit(run: Run, tmp_path: Path, name: str) -> None:
    """A float has steps of 0.24 µs there: 0.16″ of what turns by 190 °/s."""
    write, file, kind, rate, options = EPOCH[name]
    toml = design_file(tmp_path, "frequency-taylor", rate, 2, rate // 200, kind="increment")
    clock, count = 1_400_000_000, 4 * rate
    first = 0 if kind == "rates" else 1
    stamps = [clock + Fraction(k, rate) for k in range(first, count + 1)]
    values = (
        MOTION.rates(len(stamps), 1 / rate, filtered=False)
        if kind == "rates"
        else MOTION.increments(len(stamps), 1 / rate)
    )
    log = tmp_path / file
    write(log, stamps, values)
    design = Design.load(toml)
    end = interval_ends(design, np.arange(-1, count // design.samples_per_major))
    errors = converted(run, tmp_path, toml, clock, log, end, *options, "--steps", "resample")
    assert errors["attitude_arcsec"]["total"]["max"] < BOUND
    # the log's own column tells the stamps to a nanosecond
    rows = (tmp_path / "imu.csv").read_text().splitlines()[1:]
    written = [Fraction(row.rsplit(",", 1)[1]) for row in rows]
    grid = [clock + Fraction(k + 1, rate) for k in range(len(rows))]
    assert max(abs(a - b) for a, b in zip(written, grid, strict=True)) < Fraction(3, 10**9)


@pytest.mark.parametrize("given", ["sums", "sums resampled", "means", "means resampled"])
def test_means_over_the_step_before_for_a_rate_sensor(run: Run, tmp_path: Path, given: str) -> None:
    """They are the rates in the steps' middles, and the log says so."""
    clock, rate = 4000.5, 1000.0
    toml = design_file(
        tmp_path, "tuned", rate, 2, 5, more=f'sum = "plain"\n{SINC}'
    )  # plain sums of means are exact angles
    h = 1 / rate
    t = h * np.arange(1, 4001)
    values = MOTION.increments(len(t), h)
    means = given.startswith("means")
    log = rate_log(tmp_path / "log.csv", clock, t, values / h if means else values)
    units = (*RATES, "--rates", "mean") if means else SUMS
    steps = ("--steps", "resample") if given.endswith("resampled") else ()
    # sums of means over steps from time 0 on end with a step
    design = Design.load(toml)
    end = design.major_interval * np.arange(401)
    assert end_after_stamp(design) == 0.5 * h
    errors = converted(run, tmp_path, toml, clock, log, end, *units, *steps)
    assert errors["attitude_arcsec"]["total"]["max"] < BOUND


def test_start_and_stop_are_on_the_logs_clock(run: Run, tmp_path: Path) -> None:
    clock = 1.4e9
    toml = design_file(tmp_path, "filtered-rate", 200.0, 2, 1)
    h = 1 / 200
    t = h * np.arange(2000)
    log = rate_log(tmp_path / "log.csv", clock, t, ROLLING.rates(len(t), h, filtered=False))
    end = interval_ends(Design.load(toml), np.arange(1000))
    converted(run, tmp_path, toml, clock, log, end, *RATES, motion=ROLLING)
    vectors, truth = tmp_path / "vectors.csv", tmp_path / "truth.csv"
    span = ("--start", "1400000003.005", "--stop", "1400000007.5")
    said = navigated(run, toml, vectors, "--truth", truth, "--third-order", *span)
    assert said["start_s"] == 1400000003.005
    assert said["seconds"] == pytest.approx(4.49, abs=1e-6)  # the last end before is at 7.495 s
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < BOUND
    rows = (tmp_path / "nav.csv").read_text().splitlines()
    assert [rows[k].split(",")[0] for k in (1, 2, -1)] == [
        "1400000003.005",
        "1400000003.015",
        "1400000007.495",
    ]


@pytest.mark.parametrize(
    ("name", "first", "last_sample", "end"),
    [
        # samples of 1 ms, ten to a major interval; the second interval's end
        ("increments", 0.001, 0.020, 0.020),
        ("filtered rates", 0.0, 0.019, 0.019),
        ("plain sums of rates", 0.0, 0.019, 0.0195),
    ],
)
def test_the_definition(
    tmp_path: Path, name: str, first: float, last_sample: float, end: float
) -> None:
    family, _, samples, minors, history, kind, more = FAMILIES[name]
    samples, minors = 2, 5
    design = Design.load(
        design_file(tmp_path, family, 1000.0, samples, minors, history, kind, more)
    )
    assert (sample_stamp(design, 0), sample_stamp(design, 19)) == (first, last_sample)
    assert interval_end(design, 1) == pytest.approx(end, abs=1e-16)
    assert interval_end(design, -1) == pytest.approx(end - 0.02, abs=1e-16)
    assert end_after_stamp(design) == pytest.approx(end - last_sample, abs=1e-16)


def test_an_axis_of_time_is_on_the_logs_clock_and_can_be_read() -> None:
    plain = TimeAxis(np.array([4000.5, 4010.0, 4100.0]))
    assert (plain.label, plain.t.tolist()) == ("time (s)", [4000.5, 4010.0, 4100.0])
    hours = TimeAxis(np.array([0.0, 3600.0, 36_000.0]))
    assert (hours.label, hours.t.tolist()) == ("time (h)", [0, 1, 10])
    epoch = TimeAxis(1.4e9 + np.array([0.5, 60.0, 2000.0]))
    assert epoch.label == "time (min) after 1400000000 s"
    assert epoch.t == pytest.approx(np.array([0.5, 60, 2000]) / 60)
    assert epoch.at(np.array([1.4e9 + 120]))[0] == 2
