"""Logs and vectors of many channels: `convert`, `model`, `compare`, `navigate --channel`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sculler
from sculler.formats.log import COUNTS, read_log
from sculler.formats.vectors import VectorsWriter, read_vectors
from sculler.main import main
from sculler_model.design import Design
from sculler_model.fast import FastModel

DESIGN = """
name = "three"
preset = "hg4930"
[algorithm]
samples = 2
minors = 2
[hardware]
core = "compact"
channels = 3
"""
SAMPLES = 240


def written(path: Path, counts: np.ndarray, **columns: np.ndarray) -> None:
    """A log whose columns stand in an odd order."""
    named = {**columns, **dict(zip(COUNTS, counts.T, strict=True))}
    rows = [",".join(map(str, row)) for row in zip(*named.values(), strict=True)]
    path.write_text("\n".join([",".join(named), *rows]) + "\n")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("three.toml").write_text(DESIGN)
    Path("one.toml").write_text(DESIGN.replace("channels = 3", ""))
    return tmp_path


def draw() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Counts of 32 bits, whose results pass 64 bits; channels, and few restarts."""
    rng = np.random.default_rng(7)
    counts = rng.integers(-(2**31), 2**31, (SAMPLES, 6))
    return counts, rng.integers(0, 3, SAMPLES), (rng.random(SAMPLES) < 0.03).astype(int)


@pytest.mark.parametrize("kind", ["csv", "npz"])
def test_a_log_of_three_units_is_three_logs(place: Path, kind: str):
    counts, channels, restarts = draw()
    times = np.arange(SAMPLES) * 1e-3
    if kind == "csv":
        written(place / "log.csv", counts, restart=restarts, channel=channels, time_s=times)
    else:
        columns = dict(zip(COUNTS, counts.T, strict=True))
        np.savez("log.npz", channel=channels, restart=restarts, time_s=times, **columns)
    assert main(["model", "three.toml", f"log.{kind}", "-o", "m.csv"]) == 0
    assert main(["model", "three.toml", f"log.{kind}", "-o", "r.npz", "--engine", "reference"]) == 0
    assert main(["compare", "m.csv", "r.npz"]) == 0
    design = Design.load("three.toml")
    for channel in range(3):
        alone, blocks, ends = FastModel(Design.load("one.toml")), [], []
        for i in np.flatnonzero(channels == channel):
            if restarts[i]:
                alone.reset()
            block = alone.feed(counts[i : i + 1])
            blocks += list(block.rows())
            ends += [times[i]] * len(block)
        found = sculler.read_vectors("m.csv", design, channel=channel)
        assert found.channels is None
        assert list(found.rows()) == blocks
        assert found.times is not None
        np.testing.assert_allclose(found.times, ends)


def test_compare_sees_a_channel_that_differs(place: Path, capsys: pytest.CaptureFixture[str]):
    counts, channels, _ = draw()
    written(place / "log.csv", counts, channel=channels)
    main(["model", "three.toml", "log.csv", "-o", "m.csv"])
    capsys.readouterr()
    first, *lines = Path("m.csv").read_text().splitlines()
    assert first.endswith("sculling_between_z,channel")
    lines[4] = lines[4][:-1] + str((int(lines[4][-1]) + 1) % 3)
    Path("other.csv").write_text("\n".join([first, *lines]) + "\n")
    assert main(["compare", "m.csv", "other.csv"]) == 1
    assert "(row 4), channel: " in capsys.readouterr().out
    written(place / "alone.csv", counts)
    main(["model", "one.toml", "alone.csv", "-o", "s.csv"])
    assert main(["compare", "m.csv", "s.csv"]) == 2
    assert "s.csv: no column channel, which m.csv has" in capsys.readouterr().err


def test_navigate_takes_one_channel(place: Path, capsys: pytest.CaptureFixture[str]):
    rng = np.random.default_rng(2)
    counts = rng.integers(-1000, 1000, (SAMPLES, 6))
    channels = np.arange(SAMPLES) % 3
    written(place / "log.csv", counts, channel=channels)
    written(place / "alone.csv", counts[channels == 2])
    main(["model", "three.toml", "log.csv", "-o", "m.csv"])
    main(["model", "one.toml", "alone.csv", "-o", "s.csv"])
    options = "--lat 47 --lon 8 --height 1 --heading 0 --no-plots".split()
    assert main(["navigate", "three.toml", "m.csv", "-o", "a.csv", "--channel", "2", *options]) == 0
    assert main(["navigate", "one.toml", "s.csv", "-o", "b.csv", *options]) == 0
    assert Path("a.csv").read_bytes() == Path("b.csv").read_bytes()
    capsys.readouterr()
    for vectors, channel, told in (
        ("m.csv", [], "m.csv: results of many channels, name one (sculler navigate --channel)"),
        ("m.csv", ["3"], "m.csv: channel 3 is not one of design three, give 0 to 2"),
        ("s.csv", ["0"], "s.csv: results of one sensor, leave the channel out"),
    ):
        asked = ["--channel", *channel] if channel else []
        assert main(["navigate", "three.toml", vectors, "-o", "c.csv", *asked, *options]) == 2
        assert capsys.readouterr().err == f"sculler: {told}\n"


