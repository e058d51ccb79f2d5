"""`navigate`: from vectors to a track, a table and pictures."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import cos, radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.history import Thinned
from sculler.formats.log import LogWriter
from sculler.plots import pictures as plots
from sculler_model.design import Design
from sculler_model.motion import Motion, at_rest, turn_motion
from sculler_model.navigation import NavHistory
from sculler_model.samples import Quantiser

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 48, "--lon", 11, "--height", 500)
COLUMNS = (
    "time_s,q_w,q_x,q_y,q_z,roll_deg,pitch_deg,heading_deg,"
    "v_north,v_east,v_down,lat_deg,lon_deg,height_m,wander_deg"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("vectors")


def vectors(run: Run, folder: Path, name: str, motion: Motion, seconds: float) -> Path:
    """The motion's vectors by way of `model`, STIM300."""
    design = Design.preset("stim300")
    log, out = folder / f"{name}_log.csv", folder / f"{name}.csv"
    quantise = Quantiser(design)
    with LogWriter(log) as writer:
        samples = round(seconds * design.sensor.sample_rate_hz)
        for chunk in motion.chunks("increment", samples, design.sample_interval):
            writer.write(quantise(chunk))
    assert run("model", "stim300", log, "-o", out).status == 0
    return out


@pytest.fixture
def resting(run: Run, folder: Path) -> Path:
    """120 s at rest, roll 2°, pitch -3°, heading 130°."""
    tilted = at_rest(radians(48), radians(11), 500, radians(2), radians(-3), radians(130))
    out = folder / "rest.csv"
    return out if out.exists() else vectors(run, folder, "rest", tilted, 120)


def table(path: Path) -> list[dict[str, float]]:
    with path.open() as file:
        return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def test_at_rest_it_stays(run: Run, tmp_path: Path, resting: Path) -> None:
    out = tmp_path / "nav.csv"
    attitude = ("--roll", 2, "--pitch", -3, "--heading", 130)
    outcome = run("navigate", "stim300", resting, "-o", out, *PLACE, *attitude, "--json")
    assert (outcome.status, outcome.err) == (0, "")
    assert out.read_text().splitlines()[0] == COLUMNS
    rows = table(out)
    assert len(rows) == 12_001
    assert [rows[0]["time_s"], rows[-1]["time_s"]] == [0, pytest.approx(120, abs=1e-9)]
    last = rows[-1]
    for name, value in (("roll_deg", 2), ("pitch_deg", -3), ("heading_deg", 130)):
        assert last[name] == pytest.approx(value, abs=1e-5)
    assert abs(last["lat_deg"] - 48) < 1e-7
    assert abs(last["lon_deg"] - 11) < 1e-7
    assert abs(last["height_m"] - 500) < 0.01
    said = json.loads(outcome.out)
    assert said["seconds"] == pytest.approx(120)
    assert said["moved_horizontally_m"] < 0.01
    assert said["plots"] == [str(out.with_suffix(".png"))]
    assert out.with_suffix(".png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("start", [(), ("--start", 30), ("--align", 60)])
def test_progress_goes_from_the_first_result_to_the_last(
    run: Run,
    tmp_path: Path,
    resting: Path,
    monkeypatch: pytest.MonkeyPatch,
    start: tuple[object, ...],
) -> None:
    seen: list[int | None] = []

    @contextmanager
    def progress(description: str, total: int | None) -> Iterator[Callable[[int], None]]:
        seen.append(total)
        yield seen.append

    monkeypatch.setattr("sculler.terminal.progress", progress)
    words = ("-o", tmp_path / "nav.csv", *PLACE, "--no-plots", *start)
    assert run("navigate", "stim300", resting, *words).status == 0
    total, *amounts = seen
    assert total == sum(filter(None, amounts)) == 12_000


def test_alignment_finds_the_attitude(run: Run, tmp_path: Path, resting: Path) -> None:
    out = tmp_path / "nav.csv"
    outcome = run(
        *("navigate", "stim300", resting, "-o", out, *PLACE, "--align", 60, "--no-plots", "--json")
    )
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    assert said["start_s"] == pytest.approx(60)
    assert said["seconds"] == pytest.approx(60)
    assert said["start_attitude_deg"]["roll"] == pytest.approx(2, abs=1e-4)
    assert said["start_attitude_deg"]["pitch"] == pytest.approx(-3, abs=1e-4)
    assert said["start_attitude_deg"]["heading"] == pytest.approx(130, abs=0.01)
    assert said["alignment"]["rate_deg_per_h"] == pytest.approx(15.041, abs=0.002)
    assert not out.with_suffix(".png").exists()
    assert len(table(out)) == 6001


def test_axes_of_a_unit_mounted_right_forward_up(run: Run, tmp_path: Path, resting: Path) -> None:
    """The same unit seen through other axes: right, forward, up of the body are its x, y, z."""
    swapped = tmp_path / "swapped.csv"
    lines = resting.read_text().splitlines()
    rows = [lines[0]]
    for line in lines[1:]:
        cells = line.split(",")
        for first in range(2, 20, 3):
            x, y, z = cells[first : first + 3]
            cells[first : first + 3] = [y, x, z.removeprefix("-") if z[0] == "-" else f"-{z}"]
        rows.append(",".join(cells))
    swapped.write_text("\n".join(rows) + "\n")
    outs = tmp_path / "a.csv", tmp_path / "b.csv"
    words = (*PLACE, "--align", 60, "--no-plots")
    assert run("navigate", "stim300", resting, "-o", outs[0], *words).status == 0
    outcome = run("navigate", "stim300", swapped, "-o", outs[1], *words, "--axes", "y,x,-z")
    assert outcome.status == 0, outcome.err
    assert outs[0].read_text() == outs[1].read_text()


def test_turning_vehicle_and_what_is_said(run: Run, tmp_path: Path, folder: Path) -> None:
    motion = turn_motion(speed=20.0, turn_rate=radians(9), bank=0.0)
    path = vectors(run, folder, "turn", motion, 10)
    out = tmp_path / "nav.csv"
    outcome = run(
        *("navigate", "stim300", path, "-o", out, *PLACE, "--vn", 20, "--no-plots"),
    )
    assert outcome.status == 0, outcome.err
    last = table(out)[-1]
    # a quarter circle: from north to east, one radius of 20 / radians(9) m in both directions
    radius = 20 / radians(9)
    assert last["heading_deg"] == pytest.approx(90, abs=1e-4)
    assert last["v_east"] == pytest.approx(20, abs=1e-3)
    assert last["v_north"] == pytest.approx(0, abs=2e-3)
    # metres of a degree at 48° on WGS-84: 111,200 north, and 111,320 cos(lat) by the parallel
    assert (last["lat_deg"] - 48) * 111_200 == pytest.approx(radius, rel=1e-3)
    assert (last["lon_deg"] - 11) * 111_320 * cos(radians(48)) == pytest.approx(radius, rel=3e-3)
    assert "heading change" in outcome.out
    assert str(out) in outcome.out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--lat", 48, "--lon", 11), "Missing option '--height'"),
        ((*PLACE, "--align", 60, "--heading", 3), "--heading and --align contradict"),
        ((*PLACE, "--align", 60, "--vn", 0), "--vn and --align contradict"),
        ((*PLACE, "--align", 121), "121 s are more than the 120 s of vectors"),
        ((*PLACE, "--align", 0.5), "too short"),
        ((*PLACE, "--align", -5), "give a finite number > 0"),
        ((*PLACE, "--align", "nan"), "give a finite number"),
        ((*PLACE, "--roll", "inf"), "give a finite number"),
        ((*PLACE, "--axes", "x,y"), "give each of x, y, z once"),
        ((*PLACE, "--axes", "y,x,z"), "mirror image"),
        (("--lat", 91, "--lon", 11, "--height", 0), "latitude 91"),
        (("--lat", 48, "--lon", 400, "--height", 0), "longitude 400"),
    ],
)
def test_faults(
    tmp_path: Path, refused: Refused, resting: Path, options: tuple[object, ...], message: str
) -> None:
    words = ("navigate", "stim300", resting, "-o", tmp_path / "nav.csv")
    assert message in refused(*words, *options)


