"""The program of third and fourth order of the pipelined core, against the golden model."""

from __future__ import annotations

import numpy as np
import pytest

from higher_order_designs import HIGHER_ORDER
from sculler_hdl.plan.vector.engine import RESULTS
from sculler_hdl.plan.vector.page import Page
from sculler_hdl.plan.vector.program import Program, Slots
from sculler_model.golden import GoldenModel
from strategies import random_counts
from tiers import few_of
from vector_pages import Interpreter


@pytest.mark.parametrize(
    "name", few_of(list(HIGHER_ORDER), ["one_sample", "three_alone", "third_order", "dense"])
)
@pytest.mark.parametrize("store", [1, 17])
def test_program_makes_the_page_s_integers(name: str, store: int) -> None:
    """Random counts and the most negative ones; every range holds on the way.

    However long it takes from a step to when its sum is stored, nothing is read too early.
    """
    design = HIGHER_ORDER[name]
    interpreter = Interpreter(design, Program(Page(design), Slots(store, store + 1, {})))
    model, words = GoldenModel(design), design.words
    span = design.samples_per_major
    counts = random_counts(design, 3 * span, np.random.default_rng(8))
    counts[:span] = [words.gyro.lo] * 3 + [words.accel.lo] * 3
    results = 0
    for row in counts.tolist():
        gyro, accel = (row[0], row[1], row[2]), (row[3], row[4], row[5])
        sums, result = interpreter.step(gyro, accel), model.step(gyro, accel)
        assert (sums is None) == (result is None)
        if sums is not None and result is not None:
            found = {RESULTS[name]: three for name, three in sums.items() if name in RESULTS}
            wanted = {name: getattr(result, name) for name in design.vectors if name in found}
            assert wanted.items() <= found.items()
            assert len(wanted) == 2 * (design.order - 2)
            results += 1
    assert results == 3
