"""`campaign`: many runs, their statistics, and the same results whoever does the work."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from math import pi, radians, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("pyarrow")

from sculler.runs.campaign import Campaign
from sculler.runs.campaign.engine import runs_together
from sculler.runs.campaign.flights import COLUMNS, fly
from sculler.runs.campaign.statistics import Statistics

Run = Callable[..., Any]
Refused = Callable[..., str]

SMALL = """\
runs = {runs}
seconds = 0.4
checkpoints = 4
[motion]
name = "turn"
[initial]
tilt_mrad = 1.0
position = 2.0
[[design]]
preset = "stim300"
label = "noisy"
errors = {{ preset = "stim300" }}
[[design]]
preset = "stim300"
label = "perfect"
"""


def campaign(folder: Path, text: str) -> Path:
    path = folder / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    return path


def results(folder: Path) -> dict[str, np.ndarray]:
    import pyarrow.parquet as pq

    table = pq.read_table(folder / "results.parquet")
    return {name: table[name].to_numpy() for name in COLUMNS}


@pytest.mark.parametrize("workers", [1, 2, 3, 16])
@pytest.mark.parametrize("runs", [1, 7, 40, 250, 1000])
def test_no_worker_has_more_to_do_than_another(runs: int, workers: int) -> None:
    """But for a run a batch, which cannot be parted."""
    together = runs_together(runs, workers)
    assert 1 <= together <= 50
    batches = -(-runs // together)
    rounds = -(-batches // workers)
    assert rounds * together <= -(-runs // workers) + rounds


def test_a_run_depends_on_its_seed_alone(tmp_path: Path) -> None:
    plan = Campaign.load(campaign(tmp_path, SMALL.format(runs=3)))
    together = fly(plan, 0, [1, 2, 3])
    alone = fly(plan, 0, [2])
    for name in COLUMNS:
        assert (together[name][4:8] == alone[name]).all(), name
    assert together["seed"].tolist() == [1] * 4 + [2] * 4 + [3] * 4
    assert together["time_s"][:4] == pytest.approx([0.1, 0.2, 0.3, 0.4])
    # the initial errors are those drawn: 1 mrad and 2 m, and unlike in each run
    position = together["position_north_m"].reshape(3, 4)
    assert 0.05 < np.abs(position[:, 0]).max() < 8
    assert len(set(position[:, 0].tolist())) == 3


def test_a_perfect_sensor_in_the_true_state_makes_no_error(tmp_path: Path) -> None:
    text = SMALL.format(runs=1).replace("tilt_mrad = 1.0\nposition = 2.0\n", "")
    found = fly(Campaign.load(campaign(tmp_path, text)), 1, [1])
    assert np.abs(found["position_north_m"]).max() < 5e-6  # counts
    assert np.abs(found["tilt_north_rad"]).max() < 1e-7


def test_the_height_is_held_to_the_true_one(tmp_path: Path) -> None:
    """In a climb a damped height strays, but not where a perfect barometer tells it."""
    down = {}
    for height in ("initial", "true"):
        text = SMALL.format(runs=1).replace('"turn"', '"flight"').replace('"stim300"', '"hg4930"')
        text = text.replace("tilt_mrad = 1.0\nposition = 2.0\n", "").replace("0.4", "200")
        text = text.replace('errors = { preset = "hg4930" }\n', "")
        damping = f'[navigator]\nheight_damping = 60.0\nheight = "{height}"\n[motion]'
        found = fly(Campaign.load(campaign(tmp_path, text.replace("[motion]", damping))), 1, [1])
        down[height] = float(np.abs(found["position_down_m"]).max())
    assert down["initial"] > 10
    assert down["true"] < 0.01


def test_it_goes_on_where_it_stopped_and_takes_more_runs(run: Run, tmp_path: Path) -> None:
    path, out = campaign(tmp_path, SMALL.format(runs=2)), tmp_path / "out"
    first = run("campaign", path, "-o", out, "--workers", 1, "--json")
    assert (first.status, first.err) == (0, "")
    said = json.loads(first.out)
    assert (said["flown_now"], set(said["designs"])) == (4, {"noisy", "perfect"})
    before = results(out)
    again = run("campaign", path, "-o", out, "--workers", 1, "--json")
    assert json.loads(again.out)["flown_now"] == 0
    assert (out / "growth.png").stat().st_size > 10_000

    campaign(tmp_path, SMALL.format(runs=5))
    lost = next((out / "parts").glob("0-1-*.parquet"))
    lost.unlink()
    more = json.loads(run("campaign", path, "-o", out, "--workers", 1, "--json").out)
    assert more["flown_now"] == 6 + int(lost.stem.split("-")[2])
    after = results(out)
    kept = after["seed"] <= 2
    for name in COLUMNS:
        assert (after[name][kept] == before[name]).all(), name
    told = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    assert told["designs"]["noisy"]["runs"] == 5

    text = SMALL.format(runs=5).replace("tilt_mrad = 1.0", "tilt_mrad = 1.5")
    campaign(tmp_path, text)
    other = run("campaign", path, "-o", out, "--workers", 1)
    assert other.status == 2
    assert "has results of another campaign, give another folder" in other.err


def test_what_would_be_flown(run: Run, tmp_path: Path) -> None:
    path = campaign(tmp_path, SMALL.format(runs=9))
    said = run("campaign", path, "-o", tmp_path / "out", "--dry-run", "--json")
    assert json.loads(said.out)["designs"] == {"noisy": 800, "perfect": 800}
    assert not (tmp_path / "out").exists()
    assert "9 of each, seeds from 1 on" in run("campaign", path, "-o", "out", "--dry-run").out


def test_quantiles_have_the_binomial_interval() -> None:
    """Of 100 runs the median lies between the 40th and the 61st with at least 95 % (Conover)."""
    end = np.arange(1.0, 101.0)
    zero = np.zeros(100)
    rows: dict[str, np.ndarray] = dict.fromkeys(COLUMNS, zero)
    rows |= {"seed": np.arange(100), "time_s": np.full(100, 3600.0), "position_north_m": end}
    found = Statistics.of(rows)
    assert found.horizontal[0.5] == (50.5, 40.0, 61.0)
    assert found.growth[0.5][0] == pytest.approx(50.5 / 1852)
    assert found.horizontal[0.95][0] == pytest.approx(95.05)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('name = "turn"', 'name = "turns"'), "motion: name: 'turns' is not known, give one of"),
        (('name = "turn"', ""), "motion: name, points: give one of them"),
        (("runs = 2", "runs = 0"), "runs: 0 is not allowed, give a whole number from 1 to 1e6"),
        (("runs = 2", "runs = " + "[" * 5000), "brackets too deep in each other"),
        (('label = "perfect"', 'label = "noisy"'), "two are called 'noisy', give each a label"),
        (("seconds = 0.4", "seconds = 0.001"), "hold no major interval of"),
        (('preset = "stim300" }', 'presett = "stim300" }'), "sensor.errors.presett"),
        (("[initial]", "[initials]"), "initials: unknown key, did you mean initial?"),
        (("runs = 2", "runs = "), "not valid TOML"),
    ],
)
def test_faults_are_told(run: Run, tmp_path: Path, change: tuple[str, str], said: str) -> None:
    path = campaign(tmp_path, SMALL.format(runs=2).replace(*change))
    outcome = run("campaign", path, "-o", tmp_path / "out", "--workers", 1)
    assert (outcome.status, outcome.out) == (2, "")
    assert said in outcome.err
    assert outcome.err.count("\n") == 1


@pytest.mark.deep
def test_a_gyro_s_bias_makes_schuler_s_growth(tmp_path: Path) -> None:
    """At rest on the equator: ε R (t - sin(Ω t)/Ω) north, from a bias ε of the east gyro."""
    text = """\
