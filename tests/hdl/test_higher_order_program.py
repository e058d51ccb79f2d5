"""The schedule of third and fourth order, run in plain Python, against the golden model."""

from __future__ import annotations

import numpy as np
import pytest

from higher_order_designs import HIGHER_ORDER
from sculler_hdl.plan.compact.interpreter import Interpreter
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_model.design import Design
from sculler_model.golden import GoldenModel, to_words
from strategies import random_counts
from tiers import few_of


@pytest.mark.parametrize("name", few_of(list(HIGHER_ORDER), ["one_sample", "third_order"]))
def test_program_makes_the_page_s_words(name: str) -> None:
    """Random counts and the most negative ones; every range holds on the way."""
    design = HIGHER_ORDER[name]
    plan, model = plan_compact(design), GoldenModel(design)
    interpreter = Interpreter(plan.program, plan.pipeline.store)
    span = design.samples_per_major
    counts = random_counts(design, 3 * span, np.random.default_rng(8))
    counts[:span] = [design.words.gyro.lo] * 3 + [design.words.accel.lo] * 3
    results = 0
    for row in counts.tolist():
        sample = (tuple(row[:3]), tuple(row[3:]), 0)
        words, result = interpreter.step(sample), model.step(*sample)
        assert (words is None) == (result is None)
        if words is not None and result is not None:
            assert words == list(to_words(design, result.row()))
            results += 1
    assert results == 3


def test_costs_that_the_docs_name() -> None:
    """Clocks of a minor interval, of the preset's n = 4, M = 5 on ECP5."""
    hardware = {"core": "compact", "target": "ecp5"}
    clocks = {}
    for order in (2, 3, 4):
        design = Design.parse(
            {"preset": "stim300", "algorithm": {"order": order}, "hardware": hardware}
        )
        clocks[order] = max(plan_compact(design).timing.work)
    assert clocks == {2: 329, 3: 1640, 4: 3769}
