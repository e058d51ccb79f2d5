"""Making a fault in a copy of the project, and what the tests say to it."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from breaks.faults import ROOT, SOURCES, Fault

KEPT = (*SOURCES, "tests", "studies", "docs", "examples", "pyproject.toml")


class Caught(NamedTuple):
    """What found a fault."""

    test: str
    """Its name, without the case; "" where none did."""
    seconds: float
    """CPU time of the run that ended with it: start, collection and the tests before."""
    said: str
    """The end of what pytest said."""


def copy(folder: Path) -> Path:
    """A copy of the project, without what was built."""
    for name in KEPT:
        of, to = ROOT / name, folder / name
        if of.is_dir():
            shutil.copytree(of, to, ignore=shutil.ignore_patterns("__pycache__", ".hypothesis"))
        else:
            shutil.copy(of, to)
    return folder


@contextmanager
def made(fault: Fault, root: Path) -> Iterator[None]:
    """The fault, in a copy, for a while."""
    path = root / fault.place(root)
    whole = path.read_text(encoding="utf-8")
    path.write_text(whole.replace(fault.line, fault.wrong), encoding="utf-8")
    try:
        yield
    finally:
        path.write_text(whole, encoding="utf-8")


def run(fault: Fault, root: Path) -> Caught:
    """Run the fault's tests of the fast tier in a copy, until one fails."""
    packages = os.pathsep.join(str(root / name) for name in SOURCES)
    environment = {**os.environ, "PYTHONPATH": packages, "PYTHONDONTWRITEBYTECODE": "1"}
    for name in [name for name in environment if name.startswith("PYTEST")]:
        del environment[name]
    tests = [str(root / "tests" / name) for name in fault.tests]
    options = ["-m", "not deep", "-x", "-q", "-n", "0", "-p", "no:cacheprovider", "--tb=short"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *tests],
        cwd=root, env=environment, capture_output=True, text=True, check=False,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    failed = re.search(r"^(?:FAILED|ERROR) tests/([^\s\[]+)", done.stdout, re.M)
    if done.returncode not in (0, 1):
        failed = None  # pytest itself did not get to the tests
    return Caught(failed[1] if failed else "", seconds, f"{done.stdout}{done.stderr}"[-3000:])
