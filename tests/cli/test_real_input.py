"""Real logs, all the way through the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from sculler.logs import read_log
from sculler_model.design import Design

Run = Callable[..., Any]

EXAMPLES = Path(__file__).parents[2] / "examples"
DESIGN = EXAMPLES / "lasergyro.toml"


def test_laser_gyro(run: Run, data: Path, tmp_path: Path) -> None:
    source = data / "lasergyro.imu"
    if not source.is_file():
        pytest.skip(f"no {source}")
    log, model, rtl, nav = (tmp_path / f"{name}.csv" for name in ("log", "model", "rtl", "nav"))

    said = json.loads(run("convert", source, "-o", log, "--design", DESIGN, "--json").out)
    assert said["samples"] == 184_718
    assert said["sensors"]["gyro"]["unchanged"]
    assert said["sensors"]["accel"]["unchanged"]
    rows = np.loadtxt(source, skiprows=14, dtype=np.int64)
    assert np.array_equal(np.concatenate([c for c, _ in read_log(log, Design.load(DESIGN))]), rows)

    for verb, out in (("model", model), ("simulate", rtl)):
        said = json.loads(run(verb, DESIGN, log, "-o", out, "--json").out)
        assert (said["samples"], said["results"]) == (184_718, 46_179)
        assert said["leftover_samples"] == 2
    assert run("compare", model, rtl).status == 0

    outcome = run(
        *("navigate", DESIGN, model, "-o", nav, "--axes", "y,x,-z", "--align", 300, "--json"),
        *("--lat", 34.246048, "--lon", 108.909664, "--height", 380),
    )
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    # the log's own heading is -90.6° counted to the left of north
    assert said["start_attitude_deg"]["heading"] == pytest.approx(90.6, abs=0.5)
    assert said["alignment"]["rate_deg_per_h"] == pytest.approx(15.041, abs=0.1)
    # a navigation-grade unit: at most a nautical mile an hour, and hundredths of a degree an hour
    # of heading beside what the jolts of the vehicle do
    assert said["moved_horizontally_km_per_h"] < 1.852
    assert abs(said["heading_change_deg"]) < 0.05
    assert nav.with_suffix(".png").is_file()


def test_drive_from_mat(run: Run, data: Path, tmp_path: Path) -> None:
    source = data / "transfer_align_fog_mems.mat"
    if not source.is_file():
        pytest.skip(f"no {source}")
    design, log = tmp_path / "mems.toml", tmp_path / "log.csv"
    design.write_text(
        'preset = "lasergyro"\nname = "mems"\n[sensor]\n'
        "gyro = { bits = 24, lsb = 1e-9 }\naccel = { bits = 24, lsb = 1e-7 }\n"
    )
    outcome = run(
        *("convert", source, "-o", log, "--design", design, "--variable", "mimu", "--json"),
        *("--gyro-unit", "rad", "--accel-unit", "m/s", "--time-column", 7),
    )
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    assert said["samples"] == 10_001
    assert "no gaps" in said["notes"]["time"]
    counts = np.concatenate([c for c, _ in read_log(log, Design.load(design))])
    imu = scipy.io.loadmat(source)["mimu"][:, :6]
    lsb = np.array([1e-9] * 3 + [1e-7] * 3)
    # no angle is lost: at every sample the totals agree to half a count
    assert np.abs(np.cumsum(counts, axis=0) - np.cumsum(imu, axis=0) / lsb).max() < 0.51
    assert run("model", design, log, "-o", tmp_path / "v.csv").status == 0
