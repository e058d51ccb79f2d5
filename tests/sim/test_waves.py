import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from sculler_model.errors import InputError
from sculler_sim.engine import simulate
from sculler_sim.engines.verilator_build import Tools
from strategies import DESIGNS, random_counts

DESIGN = DESIGNS["smallest"]
COUNTS = random_counts(DESIGN, 40, np.random.default_rng(1))


def run(wave, engine):
    simulation = simulate(DESIGN, [(COUNTS, None)], engine=engine, wave=wave)
    rows = [row for block in simulation for row in block.rows()]
    return simulation.progress, rows


def values_of(vcd, name):
    """Time and value of each change of a top-level one-bit port."""
    head, _, body = vcd.partition("$enddefinitions $end")
    code = re.search(rf"\$var wire\s+1 (\S+) {name} \$end", head)[1]
    changes, time = [], 0
    for line in body.split("\n"):
        if line.startswith("#"):
            time = int(line[1:])
        elif line[1:] == code and line[0] in "01":
            changes.append((time, int(line[0])))
    return changes


@pytest.mark.parametrize("engine", ["verilator", "amaranth"])
def test_a_vcd_shows_the_run(verilator, tmp_path, engine):
    wave = tmp_path / "wave.vcd"
    progress, rows = run(wave, engine)
    text = wave.read_text()
    assert "$timescale" in text
    for port in ("sample_gyro_x", "result_sculling_between_z", "result_major"):
        assert re.search(rf"\$var wire\s+\d+ \S+ {port}\b", text)
    rises = [time for time, value in values_of(text, "clk") if value]
    assert len(rises) == progress.clocks
    assert len({later - earlier for earlier, later in pairwise(rises)}) == 1
    assert [value for _, value in values_of(text, "result_valid")].count(1) == len(rows) == 40
    assert list(tmp_path.iterdir()) == [wave]


def test_the_wave_does_not_change_the_results(verilator, tmp_path):
    assert run(None, "verilator") == run(tmp_path / "wave.vcd", "verilator")


def test_fst_is_written_or_its_headers_are_named(verilator, tmp_path):
    wave = tmp_path / "wave.fst"
    if Tools.find().can_include("lz4.h", "zlib.h"):
        run(wave, "verilator")
        assert wave.stat().st_size > 1000
        assert wave.read_bytes()[:1] == b"\0"  # block type 0, the header of an FST
    else:
        with pytest.raises(InputError, match=r"apt-get install liblz4-dev zlib1g-dev\), install"):
            run(wave, "verilator")
        assert list(tmp_path.iterdir()) == []


def test_without_the_headers_of_fst(verilator, tmp_path, monkeypatch):
    monkeypatch.setattr(Tools, "can_include", lambda *_: False)
    with pytest.raises(InputError, match=r"wave\.fst: FST needs the headers .* or name the file"):
        run(tmp_path / "wave.fst", "verilator")


def test_whether_headers_are_there(verilator):
    assert Tools.find().can_include("vector", "cstdint")
    assert not Tools.find().can_include("vector", "no_such_header.h")


@pytest.mark.parametrize(
    ("engine", "name", "message"),
    [
        ("verilator", "wave.ghw", "not a wave format, name it .vcd or .fst"),
        ("amaranth", "wave.fst", "writes VCD only, name it .vcd or choose the engine verilator"),
        ("model", "wave.vcd", "the model has no waveform"),
        ("verilator", "no/wave.vcd", "cannot write to folder"),
        ("amaranth", "no/wave.vcd", "cannot write to folder"),
    ],
)
def test_a_wave_that_cannot_be_written(verilator, tmp_path, engine, name, message):
    with pytest.raises(InputError, match=message):
        run(tmp_path / name, engine)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("engine", ["verilator", "amaranth"])
def test_a_run_that_fails_leaves_no_wave(verilator, tmp_path, engine):
    bad = COUNTS.copy()
    bad[30, 2] = 1000
    chunks = [(COUNTS, None), (bad, None)]
    with pytest.raises(InputError, match="sample 70: gyro_z = 1000"):
        list(simulate(DESIGN, chunks, engine=engine, wave=Path(tmp_path / "wave.vcd")))
    assert list(tmp_path.iterdir()) == []
