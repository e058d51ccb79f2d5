"""Inputs that no program should have to bear: each gives one line, in a moment."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler_model import outputs as files_module
from sculler_model.design import MAX_BITS
from sculler_model.errors import InputError
from sculler_model.inputs import MAX_SMALL
from sculler_model.outputs import MAX_LINE, gathering, open_lines, replacing

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 47, "--lon", 8, "--height", 400)
NINES = "9" * 5000
"""More digits than Python converts."""


@pytest.fixture
def vectors(tmp_path: Path, run: Run, design: Path, log: Path) -> Path:
    path = tmp_path / "v.csv"
    assert run("model", design, log, "-o", path).status == 0
    return path


@pytest.mark.parametrize("key", ["sample_rate_hz", "bits", "samples", "minors"])
@pytest.mark.parametrize("number", [NINES, "-" + NINES, "1" + "0" * 400, "1e999"])
def test_long_numbers_in_a_design(
    tmp_path: Path, refused: Refused, design: Path, log: Path, key: str, number: str
) -> None:
    lines = design.read_text().replace(
        "bits = 16", f"bits = {number}" if key == "bits" else "bits = 16"
    )
    text = "\n".join(
        f"{key} = {number}" if line.startswith(f"{key} =") else line for line in lines.splitlines()
    )
    design.write_text(text)
    assert len(refused("model", design, log, "-o", tmp_path / "o.csv")) < 500


@pytest.mark.parametrize("value", ["[" * 3000 + "]" * 3000, "{a = " * 2000 + "1" + "}" * 2000])
def test_brackets_without_end(
    tmp_path: Path, refused: Refused, design: Path, log: Path, value: str
) -> None:
    design.write_text(design.read_text() + f"table = {value}\n")
    refused("model", design, log, "-o", tmp_path / "o.csv")


def test_long_numbers_in_logs_and_vectors(
    tmp_path: Path, refused: Refused, design: Path, log: Path, vectors: Path
) -> None:
    out = tmp_path / "o.csv"
    lines = log.read_text().splitlines()
    log.write_text("\n".join([*lines[:5], ",".join([NINES] * 6), *lines[5:], ""]))
    assert "line 6: gyro_x = 999" in refused("model", design, log, "-o", out)
    header, first, *rest = vectors.read_text().splitlines()
    for at, name in ((0, "major"), (1, "status"), (2, "alpha_x"), (19, "sculling_between_z")):
        cells = first.split(",")
        cells[at] = NINES
        vectors.write_text("\n".join([header, ",".join(cells), *rest, ""]))
        for words in (
            ("navigate", design, vectors, "-o", out, *PLACE),
            ("compare", vectors, vectors),
        ):
            assert f"line 2: {name} has 5000 digits" in refused(*words)


def test_long_numbers_in_options(tmp_path: Path, refused: Refused, design: Path, log: Path) -> None:
    out = tmp_path / "o.csv"
    for words in (
        ("simulate", design, log, "-o", out, "--stall", NINES),
        ("coefficients", "--family", "time-taylor", "--samples", NINES),
        ("navigate", design, log, "-o", out, "--lat", NINES, "--lon", 1, "--height", 1),
        ("motion", "rest", "--design", design, "-o", out, "--truth", tmp_path / "t", "--duration",
         NINES),
    ):  # fmt: skip
        assert len(refused(*words)) < 2500


def table(digits: int) -> str:
    return f"""
