"""`navigate --truth`: errors against what `motion` wrote, pictures, the page; and bad truths."""

from __future__ import annotations

import base64
import json
import re
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from math import degrees, pi, radians, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from fine_sensor import fine_design_file
from sculler.formats.history import HEADER, HistoryWriter
from sculler.formats.truth import read_truth
from sculler.formats.truth_columns import BLOCK
from sculler.plots.truth import from_above
from sculler_model.frames import gravity, radii
from sculler_model.motion import great_circle, hour_flight, over_the_pole
from sculler_model.navigation import NavHistory
from tiers import few_of

Run = Callable[..., Any]
Refused = Callable[..., str]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("truth")


def flown(run: Run, folder: Path, name: str, toml: Path, *options: object) -> tuple[Path, Path]:
    """Vectors and truth of a motion, by way of its log and `model`."""
    log, truth, vectors = (folder / f"{name}_{what}.csv" for what in ("log", "truth", "vectors"))
    if not vectors.exists():
        words = ("motion", name, "--design", toml, "-o", log, "--truth", truth, *options)
        outcome = run(*words)
        assert outcome.status == 0, outcome
        assert run("model", toml, log, "-o", vectors).status == 0
    return vectors, truth


@pytest.fixture
def turn(run: Run, folder: Path) -> tuple[Path, Path, Path]:
    """20 s of a coordinated turn at 100 Hz: design, vectors, truth at 20 Hz."""
    toml = fine_design_file(folder, 2, 5)
    return (toml, *flown(run, folder, "turn", toml, "--duration", 20, "--truth-every", 0.05))


def navigated(run: Run, toml: Path, vectors: Path, out: Path, *options: object) -> dict[str, Any]:
    outcome = run("navigate", toml, vectors, "-o", out, "--no-plots", "--json", *options)
    assert outcome.status == 0, outcome
    said: dict[str, Any] = json.loads(outcome.out)
    return said


