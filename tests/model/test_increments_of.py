"""Counts to increments in one call: the numbers of the two steps, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest

from position_designs import HIGH_RESOLUTION
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.host import MajorIncrements, increments_of, major_increments, scaling
from strategies import DESIGNS, random_counts

NAMES = ["savage_1p1", "stim300_4x5", "wide_5p0", "taylor_6p2", "savage_hr"]


def bits(increments: MajorIncrements) -> dict[str, bytes]:
    return {name: column.tobytes() for name, column in increments.named_columns().items()}


@pytest.mark.parametrize(
    ("name", "compiled"),
    [*((name, way) for name in NAMES for way in (False, None)), ("savage_1p1", True)],
)
def test_they_are_the_two_steps(
    name: str, compiled: bool | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = (DESIGNS | HIGH_RESOLUTION)[name]
    span = design.samples_per_major
    rng = np.random.default_rng(3)
    counts = random_counts(design, 40 * span + 2, rng).astype(np.int32)
    faults = rng.random(len(counts)) < 0.1 / span
    whole = major_increments(design, FastModel(design).feed(counts, faults))
    monkeypatch.setattr(scaling, "RESULTS", 7)
    if compiled is not None:  # the scaling too, without the kernel or with it
        for least in ("WORTH_COMPILING", "WORTH_WHEN_LOADED"):
            monkeypatch.setattr(scaling, least, 0)
    if compiled:
        pytest.importorskip("numba")
    model = FastModel(design, compiled=compiled)
    found = increments_of(model, counts, faults)
    assert bits(found) == bits(whole)
    assert (len(found), model.samples) == (40, len(counts))
    assert bits(increments_of(model, counts[:0])) == bits(whole[:0])


def test_nothing_is_taken_of_samples_that_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    design = Design.preset("stim300")
    monkeypatch.setattr(scaling, "RESULTS", 2)
    counts = random_counts(design, 230, np.random.default_rng(4))
    model, other = FastModel(design), FastModel(design)
    blocks: list[VectorBlock] = [model.feed(counts[:33])]
    bad = counts[33:].copy()
    bad[-1, 2] = 1 << 23
    with pytest.raises(InputError, match=r"^sample 229: gyro_z = 8388608 does not fit 24 bits"):
        increments_of(model, bad)
    assert (model.samples, model.leftover) == (33, 13)
    blocks.append(model.feed(counts[33:]))
    joined, whole = VectorBlock.concatenate(blocks), other.feed(counts)
    assert joined.first_difference(whole) is None
    assert len(joined) == len(whole)
