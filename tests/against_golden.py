"""The fast model beside the golden one."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from sculler_model.design import Design
from sculler_model.fast import FastModel, VectorBlock, limbs_of
from sculler_model.golden import GoldenModel
from strategies import Counts


def golden(design: Design, counts: Counts, faults: Any = None) -> VectorBlock:
    marks = [0] * len(counts) if faults is None else [int(bool(f)) for f in faults]
    samples = (
        ((a, b, c), (d, e, f), mark)
        for (a, b, c, d, e, f), mark in zip(counts.tolist(), marks, strict=True)
    )
    return VectorBlock.from_results(GoldenModel(design).run(samples), design)


def assert_same(ours: VectorBlock, theirs: VectorBlock) -> None:
    assert len(ours) == len(theirs)
    assert ours.first_difference(theirs) is None
    assert np.array_equal(limbs_of(ours.components), limbs_of(theirs.components))
    assert ours.major.dtype == ours.status.dtype == np.int64


def in_chunks(model: FastModel, counts: Counts, cuts: list[int], faults: Any = None) -> VectorBlock:
    edges = [0, *sorted(cuts), len(counts)]
    blocks = []
    for start, stop in pairwise(edges):
        part = None if faults is None else faults[start:stop]
        blocks.append(model.feed(counts[start:stop], part))
        assert model.samples == stop
        assert model.leftover == stop % model.design.samples_per_major
    return VectorBlock.concatenate(blocks)
