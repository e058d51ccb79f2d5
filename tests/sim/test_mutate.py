"""Mutants of the Verilog against the generated test bench: what comes of them, and the page."""

from __future__ import annotations

import shutil

import pytest

from sculler_sim.prove.shapes import SHAPES
from studies.mutate.page import results
from studies.mutate.verdicts import Judged, compare, judge


def judged(killed: int, *proofs: str) -> list[Judged]:
    dead = [Judged("a", killed=True, said="FAIL", proof="", seconds=1.0)] * killed
    return dead + [Judged("b", killed=False, said="PASS", proof=p, seconds=1.0) for p in proofs]


def test_the_share_leaves_out_what_is_equivalent_and_counts_what_is_open() -> None:
    found = {
        "one": judged(199, "equivalent", "equivalent", "open, equal for 9 clocks"),
        "two": judged(97, "differs after 8 clocks", "equivalent"),
    }
    lines = list(results(found))
    assert "| `one` | 202 | 199 | 2 | 0 | 1 | 99.5 % |" in lines
    assert "| `two` | 99 | 97 | 1 | 1 | 0 | 99.0 % |" in lines
    assert "| **all** | 301 | 296 | 3 | 1 | 1 | 99.3 % |" in lines


@pytest.mark.deep
@pytest.mark.skipif(shutil.which("iverilog") is None, reason="Icarus Verilog is missing")
def test_what_the_bench_kills_can_be_told_from_the_core() -> None:
    """And what can not is not killed: bench and model checker agree."""
    shape = SHAPES["one_minor"]
    found = judge(shape, 8, 120)
    assert len(found) == 7  # the first of the list is the core as it is
    assert not any(mutant.proof.startswith("differs") for mutant in found)


@pytest.mark.deep
def test_the_model_checker_tells_a_changed_core_and_knows_the_same_one() -> None:
    from sculler_hdl import generate

    shape = SHAPES["one_minor"]
    core = generate(shape).verilog
    right = "gyro_x_sample[3] != gyro_x_sample[7]"
    assert core.count(right) == 1
    assert compare(shape, core, 120) == "equivalent"
    assert compare(shape, core.replace(right, "1'b1"), 120).startswith("differs after ")
