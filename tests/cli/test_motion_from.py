"""`motion --from`: logs and truths of a motion through the points of a file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.truth import read_truth
from sculler_model.frames import earth_fixed
from sculler_model.navigation import NavHistory

Run = Callable[..., Any]
Refused = Callable[..., str]

ORIGIN = (np.radians(40.0), np.radians(-75.0), 100.0)


def way_points(folder: Path, header: str, rows: np.ndarray) -> Path:
    path = folder / "points.csv"
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.12g")
    return path


def circle(many: int = 13) -> tuple[np.ndarray, ...]:
    """Time, north, east, up of a climbing circle of 200 m."""
    time = 100.0 + 0.5 * np.arange(many)
    turned = 0.1 * (time - 100.0)
    return time, 200 * np.sin(turned), 200 * (1 - np.cos(turned)), 2 * turned


def made(run: Run, folder: Path, *words: object) -> tuple[NavHistory, dict]:
    truth = folder / "truth.csv"
    outcome = run(
        *("motion", *words, "--design", "stim300", "-o", folder / "imu.csv"),
        *("--truth", truth, "--json"),
    )
    assert (outcome.status, outcome.err) == (0, ""), outcome
    return NavHistory.concatenate(list(read_truth(truth))), json.loads(outcome.out)


def test_metres_in_a_plane_and_earth_fixed_are_the_same_way(run: Run, tmp_path: Path) -> None:
    time, north, east, up = circle()
    rows = np.column_stack((time, north, east, up))
    path = way_points(tmp_path, "time_s,north_m,east_m,up_m", rows)
    place = ("--lat", 40, "--lon", -75, "--height", 100)
    first, said = made(run, tmp_path, "--from", path, *place)
    assert (said["points"], said["first_point_s"], said["seconds"]) == (13, 100.0, 6.0)
    assert said["attitude"] == "along the way"
    assert Path(said["plots"][0]).stat().st_size > 20_000

    # the same places, by the plane's axes in Earth axes
    lat, lon, _ = ORIGIN
    x0 = np.array(earth_fixed(*(np.array(value) for value in ORIGIN)))
    n = np.array([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)])
    e = np.array([-np.sin(lon), np.cos(lon), 0.0])
    u = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    fixed = x0 + north[:, None] * n + east[:, None] * e + up[:, None] * u
    path = way_points(tmp_path, "time_s,x_m,y_m,z_m", np.column_stack((time, fixed)))
    second, said = made(run, tmp_path, "--from", path, "--no-plots")
    assert "plots" not in said
    assert second.h == pytest.approx(first.h, abs=1e-4)  # twelve digits in the file
    assert 6.4e6 * np.abs(second.lat - first.lat).max() < 1e-4
    assert np.abs(second.v - first.v).max() < 1e-3


def test_the_navigated_result_returns_to_the_points(run: Run, tmp_path: Path) -> None:
    """A truth's own file as points: motion, model, navigate, and back at the points."""
    motion = ("motion", "turn", "--design", "stim300", "--duration", 5, "--truth-every", 0.1)
    given, log = tmp_path / "given.csv", tmp_path / "imu.csv"
    run(*motion, "-o", log, "--truth", given)
    states = NavHistory.concatenate(list(read_truth(given)))
    _, said = made(run, tmp_path, "--from", given, "--smoothness", 4)
    assert said["attitude"] == "of the points"
    vectors, out = tmp_path / "v.csv", tmp_path / "n.csv"
    run("model", "stim300", log, "-o", vectors)
    place = ("--truth", tmp_path / "truth.csv")
    outcome = run("navigate", "stim300", vectors, "-o", out, "--no-plots", "--json", *place)
    assert outcome.status == 0, outcome
    found = NavHistory.concatenate(list(read_truth(out)))
    at = np.searchsorted(found.time, states.time - states.time[0] - 1e-6)
    inside = at < len(found.time)
    apart = 6.4e6 * np.hypot(
        found.lat[at[inside]] - states.lat[inside],
        (found.lon[at[inside]] - states.lon[inside]) * np.cos(states.lat[inside]),
    )
    assert apart.max() < 1e-4


def test_points_of_a_parquet_file_shaken(run: Run, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    given = tmp_path / "given.parquet"
    motion = ("motion", "flight", "--design", "stim300", "--duration", 5, "--truth-every", 0.01)
    run(*motion, "-o", tmp_path / "a.csv", "--truth", given)
    words = ("--from", given, "--spacing", 0.5, "--vibration", 0.1, "--no-plots")
    _, said = made(run, tmp_path, *words)
    assert said["points"] == 11
    assert said["vibration"]["g_rms"] == 0.1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "no motion is given, give one of rest,"),
        (("rest", "--from", "{way}"), "--from and the motion rest: give one of them"),
        (("rest", "--spacing", 1), "--spacing and the motion rest: give one of them"),
        (("--from", "{way}", "--speed", 3), "--speed does not belong to a motion through points"),
        (("--from", "{way}", "--lat", 3), "tells places itself, leave it out"),
        (("--from", "{way}", "--duration", 99), "ends 4 s after its first point, give at most"),
        (("--from", "{none}"), "no place is there, add lat_deg,lon_deg,height_m or"),
        (("--from", "{one}"), "1 point makes no curve, give two points at least"),
        (("--from", "{far}"), "line 3: x_m,y_m,z_m is -6.37"),
    ],
)
def test_what_is_refused(refused: Refused, tmp_path: Path, words: tuple, said: str) -> None:
    files = {
        "way": "time_s,lat_deg,lon_deg,height_m\n0,40,9,0\n2,40.001,9,0\n4,40.002,9,0\n",
        "none": "time_s,roll_deg,pitch_deg,heading_deg\n0,0,0,0\n1,0,0,0\n",
        "one": "time_s,lat_deg,lon_deg,height_m\n0,40,9,0\n",
        "far": "time_s,x_m,y_m,z_m\n0,6378137,0,0\n1,6378,0,0\n",
    }
    names = {}
    for name, text in files.items():
        names[name] = tmp_path / f"{name}.csv"
        names[name].write_text(text)
    filled = [str(word).format(**names) for word in words]
    outputs = ("-o", tmp_path / "imu.csv", "--truth", tmp_path / "truth.csv")
    assert said in refused("motion", *filled, "--design", "stim300", *outputs)
    assert not (tmp_path / "imu.csv").exists()
