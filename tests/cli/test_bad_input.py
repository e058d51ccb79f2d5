"""Bad input of every kind: status 2, one clear line, nothing half-written, no traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sculler.commands import analyze
from sculler.main import VERBS
from sculler_sim.engines.verilator_build import Tools

Run = Callable[..., Any]
Refused = Callable[..., str]

HEADER = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
GOOD = (Path(__file__).parents[2] / "examples/stim300_4x5.toml").read_text()

DESIGNS = {
    "missing key": (
        GOOD.replace("sample_rate_hz = 2000.0", ""),
        ("sensor.sample_rate_hz: missing",),
    ),
    "missing table": (GOOD[: GOOD.index("[algorithm]")], ("algorithm: missing",)),
    "unknown key": (GOOD.replace("minors ", "minor "), ("algorithm.minor: unknown key", "minors")),
    "out of range": (GOOD.replace("samples = 4", "samples = 17"), ("algorithm.samples: 17", "16")),
    "wrong type": (
        GOOD.replace("bits = 24", 'bits = "24"'),
        ("sensor.gyro.bits", "sensor.accel.bits"),
    ),
    "several": (
        GOOD.replace("minors  = 5", "minors = 0").replace("2000.0", "-1.0"),
        ("algorithm.minors: 0", "sensor.sample_rate_hz: -1.0"),
    ),
    "inconsistent table": (
        GOOD.replace('"frequency-taylor"', '"table"')
        + "\n[algorithm.table]\ndenominator = 0\ntaps = [[1], [2]]\n",
        ("denominator",),
    ),
    "too few rows": (
        GOOD.replace('"frequency-taylor"', '"table"')
        + "\n[algorithm.table]\ndenominator = 3\ntaps = [[1], [2]]\n",
        ("algorithm.table: taps: 2 rows for samples = 4",),
    ),
    "no TOML": ("name: stim300\n", ("not valid TOML",)),
    "NaN": (GOOD.replace("2000.0", "nan"), ("sensor.sample_rate_hz",)),
}


@pytest.mark.parametrize("case", DESIGNS)
def test_designs(tmp_path: Path, refused: Refused, log: Path, case: str) -> None:
    content, messages = DESIGNS[case]
    design = tmp_path / "design.toml"
    design.write_text(content)
    out = tmp_path / "out.csv"
    for words in (
        ("generate", design, "-o", tmp_path / "core"),
        ("model", design, log, "-o", out),
        ("simulate", design, log, "-o", out),
        ("convert", log, "-o", out, "--design", design),
        ("navigate", design, log, "-o", out, "--lat", 0, "--lon", 0, "--height", 0),
        ("coefficients", "--design", design),
    ):
        line = refused(*words)
        assert f"{design}: " in line
        for message in messages:
            assert message in line


def test_absent_design_names_the_presets(tmp_path: Path, refused: Refused, log: Path) -> None:
    line = refused("model", tmp_path / "absent.toml", log, "-o", tmp_path / "out.csv")
    assert "no such design file" in line
    assert "stim300" in line


LOGS = {
    "missing column": ("gyro_x,gyro_y,gyro_z,accel_x,accel_y\n1,2,3,4,5\n", "accel_z is missing"),
    "non-integer": (f"{HEADER}\n1,2,3,4,5,6\n1,2,3.5,4,5,6\n", "line 3: gyro_z is '3.5'"),
    "NaN": (f"{HEADER}\n1,2,3,4,5,6\n1,2,3,4,NaN,6\n", "line 3: accel_y is 'NaN'"),
    "too wide": (f"{HEADER}\n1,2,3,4,5,2048\n", "does not fit the sensor's 12 bits"),
    "empty": ("", "the log is empty"),
    "header only": (f"{HEADER}\n", "no samples"),
    "cut short": (f"{HEADER}\n1,2,3,4,5,6\n1,2,3", "line 3"),
}


@pytest.mark.parametrize("case", LOGS)
@pytest.mark.parametrize("verb", ["model", "simulate"])
def test_logs(tmp_path: Path, refused: Refused, design: Path, verb: str, case: str) -> None:
    content, message = LOGS[case]
    log = tmp_path / "log.csv"
    log.write_text(content)
    line = refused(verb, design, log, "-o", tmp_path / "out.csv")
    assert message in line
    assert f"{log}: " in line


@pytest.mark.parametrize(
    ("rows", "block"), [(12_000, 1 << 12), pytest.param(200_000, None, marks=pytest.mark.deep)]
)
def test_fault_far_into_a_log_leaves_no_output(
    tmp_path: Path,
    refused: Refused,
    design: Path,
    monkeypatch: pytest.MonkeyPatch,
    rows: int,
    block: int | None,
) -> None:
    """Results have been written by then; they go, and what was there before stays."""
    if block is not None:  # some thirty blocks of a small log
        monkeypatch.setattr("sculler.formats.lines.BLOCK_BYTES", block)
    log, out = tmp_path / "log.csv", tmp_path / "out.csv"
    log.write_text(f"{HEADER}\n" + "1,2,3,4,5,6\n" * rows + "1,2,3,4,5,x\n")
    out.write_text("precious")
    for verb in ("model", "simulate"):
        assert f"line {rows + 2}" in refused(verb, design, log, "-o", out)
        assert out.read_text() == "precious"


@pytest.mark.parametrize("parent", ["file.txt", "absent", "/proc/sculler"])
def test_output_that_cannot_be_written(
    tmp_path: Path, refused: Refused, design: Path, log: Path, parent: str
) -> None:
    (tmp_path / "file.txt").write_text("a file, not a folder")
    out = tmp_path / parent / "out.csv"
    refused("model", design, log, "-o", out)
    refused("simulate", design, log, "-o", out)
    refused("convert", log, "-o", out, "--design", design, "--gyro-unit", "counts",
            "--accel-unit", "counts")  # fmt: skip
    refused("navigate", design, log, "-o", out, "--lat", 0, "--lon", 0, "--height", 0)
    if parent != "absent":
        assert parent in refused("generate", design, "-o", out.parent / "core")
        assert parent in refused("demo", "-o", out.parent / "demo", "--seconds", 1)


def test_output_that_is_a_folder(tmp_path: Path, refused: Refused, design: Path, log: Path) -> None:
    assert "is a directory" in refused("model", design, log, "-o", tmp_path)
    (tmp_path / "taken").write_text("")
    assert "taken" in refused("generate", design, "-o", tmp_path / "taken")


@pytest.mark.deep
def test_waveform_that_cannot_be_written(
    tmp_path: Path, refused: Refused, design: Path, log: Path
) -> None:
    words = ("simulate", design, log, "-o", tmp_path / "out.csv", "--wave")
    assert ".fst" in refused(*words, tmp_path / "wave.txt")
    refused(*words, tmp_path / "absent" / "wave.vcd")
    assert "VCD only" in refused(*words, tmp_path / "wave.fst", "--engine", "amaranth")


def test_no_compiler(
    tmp_path: Path,
    run: Run,
    refused: Refused,
    design: Path,
    log: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    empty = tmp_path / "empty"
    empty.mkdir()
    monkeypatch.setenv("PATH", str(empty))
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setenv("SCULLER_CACHE", str(tmp_path / "empty"))
    words = ("simulate", design, log, "-o", tmp_path / "out.csv")
    assert "C++ compiler" in refused(*words, "--engine", "verilator")
    outcome = run(*words, "--json")  # whatever there is does the work, and it is said
    said = json.loads(outcome.out)
    assert (outcome.status, said["engine"], said["results"]) == (0, "amaranth", 4)
    assert "C++ compiler" in said["warnings"][0]
    monkeypatch.setenv("CXX", "no-such-compiler")
    assert "no-such-compiler" in refused(*words)
    assert "no-such-compiler" in refused("demo", "-o", tmp_path / "demo", "--seconds", 1)


USAGE = {
    "unknown verb": (("teach",), "No such command 'teach'"),
    "no arguments": (("model",), "Missing argument 'DESIGN'"),
    "no output": (("model", "d", "l"), "Missing option '-o'"),
    "unknown option": (("compare", "a", "b", "--fast"), "--fast"),
    "wrong engine": (("model", "d", "l", "-o", "x", "--engine", "slow"), "'slow'"),
    "negative seed": (("simulate", "d", "l", "-o", "x", "--stall", "-1"), "-1"),
    "seed of letters": (("simulate", "d", "l", "-o", "x", "--stall", "a"), "'a'"),
    "too short a demo": (
        ("demo", "--seconds", "0"),
        "'0' is not allowed, give a finite number >= 1 and <= 3600",
    ),
    "NaN for a number": (("demo", "--seconds", "nan"), "give a finite number"),
}


@pytest.mark.parametrize("case", USAGE)
def test_usage(refused: Refused, case: str) -> None:
    words, message = USAGE[case]
    line = refused(*words)
    assert message in line
    assert "--help'" in line


COMMANDS = [
    *((verb,) for verb in VERBS if verb != "analyze"),
    *(("analyze", study) for study in analyze.VERBS),
]


@pytest.mark.parametrize("command", [*COMMANDS, ("analyze",)], ids=" ".join)
def test_every_verb_has_help_with_an_example(run: Run, command: tuple[str, ...]) -> None:
    outcome = run(*command, "--help")
    assert (outcome.status, outcome.err) == (0, "")
    assert f"sculler {' '.join(command)}" in outcome.out[outcome.out.index("Example") :]
    assert command[-1] in run(*command[:-1], "--help").out


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_verb_speaks_json(run: Run, command: tuple[str, ...]) -> None:
    assert "--json" in run(*command, "--help").out


def sculler(*words: object, **options: Any) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sculler", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, **options)


def test_as_a_process(tmp_path: Path, design: Path, log: Path) -> None:
    out = tmp_path / "out.csv"
    done = sculler("model", design, log, "-o", out)
    assert (done.returncode, done.stderr) == (0, "")
    other = tmp_path / "other.csv"
    other.write_text(out.read_text().replace("\n1,", "\n9,", 1))
    assert sculler("compare", out, other).returncode in (1, 2)
    done = sculler("model", design, tmp_path / "absent.csv", "-o", out)
    assert done.returncode == 2
    assert done.stderr.startswith("sculler: ")
    assert done.stderr.count("\n") == 1
    assert sculler("--version").stdout.startswith("sculler 0.")


def test_help_is_quick_because_nothing_heavy_is_imported() -> None:
    code = (
        "import sys; from sculler.main import main; main(['--help']);"
        " print(sorted({'numpy', 'pydantic', 'amaranth', 'matplotlib', 'rich'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_a_reader_that_goes_away_is_no_fault(design: Path) -> None:
    command = [sys.executable, "-m", "sculler", "coefficients", "--design", str(design)]
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(command, stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert done.stderr == ""
    assert done.returncode == 141


def test_tools_are_here() -> None:
    """The tests of the simulator mean something only where its tools are."""
    assert Tools.find().compiler
