"""Samples on even steps, by their stamps or by their number."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from sculler.readers.recording import Samples
from sculler.readers.timing import Steps
from sculler_model.samples import Resampler


def resampled(
    chunks: Iterator[Samples], resampler: Resampler, interval: float, steps: Steps
) -> Iterator[Samples]:
    """The chunks on the resampler's grid.

    Args:
        chunks: in order.
        resampler: what brings them there.
        interval: of the samples, s.
        steps: `resample` goes by the stamps, and gives the grid's instants; `even` takes the
            samples as one interval apart, so that each point of the grid is a sample's and has its
            stamp.
    """
    count = passed = 0
    stamps = np.empty(0)  # from sample `passed` on
    for chunk in chain(chunks, [None]):
        if chunk is None:
            given = resampler.finish()
        else:
            times = np.arange(count, count + len(chunk.values), dtype=np.float64) * interval
            count += len(chunk.values)
            stamped = chunk.times is not None
            if chunk.times is not None and steps == "even":
                stamps = np.concatenate([stamps, chunk.times])
            elif chunk.times is not None:
                times = chunk.times
            given = resampler(times, chunk.values, chunk.faults)
        if not len(given.values):
            continue
        at: NDArray[np.float64] | None = given.times
        if not stamped:
            at = None
        elif steps == "even":
            number = np.rint(given.times / interval).astype(np.int64)
            at = stamps[number - passed]
            passed, stamps = int(number[-1]) + 1, stamps[number[-1] + 1 - passed :]
        yield Samples(given.values, given.faults, at)
