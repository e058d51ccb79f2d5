"""What the verbs do, called as a library: no command line, nothing printed."""

from __future__ import annotations

import subprocess
import sys
from math import degrees, radians
from pathlib import Path

import numpy as np
import pytest

from sculler.formats.log import LogWriter
from sculler.runs.conversion import Layout, convert_log
from sculler.runs.conversion import Plan as ConversionPlan
from sculler.runs.counts import WITHOUT_NUMBA, model_log, simulate_log
from sculler.runs.demo import run_demo
from sculler.runs.navigation import Carrier, Given, Plan, navigate_file
from sculler_model.design import Design
from sculler_model.errors import ContradictionError, InputError
from sculler_model.fast import model as fast
from sculler_model.frames import AxisMap
from sculler_model.motion import at_rest
from sculler_model.samples import Quantiser
from sculler_sim.stimulus import Stimulus

LEVEL = (None, None, None)


@pytest.fixture(autouse=True)
def quiet(capfd: pytest.CaptureFixture[str]) -> object:
    """No run function prints."""
    yield
    assert capfd.readouterr() == ("", "")


def test_runs_need_no_command_line() -> None:
    script = (
        "import sys, sculler.runs.counts, sculler.runs.conversion, sculler.runs.navigation,"
        " sculler.runs.demo, sculler.runs.coefficients, sculler.runs.hardware,"
        " sculler.runs.placing; print(sorted({'click', 'rich'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "[]\n", "")


def test_the_room_itself_loads_nothing() -> None:
    script = "import sys, sculler.runs; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout == "False\n"


def test_counts_by_model_and_hardware(tmp_path: Path, design: Path, log: Path) -> None:
    """27 samples of six a major interval: four results, three samples over."""
    little = Design.load(design)
    model, rtl = tmp_path / "model.csv", tmp_path / "rtl.csv"
    read: list[int] = []
    modelled = model_log(little, log, model, "fast", read.append)
    header = log.read_bytes().index(b"\n") + 1
    assert sum(read) == log.stat().st_size - header
    simulated = simulate_log(
        little, log, rtl, "amaranth", Stimulus.always(), None, lambda amount: None
    )
    assert model.read_bytes() == rtl.read_bytes()
    for summary in (modelled, simulated):
        assert (summary.samples, summary.results, summary.left_out) == (27, 4, 3)
    assert modelled.clocks is None
    assert simulated.clocks is not None
    assert simulated.clocks >= 27


def test_convert_carries_the_remainder(tmp_path: Path, design: Path) -> None:
    """A quarter of an LSB for 40 samples is ten LSB, and never far from the running sum."""
    little, source, out = Design.load(design), tmp_path / "in.csv", tmp_path / "out.csv"
    quarter = 0.25 * little.sensor.gyro.lsb
    rows = [f"{quarter!r},0,0,0,0,{-9.8e-3!r}"] * 40
    source.write_text("\n".join(["wx,wy,wz,ax,ay,az", *rows]) + "\n")
    layout = Layout("wx,wy,wz", "ax,ay,az", gyro_unit="rad", accel_unit="m/s")
    outcome = convert_log(ConversionPlan(little, source, layout=layout), out)
    counts = np.loadtxt(out, delimiter=",", skiprows=1, dtype=int)
    assert counts[:, 0].sum() == pytest.approx(10, abs=0.5)
    sums = np.cumsum(counts[:, 0]) - 0.25 * np.arange(1, 41)
    assert np.abs(sums).max() <= 0.5 + 1e-9
    assert (counts[:, 5] == -98).all()
    data = outcome.as_json()
    assert (data["samples"], data["format"], data["output"]) == (40, "csv", str(out))
    assert data["warnings"] == outcome.warnings


def test_convert_refuses_what_does_not_go_together(tmp_path: Path, design: Path) -> None:
    with pytest.raises(ContradictionError, match="--max-gap goes with --gaps bridge"):
        ConversionPlan(Design.load(design), tmp_path / "in.csv", max_gap=2.0)


@pytest.fixture
def resting(tmp_path: Path) -> Path:
    """Vectors of two seconds at rest and level, heading north, at 48° N, 11° E, 500 m."""
    design, log, out = Design.preset("stim300"), tmp_path / "rest_log.csv", tmp_path / "rest.csv"
    motion, quantise = at_rest(radians(48), radians(11), 500, 0, 0, 0), Quantiser(design)
    with LogWriter(log) as writer:
        for chunk in motion.chunks("increment", 4000, design.sample_interval):
            writer.write(quantise(chunk))
    model_log(design, log, out, "fast", lambda amount: None)
    return out


def test_navigate_at_rest(tmp_path: Path, resting: Path) -> None:
    place = (radians(48), radians(11), 500.0)
    plan = Plan(
        *(Design.preset("stim300"), str(resting), Given(LEVEL, LEVEL, place), Carrier()),
        AxisMap.parse("x,y,z"),
    )
    went: list[int] = []
    out = tmp_path / "nav.csv"
    outcome = navigate_file(plan, out, pictures=False, advance=went.append)
    assert sum(went) == 200  # results, of 20 samples each
    assert len(out.read_text().splitlines()) == 1 + 1 + 200
    assert outcome.end.time - outcome.start.time == pytest.approx(2.0)
    # at rest, a count's remainder in each increment is all that moves it
    assert degrees(outcome.end.lat) == pytest.approx(48, abs=1e-8)
    assert outcome.end.h == pytest.approx(500, abs=1e-3)
    assert outcome.pictures is None
    assert outcome.errors is None
    assert outcome.as_json()["warnings"] == outcome.warnings == []


def test_navigate_needs_a_place(tmp_path: Path, resting: Path) -> None:
    plan = Plan(
        *(Design.preset("stim300"), str(resting), Given(LEVEL, LEVEL, LEVEL), Carrier()),
        AxisMap.parse("x,y,z"),
    )
    out = tmp_path / "nav.csv"
    with pytest.raises(InputError, match="--lat: missing"):
        navigate_file(plan, out, pictures=False)
    assert not out.exists()


def test_demo_tells_its_steps(tmp_path: Path) -> None:
    told: dict[str, float] = {}
    outcome = run_demo(tmp_path / "demo", 1.0, pictures=False, done=told.__setitem__)
    assert told == outcome.steps_s
    assert list(told)[-1] == "navigation"
    assert outcome.identical
    assert outcome.navigation_identical
    # 1 s of 2,000 Hz, 20 samples a major interval
    assert (outcome.samples, outcome.majors) == (2000, 100)
    assert outcome.pictures == []


def test_a_long_run_without_numba_says_so_once(
    tmp_path: Path, design: Path, log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    little = Design.load(design)
    monkeypatch.setattr(fast, "kernel_class", lambda: None)
    for worth, told in ((27, 1), (28, 0)):
        monkeypatch.setattr(fast, "WORTH_COMPILING", worth)
        done = model_log(little, log, tmp_path / "model.csv", "fast", lambda amount: None)
        assert done.warnings.count(WITHOUT_NUMBA) == told
        assert done.samples == 27