runs = 1
seconds = 1200
checkpoints = 6
[motion]
name = "rest"
parameters = { lat = 0.0, lon = 0.0, h = 0.0, heading = 0.0 }
[navigator]
height_damping = 60.0
[[design]]
preset = "hg4930"
errors = { gyro = { bias = [0.0, 0.01, 0.0] } }
"""
    found = fly(Campaign.load(campaign(tmp_path, text)), 0, [1])
    t, radius, gravity = found["time_s"], 6335439.3, 9.7803
    schuler = sqrt(gravity / radius)
    assert 2 * pi / schuler == pytest.approx(84.3 * 60, rel=0.01)
    drift = radians(0.01) / 3600
    expected = drift * radius * (t - np.array([sin(schuler * each) for each in t]) / schuler)
    assert np.abs(found["position_north_m"]) == pytest.approx(expected, rel=0.01, abs=0.02)
    assert np.abs(found["position_east_m"]).max() < 0.01 * expected[-1]


@pytest.mark.deep
def test_workers_and_a_scheduler_make_the_same_results(run: Run, tmp_path: Path) -> None:
    path = campaign(tmp_path, SMALL.format(runs=6))
    for folder, words in (("one", ("--workers", 1)), ("two", ("--workers", 2))):
        assert run("campaign", path, "-o", tmp_path / folder, *words, "--json").status == 0
    one, two = results(tmp_path / "one"), results(tmp_path / "two")
    for name in COLUMNS:
        assert (one[name] == two[name]).all(), name

    pytest.importorskip("distributed")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    note = tmp_path / "scheduler.json"
    options = ["--port", "0", "--no-dashboard", "--scheduler-file", str(note)]
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    started = [subprocess.Popen([*dask, *options], env=environment, **quiet)]
    try:
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--no-dashboard"]
        for _ in range(2):
            words = ["--scheduler-file", str(note), "--nthreads", "1"]
            started.append(subprocess.Popen([*worker, *words], env=environment, **quiet))
        for _ in range(600):
            if note.exists():
                break
            started[0].poll()
            import time

            time.sleep(0.1)
        address = json.loads(note.read_text(encoding="utf-8"))["address"]
        outcome = run("campaign", path, "-o", tmp_path / "far", "--scheduler", address, "--json")
        assert outcome.status == 0, outcome
    finally:
        for process in started:
            process.terminate()
        for process in started:
            process.wait(30)
    far = results(tmp_path / "far")
    for name in COLUMNS:
        assert (one[name] == far[name]).all(), name


RTL = SMALL.replace(
    '[[design]]\npreset = "stim300"\nlabel = "perfect"',
    '[[design]]\npreset = "hg4930"\nlabel = "perfect"',
)
HARDWARE = '[rtl]\nruns = 2\nengine = "amaranth"\nseconds = {seconds}\n[motion]'


def with_hardware(runs: int, seconds: float) -> str:
    """Few samples, for Amaranth's own simulator."""
    text = RTL.format(runs=runs).replace('preset = "stim300"\nlabel', 'preset = "hg4930"\nlabel')
    return text.replace("[motion]", HARDWARE.format(seconds=seconds))


