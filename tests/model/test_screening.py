"""The quick look through samples, beside what it means, run by run and step by step."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sculler_model.samples import screening
from sculler_model.samples.screening import RAILS, RUNS, SPIKES, screen

LONG, SPIKE = 5, 4.0
ENDS = np.array([[-3] * 6, [3] * 6])


def changes(column: list[object]) -> list[int]:
    """Rows unlike the row before."""
    return [row for row, (a, b) in enumerate(pairwise(column), start=1) if a != b]


def expected(rows: list[list[int]], new: int, begins: list[int]) -> tuple[int, list[int]]:
    found, ends = 0, []
    columns = [*map(list, zip(*rows, strict=True)), list(map(tuple, rows))]
    for column, begin in zip(columns, begins, strict=True):
        starts = [begin, *(row for row in changes(column) if row >= new)]
        if any(b - a >= LONG for a, b in pairwise(starts)):
            found |= RUNS
        ends.append(starts[-1])
    for column in columns[:6]:
        if any(abs(value) == 3 for value in column[new:]):
            found |= RAILS
        steps = [abs(b - a) for a, b in pairwise(column)]
        largest, mean = max(steps, default=0), sum(steps) / max(len(steps), 1)
        if largest > min(100.0, len(rows) / 8) * mean and largest > SPIKE:
            found |= SPIKES
    return found, ends


@st.composite
def looks(draw: st.DrawFn) -> tuple[list[list[int]], int, int]:
    """Rows that often stand still, how many of them are known, and rows turned together."""
    move = st.lists(st.sampled_from([0] * 8 + [1, -1, 3]), min_size=6, max_size=6)
    moves = draw(st.lists(move, min_size=2, max_size=60))
    rows = np.clip(np.cumsum(moves, axis=0), -3, 3).tolist()
    return rows, draw(st.integers(1, len(rows))), draw(st.integers(1, 70))


@given(looks(), st.integers(-9, 0))
def test_it_finds_what_there_is_and_follows_each_run(look, since) -> None:
    rows, new, together = look
    columns = [*map(list, zip(*rows, strict=True)), list(map(tuple, rows))]
    # the last known change of each column; before the first row where there was none
    begins = [max([since, *(r for r in changes(c) if r < new)]) for c in columns]
    followed = np.array(begins)
    known, screening._TOGETHER = screening._TOGETHER, together
    try:
        found = screen(np.array(rows), new, followed, LONG, ENDS, SPIKE)
    finally:
        screening._TOGETHER = known
    assert (found, followed.tolist()) == expected(rows, new, begins)


def test_a_spike_and_a_rail_each_by_itself() -> None:
    rows = np.cumsum(np.tile([[1] * 6, [-1] * 6], (100, 1)), axis=0)
    wide = np.array([[-50] * 6, [50] * 6])

    def found(new: int, spike: float) -> int:
        return screen(rows, new, np.full(7, new - 1), 100, wide, spike)

    assert found(1, SPIKE) == 0
    rows[120, 4] += 48
    assert found(1, SPIKE) == SPIKES
    rows[120, 4] += 1
    assert found(1, 99.0) == RAILS
    assert found(121, 99.0) == 0  # it was known
