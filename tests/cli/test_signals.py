"""SIGINT, SIGTERM and SIGHUP end a verb cleanly: no temporary file, no program left running."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tiers import few_of

HEADER = b"gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n"
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


def as_started_by_a_terminal() -> None:
    """In the child: whoever runs the tests may ignore these, which a child inherits."""
    for number in STATUS:
        signal.signal(number, signal.SIG_DFL)


def start(*words: object, **options: object) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "sculler", *map(str, words)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        preexec_fn=as_started_by_a_terminal,
        **options,  # type: ignore[call-overload]
    )


def wait_for(condition: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + 120
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.02)


def running(word: str) -> list[int]:
    """Processes with this word on their command line."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if word.encode() in (folder / "cmdline").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return found


@pytest.mark.parametrize("number", STATUS, ids=lambda number: number.name)
def test_while_a_log_is_read(tmp_path: Path, design: Path, number: signal.Signals) -> None:
    process = start("model", design, "-", "-o", tmp_path / "out.csv")
    assert process.stdin is not None
    process.stdin.write(HEADER + b"1,2,3,4,5,6\n" * 100)
    process.stdin.flush()
    wait_for(lambda: list(tmp_path.glob(".out.*.csv")), "the temporary file never came")
    process.send_signal(number)
    _, err = process.communicate(timeout=120)
    assert (process.returncode, err) == (STATUS[number], b"")
    assert [path.name for path in tmp_path.iterdir()] == ["little.toml"]


def test_a_burst_is_one_wish(tmp_path: Path, design: Path) -> None:
    """A session that ends sends SIGHUP and SIGTERM at once: the cleaning is not interrupted."""
    process = start("model", design, "-", "-o", tmp_path / "out.csv")
    assert process.stdin is not None
    process.stdin.write(HEADER)
    process.stdin.flush()
    wait_for(lambda: list(tmp_path.glob(".out.*.csv")), "the temporary file never came")
    for _ in range(5):
        process.send_signal(signal.SIGHUP)
        process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=120)
    assert process.returncode in (129, 143)
    assert err == b""
    assert [path.name for path in tmp_path.iterdir()] == ["little.toml"]


@pytest.mark.parametrize("number", few_of(list(STATUS), [signal.SIGINT]))
def test_while_a_compiler_runs(
    tmp_path: Path, design: Path, log: Path, number: signal.Signals
) -> None:
    """Nothing of the build stays in the cache, and what the compiler has started ends too."""
    mark = f"sculler-test-{os.getpid()}-{number}"
    compiler = tmp_path / "cxx"
    compiler.write_text(
        '#!/bin/sh\ncase "$1" in --version) echo 1; exit;; esac\n'
        f"{sys.executable} -c 'import time; time.sleep(300)' {mark} & wait\n"
    )
    compiler.chmod(0o755)
    cache = tmp_path / "cache"
    before = {path.name for path in tmp_path.iterdir()}
    process = start(
        "simulate", design, log, "-o", tmp_path / "out.csv",
        env={**os.environ, "CXX": str(compiler), "SCULLER_CACHE": str(cache)},
    )  # fmt: skip
    wait_for(lambda: running(mark), "the compiler never ran")
    assert list(cache.glob("build-*"))
    process.send_signal(number)
    _, err = process.communicate(timeout=120)
    assert (process.returncode, err) == (STATUS[number], b"")
    wait_for(lambda: not running(mark), "what the compiler has started goes on")
    assert not list(cache.glob("build-*"))
    assert not list(cache.glob(".*"))
    assert {path.name for path in tmp_path.iterdir()} - {"cache"} == before


def workers_of(process: subprocess.Popen[bytes]) -> list[int]:
    """Its children that do a campaign's work, once they have begun it."""
    found = []
    for pid in running("spawn_main"):
        try:
            stat = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        of, threads = int(stat[1]), int(stat[17])
        if of == process.pid and threads > 1:  # the second looks after its parent
            found.append(pid)
    return found


@pytest.mark.parametrize("number", few_of([signal.SIGTERM, signal.SIGKILL], [signal.SIGTERM]))
def test_a_campaigns_workers_end_with_it(tmp_path: Path, number: signal.Signals) -> None:
    """In the midst of long flights, and though nobody tells them to."""
    pytest.importorskip("pyarrow")
    pytest.importorskip("scipy")
    file = tmp_path / "campaign.toml"
    flight = 'runs = 8\nseconds = 7200.0\n[motion]\nname = "turn"\n'
    file.write_text(f'{flight}[initial]\nposition = 1.0\n[[design]]\npreset = "stim300"\n')
    process = start("campaign", file, "-o", tmp_path / "out", "--workers", 2)
    workers: list[int] = []
    try:
        wait_for(lambda: len(workers_of(process)) == 2, "the workers never began")
        workers += workers_of(process)
        process.send_signal(number)
        _, err = process.communicate(timeout=120)
        assert process.returncode == STATUS.get(number, -number)
        assert number == signal.SIGKILL or err == b""
        wait_for(lambda: not set(workers) & set(running("spawn_main")), "a worker goes on")
    finally:
        process.kill()
        for pid in set(workers) & set(running("spawn_main")):
            os.kill(pid, signal.SIGKILL)
    assert not list(tmp_path.rglob("*.parquet"))


def test_what_is_ignored_stays_ignored(tmp_path: Path, design: Path) -> None:
    """As under nohup."""
    process = subprocess.Popen(
        [sys.executable, "-m", "sculler", "model", str(design), "-", "-o", str(tmp_path / "o.csv")],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN),
    )  # fmt: skip
    assert process.stdin is not None
    process.stdin.write(HEADER + b"1,2,3,4,5,6\n" * 6)
    process.stdin.flush()
    wait_for(lambda: list(tmp_path.glob(".o.*.csv")), "the temporary file never came")
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=120)
    assert process.returncode == 0
    assert (tmp_path / "o.csv").read_text().count("\n") == 2