name = "wide"
[sensor]
kind = "increment"
sample_rate_hz = 600.0
gyro = {{ bits = 18, lsb = 1e-6 }}
accel = {{ bits = 16, lsb = 1e-3 }}
[algorithm]
family = "table"
samples = 3
minors = 4
[algorithm.table]
denominator = 80
taps = [[], [57], [{"7" * digits}, 57]]
"""


def test_taps_of_300_digits_are_refused_in_a_moment(
    tmp_path: Path, refused: Refused, log: Path
) -> None:
    design = tmp_path / "wide.toml"
    design.write_text(table(300))
    began = time.process_time()
    for words in (
        ("generate", design, "-o", tmp_path / "c"),
        ("model", design, log, "-o", "o.csv"),
    ):
        line = refused(*words)
        assert "algorithm.table: coning_within would have 1,0" in line
        assert f"{MAX_BITS} that a core can have" in line
    assert time.process_time() - began < 5


def test_the_limit_on_widths(tmp_path: Path, run: Run, refused: Refused) -> None:
    """By hand: a tap of d digits times two 18-bit counts, in two products, four minor intervals."""
    design = tmp_path / "wide.toml"
    # |tap + 57| 2^17 2^17 twice (a cross product), M = 4 times, sign: 17 + 17 + 1 + 2 + 1
    most = max(d for d in range(1, 300) if int("7" * d).bit_length() + 38 <= MAX_BITS)
    design.write_text(table(most))
    assert run("coefficients", "--design", design, "--json").status == 0
    design.write_text(table(most + 1))
    refused("coefficients", "--design", design, "--json")


def test_the_widest_published_table_is_within_the_limit() -> None:
    from sculler_model.design import Design

    Design.parse({
        "name": "widest",
        "sensor": {"kind": "rate", "sample_rate_hz": 100.0, "gyro": {"bits": 32, "lsb": 1e-9},
                   "accel": {"bits": 32, "lsb": 1e-7}},
        "algorithm": {"family": "filtered-rate", "samples": 16, "history": 16, "minors": 4096},
    })  # fmt: skip


ZERO = "/dev/zero"


def test_devices_without_end(
    tmp_path: Path, refused: Refused, design: Path, log: Path, vectors: Path
) -> None:
    out = tmp_path / "o.csv"
    tuned = tmp_path / "tuned.toml"
    tuned.write_text(
        design.read_text().replace("frequency-taylor", "tuned").replace("history = 1", "")
        + f'filter = {{ kind = "measured", file = "{ZERO}" }}\ndenominator_bits = 12\n'
    )
    began = time.process_time()
    for words in (
        ("model", ZERO, log, "-o", out),
        ("model", tuned, log, "-o", out),
        ("model", design, ZERO, "-o", out),
        ("simulate", design, ZERO, "-o", out),
        ("convert", ZERO, "-o", out, "--design", design),
        ("convert", ZERO, "-o", out, "--design", design, "--format", "kfgins-binary"),
        ("navigate", design, ZERO, "-o", out, *PLACE),
        ("navigate", design, vectors, "-o", out, "--truth", ZERO),
        ("compare", ZERO, vectors),
        ("compare", vectors, ZERO),
        ("advise", design, "--spectrum", ZERO, "--drift", 1),
        ("analyze", "vibration", design, "--spectrum", ZERO),
    ):
        line = refused(*words)
        assert f"{ZERO}: " in line
    assert time.process_time() - began < 20


def test_folders(tmp_path: Path, refused: Refused, design: Path, log: Path, vectors: Path) -> None:
    out = tmp_path / "o.csv"
    for words in (
        ("model", tmp_path, log, "-o", out),
        ("model", design, tmp_path, "-o", out),
        ("convert", tmp_path, "-o", out, "--design", design),
        ("navigate", design, tmp_path, "-o", out, *PLACE),
        ("navigate", design, vectors, "-o", out, "--truth", tmp_path),
        ("compare", vectors, tmp_path),
        ("advise", design, "--spectrum", tmp_path, "--drift", 1),
    ):
        assert f"{tmp_path}: " in refused(*words)


def test_pipes(tmp_path: Path, run: Run, refused: Refused, design: Path, log: Path) -> None:
    """What is read once may come from a pipe, as of `<(...)`; what is read twice says so."""
    pipe, out = tmp_path / "pipe", tmp_path / "o.csv"
    os.mkfifo(pipe)

    def fed(content: bytes, *words: object) -> Any:
        feeder = threading.Thread(target=pipe.write_bytes, args=(content,))
        feeder.start()
        outcome = run(*words)
        feeder.join(timeout=10)
        assert not feeder.is_alive()
        return outcome

    assert fed(log.read_bytes(), "model", design, pipe, "-o", out).status == 0
    vectors = out.read_bytes()
    assert fed(design.read_bytes(), "model", pipe, log, "-o", out).status == 0
    assert fed(vectors, "navigate", design, pipe, "-o", tmp_path / "n.csv", *PLACE).status == 0
    outcome = fed(vectors, "compare", pipe, out)
    assert (outcome.status, outcome.out) == (0, "identical\n")
    assert "is a pipe" in refused("convert", pipe, "-o", tmp_path / "c.csv", "--design", design)
    assert "is a pipe" in refused("navigate", design, out, "-o", tmp_path / "c", "--truth", pipe)


def test_a_line_without_end(tmp_path: Path) -> None:
    path = tmp_path / "long.csv"
    path.write_text("a,b\n" + "1" * (2 * MAX_LINE) + "\n")
    with (
        open_lines(path) as file,
        pytest.raises(InputError, match=r"long.csv: a line of more than"),
    ):
        list(file)
    path.write_text("".join("1" * (MAX_LINE // 2) + "\n" for _ in range(9)))
    with open_lines(path) as file:
        assert [len(line) for line in file] == [MAX_LINE // 2 + 1] * 9


def test_the_limit_on_small_files(tmp_path: Path, run: Run, refused: Refused, design: Path) -> None:
    text = design.read_text()
    design.write_text(text + "#" * (MAX_SMALL - len(text) - 1) + "\n")
    assert run("coefficients", "--design", design).status == 0
    design.write_text(design.read_text() + "#")
    assert "longer than 4 MiB" in refused("coefficients", "--design", design)


@pytest.fixture
def full(tmp_path: Path) -> Any:
    """A file system of 64 KiB."""
    folder = tmp_path / "full"
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)],
        capture_output=True, check=False,
    )  # fmt: skip
    if mounted.returncode:
        pytest.skip("needs to mount a small file system, which root may")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


LONG = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n" + "1,2,3,-4,5,-6\n" * 12_000


def test_a_full_disk_is_told_as_such(
    tmp_path: Path, full: Path, run: Run, design: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log, vectors = tmp_path / "long.csv", tmp_path / "v.csv"
    log.write_text(LONG)
    assert run("model", design, log, "-o", vectors).status == 0
    counts = ("--gyro-unit", "counts", "--accel-unit", "counts")
    nav = ("navigate", design, vectors, *PLACE, "-o")
    cases: list[tuple[Path, tuple[object, ...]]] = [
        (full / "o.csv", ("model", design, log, "-o", full / "o.csv")),
        (full / "c.csv", ("convert", log, "-o", full / "c.csv", "--design", design, *counts)),
        (full / "n.csv", (*nav, full / "n.csv", "--no-plots")),
        (full / "w.vcd", ("simulate", design, log, "-o", tmp_path / "o.csv", "--wave",
                          full / "w.vcd")),
        (full / "core", ("generate", design, "-o", full / "core")),
        (full / "p.png", ("analyze", "coning", design, "--points", 20, "-o", full / "p.png")),
        (full / "t.csv", ("motion", "rest", "--design", design, "-o", tmp_path / "l.csv",
                          "--truth", full / "t.csv", "--duration", 30)),
    ]  # fmt: skip
    for path, words in cases:
        outcome = run(*words)
        assert (outcome.status, outcome.out) == (2, ""), words
        assert outcome.err.startswith(f"sculler: {path}: the disk is full"), words
        assert "free some space or give another place" in outcome.err
        assert outcome.err.count("\n") == 1
        assert [left for left in full.rglob("*") if left.is_file()] == []
        (full / "core").rmdir() if (full / "core").exists() else None
    monkeypatch.setenv("SCULLER_CACHE", str(full / "cache"))
    outcome = run("simulate", design, log, "-o", tmp_path / "o.csv", "--engine", "verilator")
    assert outcome.status == 2
    assert "disk" in outcome.err
    assert "full" in outcome.err
    assert "SCULLER_CACHE" in outcome.err
    assert outcome.err.count("\n") == 1
    assert [left.name for left in full.rglob("*") if left.name.startswith((".", "build-"))] == []


def test_devices_that_are_full(tmp_path: Path, run: Run, design: Path, log: Path) -> None:
    outcome = run("model", design, log, "-o", "/dev/full")
    assert outcome.status == 2
    assert outcome.err.startswith("sculler: /dev/full: the disk is full")
    with Path("/dev/full").open("wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "sculler", "coefficients", "--design", str(design)],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "sculler: standard output: No space left on device; free some space\n"


@pytest.mark.parametrize("closed", ["stdout", "stderr"])
def test_streams_that_are_closed(design: Path, closed: str) -> None:
    redirect = {"stdout": ">&-", "stderr": "2>&-"}[closed]
    done = subprocess.run(
        ["sh", "-c", f'"$@" {redirect}', "sh", sys.executable, "-m", "sculler", "coefficients",
         "--design", str(design) if closed == "stdout" else "absent"],
        capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == (0 if closed == "stdout" else 2)
    assert (done.stdout, done.stderr) == (b"", b"")


def test_a_limit_on_files(tmp_path: Path, design: Path) -> None:
    """`ulimit -f`: SIGXFSZ is ignored, the write fails, the temporary file goes."""
    log, out = tmp_path / "long.csv", tmp_path / "o.csv"
    log.write_text(LONG)
    done = subprocess.run(
        [sys.executable, "-m", "sculler", "model", str(design), str(log), "-o", str(out)],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000)),
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith(f"sculler: {out}: larger than the limit on files allows")
    assert done.stderr.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["little.toml", "long.csv"]


@pytest.mark.parametrize("day", [0, 2], ids=["of today", "of before yesterday"])
def test_old_litter_is_swept(tmp_path: Path, day: int) -> None:
    litter = [tmp_path / ".o.0123abcd.csv", tmp_path / ".sculler-ab12_x9z"]
    litter[0].write_text("half")
    litter[1].mkdir()
    (litter[1] / "half.v").write_text("half")
    others = [tmp_path / name for name in (".o.csv", ".p.0123abcd.csv", ".o.0123abcd.txt", "o.csv")]
    for path in others:
        path.write_text("somebody's")
    before = time.time() - day * files_module.LITTER_AGE
    for path in (*litter, *others):
        os.utime(path, (before, before))
    with replacing(tmp_path / "o.csv") as temporary:
        temporary.write_text("whole")
    with gathering(tmp_path) as folder:
        (folder / "x").write_text("whole")
    assert [path.exists() for path in litter] == [day == 0] * 2
    assert all(path.exists() for path in others)
    assert (tmp_path / "o.csv").read_text() == "whole"
    assert (tmp_path / "x").read_text() == "whole"


def test_a_gathered_file_replaces_no_folder(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()

    def gather() -> None:
        with gathering(tmp_path) as folder:
            (folder / "a").write_text("x")
            (folder / "b").write_text("x")

    with pytest.raises(InputError, match="b: is a folder"):
        gather()
    assert [path.name for path in tmp_path.iterdir()] == ["b"]


def test_an_npz_of_another_packer(tmp_path: Path, refused: Refused, design: Path) -> None:
    """The number of the compression method in the zip's headers, changed to one nobody has."""
    path = tmp_path / "log.npz"
    np.savez(path, dtheta=np.zeros((9, 3)), dvel=np.zeros((9, 3)))
    content = bytearray(path.read_bytes())
    for magic, at in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        start = 0
        while (start := content.find(magic, start)) >= 0:
            content[start + at] = 77
            start += 4
    path.write_bytes(bytes(content))
    line = refused("convert", path, "-o", tmp_path / "o.csv", "--design", design)
    assert "not a whole .npz file (That compression method is not supported)" in line