def test_wrong_vectors(tmp_path: Path, refused: Refused, resting: Path, log: Path) -> None:
    words = ("-o", tmp_path / "nav.csv", *PLACE)
    assert "cannot read" in refused("navigate", "stim300", tmp_path / "absent.csv", *words)
    assert "header" in refused("navigate", "stim300", log, *words)
    for value in ("nan", "inf", "1.5", ""):
        lines = resting.read_text().splitlines()
        lines[7] = ",".join([*lines[7].split(",")[:2], value, *lines[7].split(",")[3:]])
        wrong = tmp_path / "wrong.csv"
        wrong.write_text("\n".join(lines) + "\n")
        line = refused("navigate", "stim300", wrong, *words)
        assert f"{wrong}: line 8: " in line
        assert "alpha_x" in line
    nothing = tmp_path / "nothing.csv"
    nothing.write_text(resting.read_text().splitlines()[0] + "\n")
    assert "no results to navigate with" in refused("navigate", "stim300", nothing, *words)
    assert "0 s of vectors" in refused("navigate", "stim300", nothing, *words, "--align", 10)
    cut = tmp_path / "cut.csv"
    cut.write_text(resting.read_text()[:-4])
    assert "cut short" in refused("navigate", "stim300", cut, *words)


def test_without_matplotlib_the_work_is_done_and_the_pictures_are_left_out(
    run: Run, tmp_path: Path, resting: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ("navigate", "stim300", resting, "-o", tmp_path / "nav.csv", *PLACE)
    assert run(*words, "--no-plots").status == 0
    expected = (tmp_path / "nav.csv").read_bytes()
    (tmp_path / "nav.csv").unlink()
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    outcome = run(*words)
    assert (outcome.status, outcome.err) == (0, "")
    assert outcome.out.count("pip install 'sculler[plots]'") == 1
    assert (tmp_path / "nav.csv").read_bytes() == expected
    assert not list(tmp_path.glob("*.png"))
    assert "sculler[plots]" not in run(*words, "--no-plots").out


def test_same_data_same_picture(tmp_path: Path) -> None:
    history = turn_motion().state(np.linspace(0, 10, 100))
    files = [
        plots.navigation_pictures(history, tmp_path / name)[0].read_bytes()
        for name in ("a.csv", "b.csv")
    ]
    assert files[0] == files[1]


@pytest.mark.parametrize("sizes", [[1000], [1] * 1000, [7, 0, 300, 1, 692]])
def test_thinned_history_is_even_and_ends_with_the_end(sizes: list[int]) -> None:
    def parts() -> Iterator[NavHistory]:
        first = 0
        for size in sizes:
            t = np.arange(first, first + size, dtype=float)
            yield NavHistory(t, np.ones((size, 4)), np.zeros((size, 3)), t, t, t)
            first += size

    thinned = Thinned(most=100)
    for part in parts():
        thinned.add(part)
    time = thinned.history().time
    assert 50 <= len(time) <= 101
    assert time[0] == 0
    assert time[-1] == 999
    assert set(np.diff(time[:-1])) == {16.0}
