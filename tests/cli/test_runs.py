"""`model`, `simulate`, `compare`, `generate`: the exact path through the command line."""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler_model.design import COLUMNS, Design

Run = Callable[..., Any]
Refused = Callable[..., str]

HEADER = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"


@pytest.fixture
def model(run: Run, tmp_path: Path, design: Path, log: Path) -> Path:
    """Vectors of the little design."""
    out = tmp_path / "model.csv"
    assert run("model", design, log, "-o", out).status == 0
    return out


def test_model_by_hand(run: Run, tmp_path: Path) -> None:
    """Two samples, n = 2, M = 1: every number worked out on paper."""
    design = tmp_path / "two.toml"
    design.write_text(
        'preset = "stim300"\nname = "two"\n[algorithm]\nsamples = 2\nhistory = 0\nminors = 1\n'
    )
    log = tmp_path / "log.csv"
    log.write_text(f"{HEADER},fault\n1,0,0,0,5,0,0\n0,1,0,0,0,7,1\n")
    for engine in ("fast", "reference"):
        out = tmp_path / f"{engine}.csv"
        assert run("model", design, log, "-o", out, "--engine", engine).status == 0
        rows = out.read_text().splitlines()
        assert rows[0] == ",".join(COLUMNS)
        # over 3: 2 s1 x s2 = 2 z; 2 s1 x r2 + 2 r1 x s2 = 2 x X 7 z + 10 y X y = -14 y
        assert rows[1:] == ["0,2,1,1,0,0,0,2,0,0,0,0,5,7,0,-14,0,0,0,0"]


def test_what_model_says(run: Run, tmp_path: Path, design: Path, log: Path) -> None:
    out = tmp_path / "out.csv"
    outcome = run("model", design, log, "-o", out)
    assert (outcome.status, outcome.err) == (0, "")
    assert "the last interval has only 3 of 6 samples and gives no result" in outcome.out
    assert "1 result reached before the first sample" in outcome.out
    said = json.loads(run("model", design, log, "-o", out, "--json").out)
    assert (said["samples"], said["results"], said["leftover_samples"]) == (27, 4, 3)
    assert said["short_history_results"] == 1
    assert said["fault_results"] == said["loss_results"] == 0
    assert said["rail_results"] == 2  # both ends of the gyro, then of the accelerometer
    assert "2 results with counts at their rails" in outcome.out
    assert len(out.read_text().splitlines()) == 5


@pytest.mark.parametrize("engine", ["verilator", "amaranth"])
@pytest.mark.parametrize("stall", [(), ("--stall", 7)], ids=["no stalls", "stalls"])
def test_simulation_is_identical(
    run: Run, tmp_path: Path, design: Path, log: Path, model: Path, engine: str, stall: Any
) -> None:
    out = tmp_path / "rtl.csv"
    outcome = run("simulate", design, log, "-o", out, "--engine", engine, *stall, "--json")
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    assert (said["samples"], said["results"], said["leftover_samples"]) == (27, 4, 3)
    assert said["clocks"] >= 27
    assert out.read_bytes() == model.read_bytes()
    outcome = run("compare", model, out)
    assert (outcome.status, outcome.out, outcome.err) == (0, "identical: 4 rows\n", "")


@pytest.mark.parametrize("engine", ["verilator", "amaranth"])
def test_waveform(run: Run, tmp_path: Path, design: Path, log: Path, engine: str) -> None:
    wave = tmp_path / "wave.vcd"
    words = ("-o", tmp_path / "rtl.csv", "--engine", engine, "--wave", wave)
    assert run("simulate", design, log, *words).status == 0
    assert "sample_valid" in wave.read_text()