def of_twin(change: Callable[[Any], Any]) -> Callable[..., Any]:
    """In place of the hardware, the twin with a change of its blocks."""
    from sculler_model.fast import FastModel

    def simulate(design: Any, chunks: Any, *options: Any) -> Any:
        model = FastModel(design)
        for counts, _ in chunks:
            yield change(model.feed(counts))

    return simulate


@pytest.mark.deep
def test_some_runs_go_through_the_hardware(run: Run, tmp_path: Path) -> None:
    """The counts of the run itself, with stalls, in Amaranth's own simulator."""
    path, out = campaign(tmp_path, with_hardware(5, 0.2)), tmp_path / "out"
    first = run("campaign", path, "-o", out, "--workers", 1)
    assert (first.status, first.err) == (0, "")
    assert "4 runs in amaranth: 20 results of 80 samples, every integer" in first.out


def test_which_runs_and_what_is_kept(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Evenly spread over the seeds; what is done is not done again."""
    from sculler.runs.campaign import hardware

    monkeypatch.setattr(hardware, "simulate", of_twin(lambda block: block))
    path, out = campaign(tmp_path, with_hardware(5, 0.2)), tmp_path / "out"
    assert run("campaign", path, "-o", out, "--workers", 1).status == 0
    said = json.loads((out / "summary.json").read_text(encoding="utf-8"))["rtl"]
    assert said["identical"]
    seeds = [(held["design"], held["seed"]) for held in said["runs"]]
    assert seeds == [("noisy", 1), ("noisy", 5), ("perfect", 1), ("perfect", 5)]
    assert {(held["samples"], held["results"]) for held in said["runs"]} == {(20, 5)}
    notes = {note: note.stat().st_mtime_ns for note in (out / "parts").glob("rtl-*.json")}
    assert len(notes) == 4
    campaign(tmp_path, with_hardware(5, 0.2).replace("runs = 2", "runs = 3"))
    more = json.loads(run("campaign", path, "-o", out, "--workers", 1, "--json").out)
    assert [held["seed"] for held in more["rtl"]["runs"]] == [1, 3, 5] * 2
    for note, time in notes.items():
        assert note.stat().st_mtime_ns == time
    dry = json.loads(run("campaign", path, "-o", out, "--dry-run", "--json").out)
    assert dry["rtl_seeds"] == [1, 3, 5]


def test_hardware_that_differs_fails(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bit of one accumulator, and a result that never comes."""
    from sculler.runs.campaign import hardware
    from sculler_model.design import Design
    from sculler_model.fast import VectorBlock

    def broken(block: Any) -> Any:
        rows = [list(row) for row in block.rows()]
        rows[1][5] ^= 4
        return VectorBlock.from_rows([tuple(row) for row in rows], Design.preset("hg4930"))

    cases = ((broken, "major 1 (row 1)"), (lambda block: block[:-1], "lacks the last 1 result"))
    for number, (change, words) in enumerate(cases):
        monkeypatch.setattr(hardware, "simulate", of_twin(change))
        path = campaign(tmp_path, with_hardware(1, 0.2))
        outcome = run("campaign", path, "-o", tmp_path / str(number), "--workers", 1)
        assert outcome.status == 1
        assert words in " ".join(outcome.out.split())
        assert "seed 1 of noisy" in " ".join(outcome.out.split())


def test_the_hardware_does_not_change_what_is_flown(tmp_path: Path) -> None:
    plain = Campaign.load(campaign(tmp_path, RTL.format(runs=4)))
    more = Campaign.load(campaign(tmp_path, RTL.format(runs=4) + "[rtl]\nruns = 9\n"))
    assert plain.digest == more.digest
    assert (plain.rtl_seeds, more.rtl_seeds) == ([], [1, 2, 3, 4])
