"""`navigate` at breaks in the vectors, at results with status bits, at what no motion gives."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fine_sensor import fine_design_file
from sculler.checks.oddities import Oddities
from sculler.checks.vector_breaks import Break, stretches
from sculler.formats.history import HistoryWriter
from sculler.formats.log import LogWriter
from sculler.formats.truth import read_truth
from sculler.formats.vectors import read_vectors
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.host import MajorIncrements
from sculler_model.motion import Motion, at_rest, steady_turn
from sculler_model.navigation import NavHistory
from sculler_model.samples import Quantiser

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 48, "--lon", 11, "--height", 500)
TURN = steady_turn(radians(48), radians(11), 500.0)
REST = at_rest(radians(48), radians(11), 500.0, heading=radians(30))
CLOCK = 4000.5
SECONDS = 40


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("breaks")


def vectors_of(
    run: Run,
    folder: Path,
    name: str,
    motion: Motion,
    kind: str = "increment",
    lost: slice | None = None,
    stamps: bool = True,
) -> tuple[Path, Path]:
    """Design and vectors of a motion at 200 Hz, 20 intervals a second, some samples lost."""
    toml = fine_design_file(folder, 2, 5, rate=200.0, kind=kind)
    out = folder / f"{name}_{kind}.csv"
    if out.exists():
        return toml, out
    design, log = Design.load(toml), folder / "log.csv"
    samples = SECONDS * 200
    values = np.concatenate(list(motion.chunks(design.sensor.kind, samples, 1 / 200)))
    counts = Quantiser(design)(values)
    times = CLOCK + (np.arange(samples) + (kind == "increment")) / 200
    if lost is not None:
        there = np.ones(samples, np.bool_)
        there[lost] = False
        counts, times = counts[there], times[there]
    with LogWriter(log, times=stamps) as writer:
        writer.write(counts, times=times if stamps else None)
    outcome = run("model", toml, log, "-o", out, "--breaks", "split")
    assert outcome.status == 0, outcome
    return toml, out


def truth_of(folder: Path, motion: Motion, clock: float = CLOCK) -> Path:
    """At 200 Hz, so at every sample's instant."""
    path = folder / "truth.csv"
    states = motion.state(np.arange(-200, SECONDS * 200 + 200) / 200)
    states = NavHistory(
        np.round(clock + states.time, 3), states.q, states.v, states.lat, states.lon, states.h
    )
    with HistoryWriter(path) as writer:
        writer.write(states)
    return path


def navigated(run: Run, toml: Path, vectors: Path, out: Path, *options: object) -> dict[str, Any]:
    outcome = run("navigate", toml, vectors, "-o", out, "--no-plots", "--json", *options)
    assert outcome.status == 0, outcome
    said: dict[str, Any] = json.loads(outcome.out)
    return said


LOST = slice(2003, 2403)  # 400 samples, from 10.015 s on
KINDS = ("increment", "rate")


