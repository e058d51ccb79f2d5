"""A copy of the tree, and what the tests say of a mutant in it."""

from __future__ import annotations

import os
import py_compile
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from py_compile import PycInvalidationMode

from sculler_model.errors import InputError
from studies.mutate_python.changes import Change
from studies.mutate_python.subjects import ROOT, Subject

PACKAGES = ("cli", "hdl", "model", "sim")
KEPT = (*PACKAGES, "tests", "studies", "docs", "examples", "pyproject.toml")

CPU_FACTOR, CPU_MORE = 3, 20
"""Limit of a run: so many times the CPU time of the tests without a mutant, and so many seconds."""

MEMORY = 4 << 30
"""Limit of a run, bytes."""

HANG = 3600
"""Seconds after which a run that waits and does not compute is ended."""


@dataclass(frozen=True)
class Said:
    """What came of a run.

    Attributes:
        passed: whether all tests passed.
        by: the first test that did not, or "time" for one that was ended, or the end of what
            pytest said where it did not get to the tests.
        seconds: of CPU time.
    """

    passed: bool
    by: str
    seconds: float


def copy(folder: Path) -> Path:
    """A copy of the project without what was built."""
    for name in KEPT:
        of, to = ROOT / name, folder / name
        if of.is_dir():
            shutil.copytree(of, to, ignore=shutil.ignore_patterns("__pycache__", ".hypothesis"))
        else:
            shutil.copy(of, to)
    return folder


def limit_of(root: Path, subject: Subject) -> int:
    """CPU seconds that the tests of a mutant may take: by what they take in the copy without one.

    What is compiled to bytecode is kept.  That of the subject goes by content, not by time, for
    mutants come and go within a second.

    Raises:
        InputError: they do not pass.
    """
    for path in subject.sources:
        py_compile.compile(str(root / path), invalidation_mode=PycInvalidationMode.CHECKED_HASH)
    said = _run(root, subject, None, subject.tests)
    if not said.passed:
        raise InputError(f"the tests do not pass without a mutant: {said.by}")
    return int(CPU_FACTOR * said.seconds) + CPU_MORE


def tried(root: Path, subject: Subject, change: Change, limit: int) -> Said:
    """What the tests say of a mutant.

    Args:
        root: a copy of the project.
        subject: whose tests run until one fails, those named like the source first.
        change: the mutant.
        limit: CPU seconds.
    """
    path = root / change.path
    whole = path.read_text(encoding="utf-8")
    path.write_text(change.text, encoding="utf-8")
    try:
        return _run(
            root, subject, limit, sorted(subject.tests, key=lambda test: path.stem not in test)
        )
    finally:
        path.write_text(whole, encoding="utf-8")


def _run(root: Path, subject: Subject, limit: int | None, tests: Sequence[str]) -> Said:
    """Run fast tests of a subject in a copy until one fails, in so many CPU seconds."""

    def limited() -> None:
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))

    packages = os.pathsep.join(str(root / name) for name in PACKAGES)
    environment = {
        **os.environ,
        "PYTHONPATH": packages,
        "NUMBA_DISABLE_JIT": "1",  # what is compiled runs in Python: it is the same source
        "PYTHONDONTWRITEBYTECODE": "" if limit is None else "1",  # tests are compiled once
    }
    options = ["-m", "not deep", "-x", "-q", "--tb=no", "-p", "no:cacheprovider"]
    steady = ["-p", "studies.mutate_python.steady"]
    wanted = ["-k", " and ".join(f"not {word}" for word in subject.but)] if subject.but else []
    command = [sys.executable, "-m", "pytest", *options, *steady, *wanted]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    running = subprocess.Popen(
        [*command, *(f"tests/{name}" for name in tests)],
        cwd=root, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, start_new_session=True, preexec_fn=limited,
    )  # fmt: skip
    try:
        text, _ = running.communicate(timeout=HANG)
    except subprocess.TimeoutExpired:
        text = ""
    finally:
        if running.poll() is None:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Said(running.returncode == 0, _by(running.returncode, text), round(seconds, 2))


def _by(status: int, text: str) -> str:
    """What ended a run."""
    if status == 0:
        return ""
    if status < 0:
        return "time" if -status in (signal.SIGXCPU, signal.SIGKILL) else f"signal {-status}"
    failed = [line.split()[1] for line in text.splitlines() if line.startswith(("FAILED", "ERROR"))]
    if failed:
        return failed[0].removeprefix("tests/")
    return " ".join(text.split())[-120:]