def test_a_run_from_its_truth_on_has_next_to_no_errors(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, truth = turn
    said = navigated(run, toml, vectors, tmp_path / "nav.csv", "--truth", truth)
    errors = said["errors"]
    assert (errors["instants"], errors["interpolated"]) == (401, 0)
    assert errors["attitude_arcsec"]["total"]["max"] < 1e-3
    assert errors["velocity_m_s"]["total"]["max"] < 1e-4
    assert errors["position_m"]["horizontal"]["max"] < 1e-3
    assert said["start_attitude_deg"]["roll"] == pytest.approx(
        degrees(np.arctan2(30 * radians(6), 9.81)), abs=1e-9
    )


def test_an_error_put_into_the_start_is_found(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, truth = turn
    out = tmp_path / "nav.csv"
    words = ("--truth", truth, "--ve", 0.5, "--height", 510)
    errors = navigated(run, toml, vectors, out, *words)["errors"]
    east, down = errors["velocity_m_s"]["east"], errors["position_m"]["down"]
    assert east["final"] == pytest.approx(0.5, rel=1e-3)
    assert east["rms"] == pytest.approx(0.5, rel=1e-3)
    assert errors["position_m"]["east"]["final"] == pytest.approx(10, rel=1e-3)
    assert down["final"] == pytest.approx(-10, abs=0.02)
    # it goes in a straight line: 0.5 m/s are 1800 m an hour
    assert errors["horizontal_growth_nmi_per_h"] == pytest.approx(1800 / 1852, rel=1e-3)


@pytest.mark.deep
def test_what_is_said_and_drawn(run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]) -> None:
    toml, vectors, truth = turn
    out, page = tmp_path / "nav.csv", tmp_path / "run.html"
    words = ("navigate", toml, vectors, "-o", out, "--truth", truth, "--report", page)
    outcome = run(*words)
    assert outcome.status == 0, outcome
    for text in ("errors against the truth", "tilt about east", "arcsec", "nautical miles an hour"):
        assert text in outcome.out
    pictures = [out.with_name(f"nav{name}.png") for name in ("", "_errors", "_growth", "_track")]
    for picture in pictures:
        assert picture.read_bytes().startswith(b"\x89PNG")
    assert {path.name for path in tmp_path.iterdir()} == {
        "nav.csv",
        "run.html",
        *(picture.name for picture in pictures),
    }
    text = page.read_text(encoding="utf-8")
    shown = re.findall(r'src="data:image/png;base64,([^"]*)"', text)
    assert [base64.b64decode(data) for data in shown] == [path.read_bytes() for path in pictures]
    _Page(text).check()
    assert "frequency-taylor" in text  # the design
    assert '<td class="name">--mechanisation</td><td>wander</td>' in text
    assert "-0.0000" not in text
    assert "tilt about east" in text
    assert f"{truth}" in text


class _Page(HTMLParser):
    """Every element closed, nothing loaded from outside."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag not in ("link", "script", "iframe")
        for name, value in attrs:
            if name in ("src", "href"):
                assert value is not None
                assert value.startswith("data:")
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def check(self) -> None:
        assert self.open == []


def test_a_page_without_truth_and_with_warnings(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, _ = turn
    faulty, page = tmp_path / "a&b.csv", tmp_path / "run.html"
    lines = vectors.read_text().splitlines()
    cells = lines[7].split(",")
    lines[7] = ",".join([cells[0], "2", *cells[2:]])
    faulty.write_text("\n".join(lines) + "\n")
    words = ("--lat", 48, "--lon", 11, "--height", 500, "--report", page)
    said = navigated(run, toml, faulty, tmp_path / "nav.csv", *words)
    assert said["fault_results"] == 1
    text = page.read_text(encoding="utf-8")
    _Page(text).check()
    assert "1 result with faulty samples" in text
    assert "a&amp;b.csv" in text
    assert "a&b.csv" not in text
    assert "<img" not in text
    assert "arcsec" not in text


def test_without_matplotlib(
    run: Run,
    tmp_path: Path,
    turn: tuple[Path, Path, Path],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    toml, vectors, truth = turn
    words = ("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--truth", truth)
    page = tmp_path / "run.html"
    assert run(*words, "--report", page).status == 0
    text = page.read_text()
    assert "tilt about north" in text
    assert "pip install &#x27;sculler[plots]&#x27;" in text
    assert "<img" not in text


def test_start_at_a_later_time(run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]) -> None:
    toml, vectors, truth = turn
    said = navigated(run, toml, vectors, tmp_path / "n.csv", "--truth", truth, "--start", 12.5)
    assert (said["start_s"], said["seconds"]) == pytest.approx((12.5, 7.5))
    assert said["errors"]["instants"] == 151
    assert said["errors"]["position_m"]["horizontal"]["max"] < 1e-3
    # a truth that begins later says itself where
    later = tmp_path / "later.csv"
    lines = truth.read_text().splitlines(keepends=True)
    later.write_text("".join([lines[0], *lines[251:]]))
    same = navigated(run, toml, vectors, tmp_path / "n.csv", "--truth", later)
    assert same["errors"]["position_m"] == said["errors"]["position_m"]


def test_schuler_oscillation_over_three_hours(run: Run, tmp_path: Path, folder: Path) -> None:
    """At rest on the equator with 0.01° of pitch error: north swings as a pendulum of Earth's size.

    The error stands still in inertial space, so the Earth turns it from east towards down:
    x'' + ω² x = -g θ cos Ωt with ω² = g/R, R the meridian's radius, and from rest
    x = -R θ (cos Ωt - cos ωt)/(1 - Ω²/ω²); nearly twice round in three hours.
    """
    toml = fine_design_file(folder, 2, 5, rate=10.0)
    options = ("--duration", 10_800, "--lat", 0, "--truth-every", 10)
    vectors, truth = flown(run, folder, "rest", toml, *options)
    out = tmp_path / "nav.csv"
    words = ("--truth", truth, "--pitch", 0.01, "--height-damping", 100)
    errors = navigated(run, toml, vectors, out, *words)["errors"]
    nav = NavHistory.concatenate(list(read_truth(out)))
    radius, earth = float(radii(0.0)[0]) + 500, 7.292115e-5
    omega = sqrt(float(gravity(0.0, 500.0)) / radius)
    assert 2 * pi / omega / 60 == pytest.approx(84.4, abs=0.2)
    swing = np.cos(earth * nav.time) - np.cos(omega * nav.time)
    expected = -radius * radians(0.01) * swing / (1 - (earth / omega) ** 2)
    assert np.abs(nav.lat * radius - expected).max() < 1e-3 * np.abs(expected).max()
    assert errors["position_m"]["horizontal"]["max"] == pytest.approx(
        np.abs(expected).max(), rel=1e-3
    )
    assert errors["attitude_arcsec"]["east"]["max"] == pytest.approx(36, rel=1e-2)


def test_round_trip(tmp_path: Path) -> None:
    truth = hour_flight(radians(48), radians(179.9), 500.0).state(np.linspace(0, 3000, 101))
    path = tmp_path / "truth.csv"
    with HistoryWriter(path) as writer:
        writer.write(truth)
    back = NavHistory.concatenate(list(read_truth(path)))
    assert np.array_equal(back.time, truth.time)
    assert np.array_equal(back.v, truth.v)
    assert np.array_equal(back.h, truth.h)
    assert np.abs(back.q - truth.q).max() < 3e-16
    assert np.abs(back.lat - truth.lat).max() < 3e-16
    assert np.abs(back.lon - truth.lon).max() < 1e-15


def test_other_orders_euler_angles_and_other_columns(tmp_path: Path) -> None:
    path = tmp_path / "reference.csv"
    path.write_text(
        "name,height_m,lat_deg,lon_deg,v_north,v_east,v_down,roll_deg,pitch_deg,heading_deg,time_s\n"
        "a,100,48,190,1,2,3,10,20,-30,5\n"
        "b,101,48,190,1,2,3,10,20,-30,6"
    )
    state = NavHistory.concatenate(list(read_truth(path)))  # the last line has no end
    assert state.time.tolist() == [5, 6]
    assert np.degrees(state.euler[0]) == pytest.approx([10, 20, -30])
    assert np.degrees(state.lon) == pytest.approx([-170, -170])
    assert state.h.tolist() == [100, 101]
    assert state.v[1].tolist() == [1, 2, 3]


def test_truth_streams_in_blocks(tmp_path: Path) -> None:
    t = np.arange(BLOCK + 5) * 0.01
    path = tmp_path / "truth.csv"
    with HistoryWriter(path) as writer:
        writer.write(great_circle(0.1, 0.2, 3.0).state(t))
    told: list[int] = []
    parts = list(read_truth(path, told.append))
    assert [len(part) for part in parts] == told
    assert len(told) > 1
    assert sum(told) == BLOCK + 5


def written_as(path: Path, columns: dict[str, Any]) -> Path:
    """A file of named columns, of the kind that the suffix says."""
    if path.suffix == ".npz":
        np.savez_compressed(path, **columns)
    elif path.suffix == ".mat":
        scipy.io.savemat(path, columns, do_compression=True)
    else:
        parquet, arrow = (pytest.importorskip(name) for name in ("pyarrow.parquet", "pyarrow"))
        parquet.write_table(arrow.table(columns), path)
    return path


KINDS = (".npz", ".mat", ".parquet")


@pytest.mark.parametrize("suffix", KINDS)
def test_arrays_are_truths_too(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path], suffix: str
) -> None:
    """The same errors as by the CSV, whatever else is in the file."""
    toml, vectors, truth = turn
    names = truth.read_text().splitlines()[0].split(",")
    table = np.loadtxt(truth, delimiter=",", skiprows=1)
    columns: dict[str, Any] = dict(zip(names[::-1], table.T[::-1], strict=True))
    arrays = written_as(tmp_path / f"truth{suffix}", columns | {"satellites": table[:, 0] * 0 + 7})
    out, words = tmp_path / "nav.csv", ("--truth", truth)
    expected = navigated(run, toml, vectors, out, *words)["errors"]
    found = navigated(run, toml, vectors, out, "--truth", arrays)["errors"]
    assert found.pop("truth") == str(arrays)
    del expected["truth"]
    assert found == expected


@pytest.mark.parametrize("suffix", KINDS)
def test_bad_arrays(
    tmp_path: Path, refused: Refused, turn: tuple[Path, Path, Path], suffix: str
) -> None:
    toml, vectors, _ = turn
    good = {name: np.array([float(v), float(w)]) for name, v, w in zip(
        HEADER.split(","), GOOD.split(","), NEXT.split(","), strict=True
    )}  # fmt: skip

    def said(**changes: Any) -> str:
        columns = {name: value for name, value in (good | changes).items() if value is not None}
        truth = written_as(tmp_path / f"bad{suffix}", columns)
        line = refused("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--truth", truth)
        assert f"{truth}: " in line
        return line

    assert "column lat_deg is missing" in said(lat_deg=None)
    assert "row 2: v_east is inf" in said(v_east=np.array([0.0, np.inf]))
    assert "fewer than two rows" in said(v_east=np.array([0.0, np.nan]))
    assert "every row of the truth has NaN" in said(v_east=np.full(2, np.nan))
    assert "row 2: time 1.4 s does not come after 1.5 s" in said(time_s=np.array([1.5, 1.4]))
    assert "row 1: lat_deg 91 is not allowed" in said(lat_deg=np.array([91.0, 48.0]))
    assert "row 2: the quaternion has length 0.5" in said(q_w=np.array([1.0, 0.5]))
    if suffix == ".npz":
        assert "v_down is of type <U1" in said(v_down=np.array(["a", "b"]))
        assert "height_m is of type float64 and shape (2, 1)" in said(height_m=np.zeros((2, 1)))
    if suffix != ".parquet":
        assert "height_m has 3 rows and time_s 2" in said(height_m=np.zeros(3))
    whole = (tmp_path / f"bad{suffix}").read_bytes()
    cut = tmp_path / f"cut{suffix}"
    cut.write_bytes(whole[: len(whole) // 2])
    words = ("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--truth", cut)
    assert "not a whole" in refused(*words)


GOOD = "1.5,1,0,0,0,0,0,0,1,2,3,48,11,500"
NEXT = "1.6,1,0,0,0,0,0,0,1,2,3,48,11,500"


def changed(column: str, value: str) -> str:
    cells = NEXT.split(",")
    cells[HEADER.split(",").index(column)] = value
    return f"{HEADER}\n{GOOD}\n{','.join(cells)}\n"


BAD = {
    "empty": ("", "the truth is empty"),
    "blank": ("\n", "the truth is empty"),
    "no rows": (f"{HEADER}\n", "no rows"),
    "no time": (f"{HEADER}\n{GOOD}\n".replace("time_s", "t"), "line 1: column time_s is missing"),
    "no attitude": (
        f"{HEADER}\n{GOOD}\n".replace("q_w", "w").replace("roll", "r"),
        "line 1: column q_w is missing, add it or leave out all of q_w,q_x,q_y,q_z",
    ),
    "twice": (f"{HEADER},v_east\n{GOOD},1\n", "column v_east is there twice"),
    "backwards": (changed("time_s", "1.4"), "line 3: time 1.4 s does not come after 1.5 s"),
    "standing": (changed("time_s", "1.5"), "line 3: time 1.5 s does not come after 1.5 s"),
    "only time": ("time_s,t\n1,2\n2,3\n", "line 1: neither attitude"),
    "NaN": (changed("v_east", "nan"), "fewer than two rows"),
    "all NaN": (changed("v_east", "").replace(GOOD, GOOD.replace("48", "nan")), "has NaN"),
    "infinite": (changed("height_m", "inf"), "line 3: height_m is inf"),
    "no number": (changed("v_down", "fast"), "line 3: v_down is 'fast', give a number"),
    "no value": (changed("v_down", ""), "fewer than two rows"),
    "not unit": (changed("q_w", "0.999"), "line 3: the quaternion has length 0.999"),
    "zero": (changed("q_w", "0"), "line 3: the quaternion has length 0,"),
    "off the Earth": (changed("lat_deg", "90.001"), "line 3: lat_deg 90.001 is not allowed"),
    "far east": (changed("lon_deg", "361"), "line 3: lon_deg 361"),
    "too high": (changed("height_m", "2e6"), "line 3: height_m 2000000"),
    "inside": (changed("height_m", "-20000"), "line 3: height_m -20000"),
    "short row": (f"{HEADER}\n{GOOD}\n1.6,1,0\n", "line 3: 3 values for 14 columns"),
    "blank row": (f"{HEADER}\n{GOOD}\n\n{NEXT}\n", "line 3: 1 values for 14 columns"),
    "one row": (f"{HEADER}\n{GOOD}\n", "fewer than two rows"),
    "between": (
        f"{HEADER}\n{GOOD}\n{NEXT}\n".replace("1.5,", "1.502,").replace("1.6,", "1.507,"),
        "the truth goes from 1.502 s to 1.507 s and has nothing in common",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_truths(
    tmp_path: Path, refused: Refused, turn: tuple[Path, Path, Path], case: str
) -> None:
    toml, vectors, _ = turn
    content, message = BAD[case]
    truth = tmp_path / "truth.csv"
    truth.write_text(content)
    line = refused("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--truth", truth)
    assert message in line
    assert f"{truth}: " in line


def test_a_truth_of_another_span_is_compared_over_the_overlap(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, truth = turn
    lines = truth.read_text().splitlines(keepends=True)  # every 0.05 s from 0 to 20
    other = tmp_path / "other.csv"
    out, page = tmp_path / "nav.csv", tmp_path / "run.html"
    other.write_text("".join([lines[0], *lines[81:200]]))  # from 4 s to 9.9 s
    words = ("navigate", toml, vectors, "-o", out, "--truth", other, "--no-plots")
    outcome = run(*words, "--report", page)
    assert outcome.status == 0, outcome
    assert "10.1 s of the run after it ends" in outcome.out.replace("\n", " ")
    assert "10.1 s of the run after it ends" in page.read_text()
    said = navigated(run, toml, vectors, out, "--truth", other)
    assert (said["start_s"], said["seconds"]) == pytest.approx((4, 16))
    errors = said["errors"]
    assert errors["instants"] == 119
    assert errors["left_out_s"] == pytest.approx(
        {"run_before": 0, "run_after": 10.1, "truth_before": 0, "truth_after": 0, "run_in_gaps": 0},
        abs=1e-9,
    )
    assert errors["position_m"]["horizontal"]["max"] < 1e-3
    # a truth that goes on before and after what is run
    span = ("--truth", truth, "--start", 5, "--stop", 12.5)
    said = navigated(run, toml, vectors, out, *span)
    assert (said["start_s"], said["seconds"]) == pytest.approx((5, 7.5))
    assert said["errors"]["instants"] == 151
    assert said["errors"]["left_out_s"] == pytest.approx(
        {"run_before": 0, "run_after": 0, "truth_before": 5, "truth_after": 7.5, "run_in_gaps": 0},
        abs=1e-9,
    )
    assert float(out.read_text().splitlines()[-1].split(",")[0]) == pytest.approx(12.5)


def test_a_span_without_truth_or_results(
    tmp_path: Path, refused: Refused, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, truth = turn
    words = ("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--truth")
    assert "not the end of a major interval" in refused(*words, truth, "--start", 4.993)
    assert "no results to navigate with" in refused(*words, truth, "--start", 20)
    assert "--stop 3 is not after --start 5" in refused(*words, truth, "--start", 5, "--stop", 3)
    assert "--stop: 0 s is not after" in refused(*words, truth, "--stop", 0)
    lines = truth.read_text().splitlines(keepends=True)
    other = tmp_path / "other.csv"
    other.write_text("".join(lines[:200]))
    assert "the truth has no state at 15 s" in refused(*words, other, "--start", 15)
    later = [
        f"{1000 + float(line.split(',', 1)[0])!r},{line.split(',', 1)[1]}" for line in lines[1:]
    ]
    other.write_text("".join([lines[0], *later]))
    line = refused(*words, other)
    assert "the truth goes from 1000 s to" in line
    assert "nothing in common with the run from 0 s to 20 s" in line


def kept(truth: Path, to: Path, columns: tuple[str, ...], change: Any = None) -> Path:
    """Some columns of a truth file, changed row by row."""
    names, *rows = (line.split(",") for line in truth.read_text().splitlines())
    places = [names.index(column) for column in columns]
    table = [[row[place] for place in places] for row in rows]
    if change is not None:
        table = [change(number, row) for number, row in enumerate(table)]
    to.write_text("\n".join(",".join(row) for row in [list(columns), *table]) + "\n")
    return to


ATTITUDE = ("q_w", "q_x", "q_y", "q_z")
VELOCITY = ("v_north", "v_east", "v_down")
POSITION = ("lat_deg", "lon_deg", "height_m")
START = {
    "attitude": ("--roll", "--pitch", "--heading"),
    "velocity": ("--vn", "--ve", "--vd"),
    "position": ("--lat", "--lon", "--height"),
}


PARTS = {
    "attitude": ("attitude",),
    "velocity": ("velocity",),
    "position": ("position",),
    "attitude and position": ("attitude", "position"),
}


@pytest.mark.parametrize("parts", few_of(PARTS, ["velocity", "attitude and position"]))
def test_a_truth_may_tell_a_part(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path], parts: tuple[str, ...]
) -> None:
    """Its errors are those of the whole truth; what it lacks of the start the options give."""
    toml, vectors, truth = turn
    groups = {"attitude": ATTITUDE, "velocity": VELOCITY, "position": POSITION}
    columns = ("time_s", *(column for part in parts for column in groups[part]))
    partial = kept(truth, tmp_path / "part.csv", columns)
    names, first = (line.split(",") for line in truth.read_text().splitlines()[:2])
    values = dict(zip(names, first, strict=True))
    euler = [values[f"{name}_deg"] for name in ("roll", "pitch", "heading")]
    told = {
        "attitude": euler,
        "velocity": [values[name] for name in VELOCITY],
        "position": [values[name] for name in POSITION],
    }
    lacking = [
        word
        for part in groups
        if part not in parts
        for pair in zip(START[part], told[part], strict=True)
        for word in pair
    ]
    out, page = tmp_path / "nav.csv", tmp_path / "run.html"
    whole = navigated(run, toml, vectors, out, "--truth", truth)["errors"]
    outcome = run("navigate", toml, vectors, "-o", out, "--truth", partial, *lacking, "--json",
                  "--report", page)  # fmt: skip
    assert outcome.status == 0, outcome
    errors = json.loads(outcome.out)["errors"]
    keys = {"attitude": "attitude_arcsec", "velocity": "velocity_m_s", "position": "position_m"}
    for part, key in keys.items():
        assert (key in errors) == (part in parts)
        if part in parts:
            assert errors[key]["north"]["max"] == pytest.approx(
                whole[key]["north"]["max"], rel=0.05, abs=1e-9
            )
    assert ("horizontal_growth_nmi_per_h" in errors) == ("position" in parts)
    _Page(page.read_text(encoding="utf-8")).check()
    assert "nan" not in page.read_text(encoding="utf-8").split("<pre")[0].lower().split("base64")[0]


def test_what_neither_truth_nor_options_tell(
    tmp_path: Path, refused: Refused, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, truth = turn
    partial = kept(truth, tmp_path / "part.csv", ("time_s", *ATTITUDE))
    words = ("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--truth", partial)
    assert "--lat: missing, for the truth tells no position" in refused(*words)
    assert "--height: missing" in refused(*words, "--lat", 48, "--lon", 11)


def test_rows_with_nan_are_passed_over_and_counted(
    run: Run, tmp_path: Path, turn: tuple[Path, Path, Path]
) -> None:
    toml, vectors, truth = turn

    def holes(number: int, row: list[str]) -> list[str]:
        if number in (0, 7, 8, 100):
            row = [row[0], *(["nan", ""][number % 2] for _ in row[1:])]
        return row

    names = tuple(truth.read_text().splitlines()[0].split(","))
    holed = kept(truth, tmp_path / "holed.csv", names, holes)
    out = tmp_path / "nav.csv"
    said = navigated(run, toml, vectors, out, "--truth", holed)
    assert said["start_s"] == pytest.approx(0.05)
    assert said["errors"]["rows_passed_over"] == 4
    assert said["errors"]["instants"] == 397
    assert said["errors"]["position_m"]["horizontal"]["max"] < 1e-3
    outcome = run("navigate", toml, vectors, "-o", out, "--truth", holed, "--no-plots")
    assert "4 rows with NaN" in outcome.out


def test_options(tmp_path: Path, refused: Refused, turn: tuple[Path, Path, Path]) -> None:
    toml, vectors, truth = turn
    words = ("navigate", toml, vectors, "-o", tmp_path / "nav.csv")
    assert "Missing option '--lat' (or --truth" in refused(*words)
    assert "--start and --align contradict" in refused(
        *words, "--truth", truth, "--start", 1, "--align", 10
    )
    assert "cannot read the truth" in refused(*words, "--truth", tmp_path / "absent.csv")
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00")
    assert "not a text file" in refused(*words, "--truth", binary)
    place = ("--lat", 48, "--lon", 11, "--height", 500)
    assert "not the end of a major interval" in refused(*words, *place, "--start", 1.003)
    assert "no results to navigate with" in refused(*words, *place, "--start", 100)


def test_from_above_keeps_distances_over_a_pole() -> None:
    motion = over_the_pole(lon=0.3, h=0.0, speed=100.0, before=50.0)
    state = motion.state(np.linspace(0, 100, 11))
    north, east = from_above(state, state)
    assert north == pytest.approx(np.linspace(0, 10_000, 11), rel=4e-3, abs=1e-6)
    assert np.abs(east).max() < 1e-6
    side = great_circle(0.5, 1.0, 0.0, pi / 2, 100.0).state(np.array([0.0, 60.0]))
    north, east = from_above(side, side)
    assert east[1] == pytest.approx(6000, rel=4e-3)
    assert abs(north[1]) < 3