def test_reference_and_fast_with_stdin(
    run: Run, tmp_path: Path, design: Path, log: Path, model: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "reference.csv"
    with log.open() as stdin:
        monkeypatch.setattr("sys.stdin", stdin)
        assert run("model", design, "-", "-o", out, "--engine", "reference").status == 0
    assert out.read_bytes() == model.read_bytes()


def test_column_order_does_not_matter(
    run: Run, tmp_path: Path, design: Path, counts: np.ndarray, model: Path
) -> None:
    turned = tmp_path / "turned.csv"
    header = ",".join(reversed(HEADER.split(",")))
    rows = [",".join(map(str, reversed(row))) for row in counts.tolist()]
    turned.write_text("\n".join([header, *rows]) + "\n")
    out = tmp_path / "out.csv"
    assert run("model", design, turned, "-o", out).status == 0
    assert out.read_bytes() == model.read_bytes()


def test_compare_names_the_first_difference(run: Run, tmp_path: Path, model: Path) -> None:
    lines = model.read_text().splitlines()
    cells = lines[3].split(",")
    at = COLUMNS.index("nu_y")
    right, wrong = int(cells[at]), int(cells[at]) + 1
    cells[at] = str(wrong)
    cells[at + 2] = "0"
    other = tmp_path / "other.csv"
    other.write_text("\n".join([*lines[:3], ",".join(cells), lines[4]]) + "\n")
    outcome = run("compare", model, other)
    assert outcome.status == 1
    assert outcome.err == ""
    assert "major 2" in outcome.out
    assert f"nu_y: {right} in {model}, {wrong} in {other}" in outcome.out
    said = json.loads(run("compare", model, other, "--json").out)
    assert said["identical"] is False
    assert said["difference"] == {
        "row": 2,
        "major": 2,
        "column": "nu_y",
        "first": right,
        "second": wrong,
    }


def test_compare_sees_a_missing_row(run: Run, tmp_path: Path, model: Path) -> None:
    other = tmp_path / "other.csv"
    other.write_text("".join(model.read_text().splitlines(keepends=True)[:-1]))
    for pair in ((model, other), (other, model)):
        outcome = run("compare", *pair)
        assert outcome.status == 1
        assert "ends after 3 rows" in outcome.out


def test_compare_refuses_what_are_no_vectors(
    tmp_path: Path, refused: Refused, model: Path, log: Path
) -> None:
    cut = tmp_path / "cut.csv"
    cut.write_bytes(model.read_bytes()[:-3])
    assert "cut short" in refused("compare", model, cut)
    assert "header" in refused("compare", model, log)
    assert "cannot read" in refused("compare", model, tmp_path / "absent.csv")


def test_generate(run: Run, tmp_path: Path, design: Path) -> None:
    folder = tmp_path / "a" / "core"
    outcome = run("generate", design, "-o", folder, "--json")
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    names = {path.name for path in folder.iterdir()}
    assert {"little.v", "little.json", "little_tb.v", "README.md"} <= names
    assert {Path(file).name for file in said["files"]} == names
    verilog = (folder / "little.v").read_bytes()
    manifest = json.loads((folder / "little.json").read_text())
    assert hashlib.sha256(verilog).hexdigest() == manifest["verilog_sha256"]
    assert Design.parse(manifest["design"]) == Design.load(design)
    assert said["latency_clocks"] == manifest["latency_clocks"]

    again = tmp_path / "again"
    assert run("generate", design, "-o", again).status == 0
    for name in names:
        assert (again / name).read_bytes() == (folder / name).read_bytes(), name


def test_generate_goes_to_build_by_default(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("generate", "stim300").status == 0
    assert (tmp_path / "build/stim300_4x5/stim300_4x5.v").is_file()


@pytest.mark.skipif(shutil.which("iverilog") is None, reason="Icarus Verilog is not installed")
def test_generated_bench_passes_in_icarus(run: Run, tmp_path: Path, design: Path) -> None:
    folder = tmp_path / "core"
    assert run("generate", design, "-o", folder).status == 0
    compile_it = ["iverilog", "-g2005", "-o", "bench", "little_tb.v", "little.v"]
    subprocess.run(compile_it, cwd=folder, check=True)
    out = subprocess.run(
        ["vvp", "bench"], cwd=folder, check=True, capture_output=True, text=True
    ).stdout
    assert "PASS" in out.splitlines()[-1]


@pytest.mark.parametrize("verb", ["model", "simulate"])
def test_implausible_counts_are_told_with_their_line(
    run: Run, tmp_path: Path, design: Path, verb: str
) -> None:
    """A lone spike, and all counts at zero for two seconds: said, not refused."""
    rng = np.random.default_rng(3)
    counts = np.rint(rng.normal(0, 3, (4000, 6))).astype(int)
    counts[700, 1] = 30_000
    counts[1500:3500] = 0
    log = tmp_path / "log.csv"
    np.savetxt(log, counts, "%d", ",", header=HEADER, comments="")
    outcome = run(verb, design, log, "-o", tmp_path / "out.csv", "--json")
    assert outcome.status == 0, outcome.err
    spike, zero = json.loads(outcome.out)["warnings"]
    assert spike.startswith("gyro_y is 30000 at line 702, more than a thousand times the rest")
    assert zero.startswith("all six counts are 0 from line 1502 on for 2,000 samples")
    assert "warning 2" in run(verb, design, log, "-o", tmp_path / "out.csv").out
