"""Real logs, all the way through the command line."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from subprocess import run as run_program
from textwrap import dedent
from typing import Any

import numpy as np
import pytest
import scipy.io

from sculler.formats.log import read_log
from sculler.formats.telemetry import FRAME
from sculler_model.design import Design

Run = Callable[..., Any]

EXAMPLES = Path(__file__).parents[2] / "examples"
DESIGN = EXAMPLES / "lasergyro.toml"
DRIVE = Path(__file__).parents[2] / "docs/tutorials/drive.md"


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
    assert np.array_equal(np.concatenate([c for c, *_ in read_log(log, Design.load(DESIGN))]), rows)

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


def test_laser_gyro_by_the_host_in_c(run: Run, data: Path, tmp_path: Path) -> None:
    """The states of 770 s of a real log, and its telemetry, are Python's to the byte."""
    source = data / "lasergyro.imu"
    if not source.is_file():
        pytest.skip(f"no {source}")
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")
    log, model = tmp_path / "log.csv", tmp_path / "model.csv"
    assert run("convert", source, "-o", log, "--design", DESIGN).status == 0
    assert run("model", DESIGN, log, "-o", model).status == 0
    found = by_both_hosts(
        *(run, tmp_path, DESIGN, model, "--axes", "y,x,-z", "--third-order"),
        *("--lat", 34.246048, "--lon", 108.909664, "--height", 380, "--heading", 90.6),
        *("--height-damping", 60),
    )
    assert found == 46_180


def by_both_hosts(run: Run, folder: Path, design: Path, model: Path, *options: object) -> int:
    """How many states Python's host and the one in C tell, which are the same to the last bit."""
    found = []
    for engine in ("python", "c"):
        nav, frames = folder / f"{engine}.csv", folder / f"{engine}.frames"
        outcome = run(
            *("navigate", design, model, "-o", nav, "--engine", engine, "--telemetry", frames),
            *(*options, "--no-plots"),
        )
        assert outcome.status == 0, outcome.err
        found.append((nav.read_bytes(), frames.read_bytes()))
    assert found[0] == found[1]
    return len(found[0][1]) // FRAME.itemsize


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
    assert said["timing"]["gap_count"] == said["timing"]["unequal_steps"] == 0
    counts = np.concatenate([c for c, *_ in read_log(log, Design.load(design))])
    imu = scipy.io.loadmat(source)["mimu"][:, :6]
    lsb = np.array([1e-9] * 3 + [1e-7] * 3)
    # no angle is lost: at every sample the totals agree to half a count
    assert np.abs(np.cumsum(counts, axis=0) - np.cumsum(imu, axis=0) / lsb).max() < 0.51
    assert run("model", design, log, "-o", tmp_path / "v.csv").status == 0


def page_blocks() -> list[str]:
    """Indented blocks of docs/tutorials/drive.md: design, script, commands, fitted constants."""
    text = DRIVE.read_text()
    blocks = re.findall(r"(?:(?:^ {4}.*|^)\n)*^ {4}.*\n", text, re.MULTILINE)
    return [dedent(block).strip() + "\n" for block in blocks]


@pytest.fixture
def page(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> tuple[list[list[str]], str]:
    """The page's folder, stood in: its commands in words, and the constants that it fitted."""
    source = data / "transfer_align_fog_mems.mat"
    if not source.is_file():
        pytest.skip(f"no {source}")
    (tmp_path / source.name).symlink_to(source.resolve())
    monkeypatch.chdir(tmp_path)
    design, script, commands, fitted = page_blocks()
    Path("mems.toml").write_text(design)
    Path("reference.py").write_text(script)
    run_program([sys.executable, "reference.py"], check=True)
    lines = map(shlex.split, commands.replace("\\\n", " ").splitlines())
    return [words[1:] for words in lines if words[0] == "sculler"], fitted


def test_drive_as_the_page_tells_it(run: Run, page: tuple[list[list[str]], str]) -> None:
    """The commands of docs/tutorials/drive.md give its figures."""
    commands, fitted = page

    def follow(*extra: str) -> Any:
        for command in commands:
            words = command
            if words[0] == "convert":
                words = [*words, *extra]
            if words[0] == "navigate":
                words = [*words[: words.index("--report")], "--no-plots"]
            outcome = run(*words, "--json")
            assert outcome.status == 0, outcome.err
        return json.loads(outcome.out)

    said = follow()
    errors = said["errors"]
    assert said["seconds"] == pytest.approx(99.9)
    assert errors["attitude_arcsec"]["north"]["rms"] == pytest.approx(197, abs=1)
    assert errors["attitude_arcsec"]["east"]["rms"] == pytest.approx(65, abs=1)
    assert errors["attitude_arcsec"]["down"]["final"] == pytest.approx(875, abs=2)
    finals = {axis: found["final"] for axis, found in errors["velocity_m_s"].items()}
    assert finals["north"] == pytest.approx(2.87, abs=0.01)
    assert finals["east"] == pytest.approx(-0.09, abs=0.01)
    assert finals["down"] == pytest.approx(-0.21, abs=0.01)
    finals = {axis: found["final"] for axis, found in errors["position_m"].items()}
    assert finals["north"] == pytest.approx(142, abs=1)
    assert finals["east"] == pytest.approx(-4.5, abs=0.1)
    assert finals["down"] == pytest.approx(-12.5, abs=0.1)

    # a later option of the same name goes before the earlier
    errors = follow(*shlex.split(fitted))["errors"]
    assert errors["attitude_arcsec"]["down"]["rms"] == pytest.approx(35, abs=1)
    assert errors["position_m"]["horizontal"]["rms"] == pytest.approx(0.38, abs=0.02)
    assert errors["position_m"]["horizontal"]["final"] == pytest.approx(0.61, abs=0.02)


@pytest.mark.parametrize(
    ("algorithm", "options", "states"),
    [
        ("", [], 4_996),
        ('samples = 4\nposition = "high-resolution"', ["--third-order"], 2_493),
        pytest.param(
            *("samples = 4\nminors = 2\norder = 4", ["--height-damping", 60], 1_249),
            marks=pytest.mark.deep,
        ),
    ],
)
def test_drive_by_the_host_in_c(
    run: Run,
    page: tuple[list[list[str]], str],
    algorithm: str,
    options: list[object],
    states: int,
) -> None:
    """The states of 99.9 s on the move, and their telemetry, are Python's to the byte."""
    if shutil.which("gcc") is None:
        pytest.skip("needs gcc")
    (convert, *_), _ = page
    assert run(*convert).status == 0
    own, design = Path("mems.toml"), Path("other.toml")
    lines = own.read_text().splitlines()
    keys = [line.split()[0] for line in algorithm.splitlines()]
    kept = [line for line in lines if not line or line.split()[0] not in keys]
    design.write_text("\n".join([*kept, algorithm, ""]))
    assert run("model", design, "imu.csv", "-o", "vectors.csv").status == 0
    found = by_both_hosts(run, Path(), design, Path("vectors.csv"), "--truth", "fog.npz", *options)
    assert found == states
