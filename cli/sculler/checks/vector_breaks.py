"""Vectors as stretches of consecutive major intervals, every one with its instant."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sculler.formats.tables import counting
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.samples import interval_ends


@dataclass(frozen=True)
class Break:
    """A place where an interval does not begin at the end of the one before.

    Attributes:
        line: of the vectors file, the first one after the break; of a binary file the row, from 1.
        what: shows it, in words.
        seconds: length of the break; None if it cannot be known.
    """

    line: int
    what: str
    seconds: float | None


def begins_at(design: Design, end: float) -> float:
    """Where the interval that ends at a time (s) begins."""
    return round(end - design.major_interval, 9)


class Stretches:
    """Cuts blocks of vectors that come one by one where an interval does not follow the last.

    The times are the log's own where the vectors have them; else they follow from `major` on a
    clock that began with the log, until a reset: how long that took is not known.

    Two intervals follow each other if `major` does and, where there are times, these do to three
    quarters of a sample and a thousandth of the interval, which leaves room for stamps of few
    digits and for a clock that is not the sensor's.

    Args:
        design: of the vectors.
        name: of their file, by which its rows are counted.
    """

    def __init__(self, design: Design, name: str = "") -> None:
        self._design = design
        self._start = counting(name).first
        self._allowed = 0.75 * design.sample_interval + 1e-3 * design.major_interval
        self._line = self._start  # of the next block's first row
        self._major, self._time = -1, 0.0  # of the row before

    def __call__(self, block: VectorBlock) -> Iterator[VectorBlock | Break]:
        """A block in parts of consecutive intervals, all with times, and the breaks before them."""
        if not len(block):
            return
        design, line = self._design, self._line
        times = interval_ends(design, block.major) if block.times is None else block.times
        majors = np.concatenate([[self._major], block.major])
        before = np.concatenate([[self._time], times])
        away = np.diff(majors) != 1
        if block.times is not None:
            away |= ~(np.abs(np.diff(before) - design.major_interval) <= self._allowed)
        if line == self._start:
            away[0] = False
        self._line = line + len(block)
        self._major, self._time = int(majors[-1]), float(before[-1])
        whole = replace(block, times=times)
        cuts = [0, *(np.flatnonzero(away[1:]) + 1).tolist(), len(block)]
        for first, end in pairwise(cuts):
            if away[first]:
                yield _break(design, line + first, majors[first:], before[first:], block)
            yield whole[first:end]


def stretches(design: Design, blocks: Iterable[VectorBlock]) -> Iterator[VectorBlock | Break]:
    """The blocks, each of consecutive intervals and with times, and the breaks between them."""
    cut = Stretches(design)
    for block in blocks:
        yield from cut(block)


def _break(
    design: Design,
    line: int,
    majors: NDArray[np.int64],
    times: NDArray[np.float64],
    block: VectorBlock,
) -> Break:
    """What lies between the first and the second of some rows."""
    (last, major), (end, next_end) = majors[:2].tolist(), times[:2].tolist()
    seconds = next_end - end - design.major_interval
    told = block.times is not None
    if major == last + 1:
        what = (
            f"time_s goes from {end:.15g} to {next_end:.15g} s, an interval is"
            f" {design.major_interval:g} s long"
        )
        return Break(line, what, seconds)
    if major > last:
        what = f"major is {major} where {last + 1} should follow"
        return Break(line, what, seconds)
    what = f"major falls back from {last} to {major}, the core was reset"
    return Break(line, what, seconds if told else None)