@pytest.mark.parametrize("kind", KINDS)
def test_a_core_that_was_reset_at_a_gap(
    run: Run, tmp_path: Path, folder: Path, refused: Refused, kind: str
) -> None:
    """Refused with its line; from the truth it begins anew after what is of short history."""
    toml, vectors = vectors_of(run, folder, "gap", TURN, kind, LOST)
    out, truth = tmp_path / "nav.csv", truth_of(tmp_path, TURN)
    words = ("navigate", toml, vectors, "-o", out, "--truth", truth)
    line = refused(*words)
    assert f"{vectors}: line 202: major falls back from 199 to 0" in line
    assert "--breaks split" in line
    said = navigated(run, toml, vectors, out, "--truth", truth, "--breaks", "split")
    (found,) = said["breaks"]
    assert (found["line"], found["then"]) == (202, "begun anew from the truth")
    # the last whole interval ends with sample 2000, the next one begins with the 2403rd
    lost = (2403 - 2000) / 200
    assert found["seconds"] == pytest.approx(lost, abs=1e-9)
    assert any("a break of" in warning and "line 202" in warning for warning in said["warnings"])
    errors = said["errors"]
    assert errors["interpolated"] == 0
    assert errors["attitude_arcsec"]["total"]["max"] < 0.1
    assert errors["position_m"]["horizontal"]["max"] < 0.02
    track = NavHistory.concatenate(list(read_truth(out)))
    step = np.diff(track.time)
    short = 0.05 if kind == "rate" else 0.0
    assert step.max() == pytest.approx(lost + short, abs=1e-9)
    assert np.sort(step)[-2] == pytest.approx(0.05, abs=1e-9)
    assert track.time[-1] == pytest.approx(
        CLOCK + 12.015 + 0.05 * ((8000 - 2403) // 10) - (0.005 if kind == "rate" else 0), abs=1e-9
    )


def test_without_truth_it_goes_on_as_before(run: Run, tmp_path: Path, folder: Path) -> None:
    """Straight on with the velocity, attitude as it was; and it says so."""
    toml, vectors = vectors_of(run, folder, "gap", TURN, "increment", LOST)
    out = tmp_path / "nav.csv"
    said = navigated(run, toml, vectors, out, *PLACE, "--vn", 30, "--roll", 17, "--breaks", "split")
    (warning,) = (w for w in said["warnings"] if "break" in w)
    assert "attitude and velocity are taken over it" in warning
    assert said["breaks"][0]["then"].startswith("attitude and velocity are taken over it")
    track = NavHistory.concatenate(list(read_truth(out)))
    row = int(np.argmax(np.diff(track.time)))
    before, after = track.state(row), track.state(row + 1)
    gap = after.time - before.time
    assert gap == pytest.approx(2.015)
    assert after.v == pytest.approx(before.v, abs=1e-3)
    assert after.q == pytest.approx(before.q, abs=1e-5)
    assert after.h == pytest.approx(before.h - gap * before.v[2])
    assert 6.38e6 * (after.lat - before.lat) == pytest.approx(gap * before.v[0], rel=2e-2)


def test_a_truth_that_ends_before_the_break(run: Run, tmp_path: Path, folder: Path) -> None:
    """The run goes on without it; with one that begins again later it waits for that."""
    toml, vectors = vectors_of(run, folder, "gap", TURN, "increment", LOST)
    out, truth = tmp_path / "nav.csv", truth_of(tmp_path, TURN)
    lines = truth.read_text().splitlines(keepends=True)
    words = ("--truth", truth, "--breaks", "split")
    truth.write_text("".join(lines[:1401]))  # to 5.995 s
    said = navigated(run, toml, vectors, out, *words)
    assert said["breaks"][0]["then"].startswith("attitude and velocity are taken over it")
    assert said["seconds"] == pytest.approx(39.965)
    assert said["errors"]["left_out_s"]["run_after"] == pytest.approx(39.965 - 5.995)
    truth.write_text("".join([*lines[:1401], *lines[4201:]]))  # and again from 20 s on
    said = navigated(run, toml, vectors, out, *words)
    assert said["breaks"][0]["then"] == "begun anew from the truth"
    assert said["errors"]["attitude_arcsec"]["total"]["final"] < 0.1
    times = np.array([float(line.split(",")[0]) for line in out.read_text().splitlines()[1:]])
    assert np.diff(times).max() == pytest.approx(CLOCK + 20.015 - (CLOCK + 10), abs=0.051)


def test_aligned_at_first_and_from_the_truth_after_a_break(
    run: Run, tmp_path: Path, folder: Path
) -> None:
    toml, vectors = vectors_of(run, folder, "rest", REST, "rate", slice(4001, 4100))
    out, truth = tmp_path / "nav.csv", truth_of(tmp_path, REST)
    words = ("--truth", truth, "--breaks", "split", "--align", 12, "--fine")
    said = navigated(run, toml, vectors, out, *words)
    assert said["breaks"][0]["then"] == "begun anew from the truth"
    assert said["seconds"] == pytest.approx(39.99 - 12.045, abs=0.05)


def test_many_breaks(run: Run, tmp_path: Path, folder: Path) -> None:
    toml, vectors = vectors_of(run, folder, "turnplain", TURN, stamps=False)
    lines = vectors.read_text().splitlines(keepends=True)
    holed = tmp_path / "holed.csv"
    holed.write_text("".join(line for k, line in enumerate(lines) if k % 50 or not k))
    said = navigated(run, toml, holed, tmp_path / "n.csv", *PLACE, "--breaks", "split")
    assert len(said["breaks"]) == 15
    assert sum("a break of 0.05 s" in warning for warning in said["warnings"]) == 5
    assert said["warnings"][-1] == "10 more breaks"


def test_aligned_again(run: Run, tmp_path: Path, folder: Path, refused: Refused) -> None:
    toml, vectors = vectors_of(run, folder, "rest", REST, "rate", slice(4001, 4100))
    out = tmp_path / "nav.csv"
    words = (*PLACE, "--breaks", "split", "--align")
    said = navigated(run, toml, vectors, out, *words, 12)
    assert said["breaks"][0]["then"] == "aligned anew"
    assert said["alignment"]["seconds"] == pytest.approx(12)
    track = NavHistory.concatenate(list(read_truth(out)))
    row = int(np.argmax(np.diff(track.time)))
    # 0.495 s lost with two intervals cut, one of short history, then 12 s of alignment
    assert track.time[row + 1] == pytest.approx(CLOCK + 20.5 - 0.005 + 0.05 + 12, abs=1e-9)
    assert np.degrees(track.euler[row + 1, 2]) == pytest.approx(30, abs=0.01)
    assert "are more than the 19.45 s of vectors after the last break" in refused(
        "navigate", toml, vectors, "-o", out, *words, 19.8
    )
    assert "inside the window of --align" in refused(
        "navigate", toml, vectors, "-o", out, *words, 25
    )


def test_a_reset_of_unknown_length(
    run: Run, tmp_path: Path, folder: Path, refused: Refused
) -> None:
    toml, vectors = vectors_of(run, folder, "plain", REST, stamps=False)
    lines = vectors.read_text().splitlines(keepends=True)
    twice = tmp_path / "twice.csv"
    twice.write_text("".join([*lines[:101], *lines[1:]]))
    words = ("navigate", toml, twice, "-o", tmp_path / "nav.csv", *PLACE)
    assert f"{twice}: line 102: major falls back from 99 to 0" in refused(*words)
    assert "how long that took is not known" in refused(*words, "--breaks", "split")


def test_rows_that_are_missing(run: Run, tmp_path: Path, folder: Path, refused: Refused) -> None:
    """Without stamps their number tells how long it was."""
    toml, vectors = vectors_of(run, folder, "turnplain", TURN, stamps=False)
    lines = vectors.read_text().splitlines(keepends=True)
    holed = tmp_path / "holed.csv"
    holed.write_text("".join([*lines[:201], *lines[221:]]))
    truth, out = truth_of(tmp_path, TURN, 0.0), tmp_path / "nav.csv"
    words = ("navigate", toml, holed, "-o", out, "--truth", truth)
    assert f"{holed}: line 202: major is 220 where 200 should follow" in refused(*words)
    said = navigated(run, toml, holed, out, "--truth", truth, "--breaks", "split")
    assert said["breaks"][0]["seconds"] == pytest.approx(1.0)
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < 0.1
    assert said["errors"]["instants"] == 782
    holed.write_text("".join([*lines[:201], *lines[150:]]))
    assert "line 202: major is 149" in refused(*words, "--breaks", "split")


def test_stamps_of_vectors_that_jump(
    run: Run, tmp_path: Path, folder: Path, refused: Refused
) -> None:
    toml, vectors = vectors_of(run, folder, "whole", TURN)
    lines = vectors.read_text().splitlines()

    def shifted(seconds: float) -> Path:
        path = tmp_path / "shifted.csv"
        rows = [line.rpartition(",") for line in lines[1:]]
        times = [float(time) + (seconds if k >= 300 else 0) for k, (_, _, time) in enumerate(rows)]
        rest = [f"{row},{time!r}" for (row, _, _), time in zip(rows, times, strict=True)]
        path.write_text("\n".join([lines[0], *rest]) + "\n")
        return path

    out = tmp_path / "nav.csv"
    words = ("navigate", toml, tmp_path / "shifted.csv", "-o", out, *PLACE, "--vn", 30)
    shifted(0.005)  # one sample
    line = refused(*words)
    assert "line 302: time_s goes from 4015.5 to 4015.555 s, an interval is 0.05 s long" in line
    assert navigated(run, *words[1:3], out, *words[5:], "--breaks", "split")["breaks"]
    shifted(-1.0)
    assert "line 302: time_s goes from 4015.5 to 4014.55" in refused(*words)
    assert "time runs back" in refused(*words, "--breaks", "split")
    shifted(0.003)  # less than a sample: a stamp of few digits
    assert not navigated(run, *words[1:3], out, *words[5:])["breaks"]


@pytest.mark.parametrize("size", [1, 7, 10, 1000])
def test_stretches_do_not_depend_on_blocks(tmp_path: Path, size: int) -> None:
    design = Design.load(fine_design_file(tmp_path, 2, 5))
    major = np.array([0, 1, 2, 5, 6, 0, 1, 2, 3, 4, 4 + 3, 8])
    times = 7 + 0.01 * np.array([1, 2, 3, 6, 7, 20, 21, 22, 23.7, 24.7, 27.7, 28.7])
    whole = VectorBlock(major, np.zeros(12, np.int64), np.zeros((12, 18), np.int64), times)

    def cut(part: slice) -> VectorBlock:
        return VectorBlock(major[part], whole.status[part], whole.components[part], times[part])

    parts = list(stretches(design, (cut(slice(k, k + size)) for k in range(0, 12, size))))
    found = [(part.line, part.seconds) for part in parts if isinstance(part, Break)]
    assert [line for line, _ in found] == [5, 7, 10, 12]
    assert [seconds for _, seconds in found] == pytest.approx([0.02, 0.12, 0.007, 0.02])
    rows = [block.major.tolist() for block in parts if not isinstance(block, Break)]
    assert [number for row in rows for number in row] == major.tolist()
    assert all(np.diff(row).tolist() == [1] * (len(row) - 1) for row in rows)


def edited(vectors: Path, to: Path, change: Callable[[int, dict[str, str]], None]) -> Path:
    """Vectors with rows changed; `change` gets their number from 0, and their cells."""
    header, *lines = vectors.read_text().splitlines()
    rows = [dict(zip(header.split(","), line.split(","), strict=True)) for line in lines]
    for number, row in enumerate(rows):
        change(number, row)
    to.write_text("\n".join([header, *(",".join(row.values()) for row in rows)]) + "\n")
    return to


def test_status_bits_are_counted_and_told(run: Run, tmp_path: Path, folder: Path) -> None:
    """Fault, rail and lost samples, with the end of the first such interval that is used."""
    toml, vectors = vectors_of(run, folder, "whole", TURN)
    bits = {10: 2, 100: 4, 101: 6, 102: 12, 500: 8, 700: 2}

    def mark(number: int, row: dict[str, str]) -> None:
        row["status"] = str(bits.get(number, 0))

    marked, out, page = (
        edited(vectors, tmp_path / "m.csv", mark),
        tmp_path / "n.csv",
        tmp_path / "p",
    )
    words = (*PLACE, "--vn", 30, "--start", CLOCK + 2, "--stop", CLOCK + 30)
    said = navigated(run, toml, marked, out, *words, "--report", page.with_suffix(".html"))
    counts = [said[key] for key in ("fault_results", "rail_results", "lost_results")]
    assert counts == [1, 3, 2]
    assert said["warnings"][-3:] == [
        "1 result with faulty samples (status bit 1), the first one ends at 4005.6 s",
        "3 results with a count at its rail (status bit 2), the first one ends at 4005.55 s",
        "2 results after samples that were lost (status bit 3), the first one ends at 4005.65 s",
    ]
    assert "3 results with a count at its rail" in page.with_suffix(".html").read_text()
    outcome = run("navigate", toml, marked, "-o", out, "--no-plots", *words)
    assert "warning 3" in outcome.out
    assert "count at its rail" in outcome.out


ACCEL = ("nu", "sculling_within", "sculling_between")
COMPONENTS = ("alpha", "nu", "coning_within", "coning_between", "sculling_within",
              "sculling_between")  # fmt: skip


@pytest.mark.parametrize("size", [1, 2, 3, 50])
def test_oddities_do_not_depend_on_blocks(tmp_path: Path, size: int) -> None:
    design = Design.load(fine_design_file(tmp_path, 2, 5))
    rng = np.random.default_rng(3)
    alpha, dv = 1e-4 * rng.normal(size=(2, 1600, 3))
    alpha[0] *= 1e4  # at the very beginning
    alpha[70, 2] = 1.0
    dv[71, 0] = -3.0
    dv[90:92] = 2.0  # two together are no spike
    alpha[100:900] = 0
    dv[1599, 1] = 7.0
    whole = MajorIncrements(alpha, alpha, dv, times=np.arange(1600.0))
    oddities = Oddities(design)
    for first in range(0, 1600, size):
        oddities.see(whole[first : first + size])
    found = oddities.finish()
    assert [warning.split(" ")[0] for warning in found] == ["2", "the", "2"]
    assert "the first one ends at 0 s: a spike" in found[0]
    assert (
        "gyros give nothing but zeros over 800 intervals, the first one ends at 100 s" in found[1]
    )
    assert "the first one ends at 71 s: a spike" in found[2]


def test_a_spike(run: Run, tmp_path: Path, folder: Path) -> None:
    toml, vectors = vectors_of(run, folder, "rest_whole", REST)

    def hit(number: int, row: dict[str, str]) -> None:
        if number == 400:
            row["alpha_z"] = str(10**9)  # about the force, which stays where it is
        if number == 500:
            row["nu_x"] = str(10**10)

    assert navigated(run, toml, vectors, tmp_path / "n.csv", *PLACE)["warnings"] == []
    spiked = edited(vectors, tmp_path / "s.csv", hit)
    warnings = navigated(run, toml, spiked, tmp_path / "n.csv", *PLACE)["warnings"]
    assert len(warnings) == 2
    gyros, accelerometers = warnings
    assert gyros.startswith("1 interval where the gyros are ")
    assert "the first one ends at 4020.55 s" in gyros
    assert accelerometers.startswith("1 interval where the accelerometers are ")
    assert "the first one ends at 4025.55 s" in accelerometers


@pytest.mark.parametrize(("names", "value"), [(COMPONENTS, "0"), (ACCEL, "0"), (COMPONENTS, None)])
def test_what_stands_still(
    run: Run, tmp_path: Path, folder: Path, names: tuple[str, ...], value: str | None
) -> None:
    """All zeros for ten seconds, an accelerometer that is dead, one result again and again."""
    toml, vectors = vectors_of(run, folder, "whole", TURN)
    held: dict[str, str] = {}

    def stick(number: int, row: dict[str, str]) -> None:
        if 200 <= number < 400:
            for name in (f"{name}_{axis}" for name in names for axis in "xyz"):
                row[name] = held.setdefault(name, row[name] if value is None else value)

    stuck = edited(vectors, tmp_path / "s.csv", stick)
    said = navigated(run, toml, stuck, tmp_path / "n.csv", *PLACE, "--vn", 30)
    what = "repeat the same increments" if value is None else "give nothing but zeros"
    sensors = ["accelerometers"] if names == ACCEL else ["gyros", "accelerometers"]
    found = [warning for warning in said["warnings"] if what in warning]
    assert [warning.split()[1] for warning in found] == sensors
    assert all("over 200 intervals, the first one ends at 4010.55 s" in each for each in found)
    assert len(said["warnings"]) == len(found)


def test_read_vectors_refuses_missing_rows_unless_asked(run: Run, folder: Path) -> None:
    toml, vectors = vectors_of(run, folder, "plain", REST, stamps=False)
    lines = vectors.read_text().splitlines(keepends=True)
    holed = folder / "holed.csv"
    holed.write_text("".join([*lines[:5], *lines[7:]]))
    (block,) = read_vectors(holed, Design.load(toml), missing=True)
    assert block.major[:6].tolist() == [0, 1, 2, 3, 6, 7]
