"""The faults can be made, and each is found by a test of the fast tier."""

from __future__ import annotations

from pathlib import Path

import pytest

from breaks.faults import FAULTS, Fault
from breaks.running import copy, made, run

EACH = pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)


@EACH
def test_a_fault_has_one_place(fault: Fault) -> None:
    assert fault.line != fault.wrong
    assert fault.place().parts[0] in ("model", "hdl", "sim", "cli")


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return copy(tmp_path_factory.mktemp("project"))


@pytest.mark.deep
@EACH
def test_every_fault_is_found(fault: Fault, project: Path) -> None:
    with made(fault, project):
        caught = run(fault, project)
    assert caught.test, caught.said


@pytest.mark.deep
def test_without_a_fault_nothing_is_found(project: Path) -> None:
    caught = run(FAULTS["words"], project)
    assert caught.test == "", caught.said
    assert "passed" in caught.said
