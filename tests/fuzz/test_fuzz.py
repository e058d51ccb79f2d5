"""30 corrupted inputs at every change, 1000 before a release; `make fuzz` runs more."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import pytest

from fuzz.corruptions import spoilt
from fuzz.running import verdict
from fuzz.targets import CHIPS, TARGETS
from sculler.main import VERBS


@pytest.mark.parametrize("cases", [30, pytest.param(1000, marks=pytest.mark.deep)])
def test_corrupted_inputs(cases: int, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "fuzz", "--seed", "1", "--cases", str(cases), "--save", tmp_path],
        cwd=Path(__file__).parents[1], capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    assert f"{cases} cases, 0 findings" in done.stdout


def test_every_verb_that_reads_has_a_target() -> None:
    verbs = {target.words.split()[0] for target in TARGETS}
    absent = set() if CHIPS[0] in TARGETS else {"soc"}
    assert verbs == set(VERBS) - {"place", "demo"} - absent


def test_a_case_is_made_of_its_seed() -> None:
    content = b"name,value\n1,2\n3,4\n" * 20
    made = [spoilt(random.Random(f"7:{k}"), content, True) for k in range(50) for _ in "ab"]
    assert made[::2] == made[1::2]
    assert len(set(made)) > 40
    assert sum(each != content for each in made) > 80


@pytest.mark.parametrize(
    ("status", "err", "taken", "what"),
    [
        (0, "", 1, None),
        (1, "", 1, None),
        (2, "sculler: x: no, give y\n", 1, None),
        (2, "sculler: x: no, give y\nmore\n", 1, "more than one"),
        (2, "x: no\n", 1, "without a line"),
        (2, "", 1, "without a line"),
        (0, "RuntimeWarning: overflow\n", 1, "words on stderr"),
        (3, "", 1, "status 3"),
        (-11, "", 1, "killed by signal 11"),
        (70, "Traceback (most recent call last):\n", 1, "traceback"),
        (2, "sculler: the input asks for more memory than there is, give\n", 1, "1 GB"),
        (0, "", 21, "takes 21 s"),
    ],
)
def test_what_is_a_finding(status: int, err: str, taken: float, what: str | None) -> None:
    found = verdict(status, err, taken)
    assert (found is None) == (what is None)
    assert what is None or what in str(found)