@pytest.mark.parametrize(
    ("design", "columns", "told"),
    [
        ("three", {}, "line 1: column channel is missing, add it: hardware.channels = 3"),
        (
            "one",
            {"channel": 0},
            "line 1: column channel is for a design with hardware.channels, take it out or give"
            " such a design",
        ),
        (
            "three",
            {"channel": 0, "sequence": 1},
            "line 1: column sequence is not read where there are channels, take it out",
        ),
        ("three", {"channel": 3}, "line 2: channel is 3, give 0 to 2"),
        ("three", {"channel": 0, "restart": 2}, "line 2: restart is 2, give 0 or 1"),
    ],
)
def test_logs_at_fault(
    place: Path,
    capsys: pytest.CaptureFixture[str],
    design: str,
    columns: dict[str, int],
    told: str,
):
    more = {name: np.full(4, value) for name, value in columns.items()}
    written(place / "log.csv", np.zeros((4, 6), int), **more)
    assert main(["model", f"{design}.toml", "log.csv", "-o", "m.csv"]) == 2
    assert capsys.readouterr().err == f"sculler: log.csv: {told}\n"


def test_messages_name_the_line_of_a_channel_s_row(place: Path):
    counts, channels, _ = draw()
    written(place / "log.csv", counts, channel=channels)
    main(["model", "three.toml", "log.csv", "-o", "m.csv"])
    design = Design.load("three.toml")
    lines = Path("m.csv").read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("2,") and line.endswith(",1"))
    del lines[at]
    Path("m.csv").write_text("\n".join(lines) + "\n")
    at = next(i for i, line in enumerate(lines) if line.startswith("3,") and line.endswith(",1"))
    with pytest.raises(sculler.InputError, match=rf"line {at + 1}: major is 3 where 2"):
        list(read_vectors("m.csv", design, channel=1))
    assert list(read_vectors("m.csv", design, channel=0))


def test_blocks_without_channels_do_not_fit_a_file_with_them(place: Path):
    block = FastModel(Design.load("one.toml")).feed(np.zeros((4, 6), int))
    design = Design.load("three.toml")
    writer = VectorsWriter("v.csv", design.columns, design=design)
    with pytest.raises(ValueError, match="exactly where"), writer:
        writer.write(block)


UNITS = "--gyro-unit deg/s --accel-unit g --rates mean --axes y,x,-z".split()
UNITS += ["--gyro-bias", "1,2,3 deg/h"]


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_convert_carries_each_channel_s_own_remainder(place: Path, ending: str):
    """As it does the remainder of a log that is the channel's alone, and of each of its parts."""
    rng = np.random.default_rng(5)
    values = rng.normal(0.0, [2e-3] * 3 + [1.0] * 3, (SAMPLES, 6))
    _, channels, restarts = draw()
    faults, times = rng.integers(0, 2, SAMPLES), np.arange(SAMPLES) * 0.25
    written(place / "l.csv", values, restart=restarts, fault=faults, t=times, channel=channels)
    asked = ["--time-column", "t", *UNITS]
    assert main(["convert", "l.csv", "-o", f"i.{ending}", "--design", "three.toml", *asked]) == 0
    (found,) = read_log(f"i.{ending}", Design.load("three.toml"), channels=True)
    for column, wanted in (
        (found.channels, channels),
        (found.restarts, restarts),
        (found.faults, faults),
        (found.times, times),
    ):
        np.testing.assert_array_equal(column, wanted)
    for channel in range(3):
        mine = np.flatnonzero(channels == channel)
        for part in np.split(mine, np.flatnonzero(restarts[mine])):
            if len(part):
                written(place / "alone.csv", values[part])
                asked = ["-o", "j.csv", "--design", "one.toml", *UNITS]
                assert main(["convert", "alone.csv", *asked]) == 0
                (alone,) = read_log("j.csv", Design.load("one.toml"))
                np.testing.assert_array_equal(found.counts[part], alone.counts)
    assert np.ptp(found.counts[:, :3]) > 0
    assert main(["model", "three.toml", f"i.{ending}", "-o", "m.csv"]) == 0


@pytest.mark.parametrize(
    ("columns", "options", "told"),
    [
        ({}, [], "log.csv: column channel is missing, give CSV with it: hardware.channels = 3"),
        ({"channel": 3}, [], "log.csv: column channel: 3 is not one of the design's, give 0 to 2"),
        (
            {"channel": 0.5},
            [],
            "log.csv: column channel: 0.5 is not one of the design's, give 0 to 2",
        ),
        (
            {"channel": 0, "restart": 2},
            [],
            "log.csv: column restart is not 0 or 1 throughout, mend it",
        ),
        (
            {"channel": 1},
            ["--cumulative"],
            "--cumulative: not built for a design with channels, convert each channel's log by"
            " itself, with a design without hardware.channels",
        ),
        (
            {"channel": 1},
            ["--rates", "instant", "--gyro-unit", "rad/s", "--accel-unit", "g"],
            "rates at instants are not integrated for a design with channels, give --rates mean",
        ),
        (
            {"channel": 1},
            [],
            "log.csv: channel 1: sample 0: gyro_x = 0.5 is not a whole number of counts, check the"
            " unit",
        ),
    ],
)
def test_what_convert_says_of_channels(
    place: Path,
    capsys: pytest.CaptureFixture[str],
    columns: dict[str, float],
    options: list[str],
    told: str,
):
    more = {name: np.full(4, value) for name, value in columns.items()}
    written(place / "log.csv", np.full((4, 6), 0.5), **more)
    asked = options if "--gyro-unit" in options else [*options, *COUNTED]
    assert main(["convert", "log.csv", "-o", "i.csv", "--design", "three.toml", *asked]) == 2
    assert capsys.readouterr().err in (
        f"sculler: {told}\n",
        f"sculler: {told}; see 'sculler convert --help'\n",
    )
    assert not Path("i.csv").exists()


COUNTED = ["--gyro-unit", "counts", "--accel-unit", "counts"]
