"""Samples put together, cut, and put in where they are missing."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler.readers.recording import Samples


def last_time(samples: Samples) -> NDArray[np.float64] | None:
    """The stamp of the last sample, (1,); None without stamps."""
    return None if samples.times is None else samples.times[-1:]


def concatenated(chunks: list[Samples]) -> Samples:
    """Consecutive chunks, which have stamps, as one."""
    if len(chunks) == 1:
        return chunks[0]
    values, faults, times = zip(*(chunk[:3] for chunk in chunks), strict=True)
    return Samples(
        np.concatenate(values),
        None if faults[0] is None else np.concatenate(faults),
        np.concatenate(times),
    )


def part(samples: Samples, begin: int, end: int | None) -> Samples:
    """Samples `begin` to before `end`, from 0; None for all that come."""
    values, faults, times = samples[:3]
    return Samples(
        values[begin:end],
        None if faults is None else faults[begin:end],
        None if times is None else times[begin:end],
    )


def with_last(last: Samples | None, samples: Samples) -> Samples:
    """The last sample before, and the samples; faults left to the latter."""
    if last is None or last.times is None or samples.times is None:
        return samples
    return Samples(
        np.concatenate([last.values, samples.values]),
        samples.faults,
        np.concatenate([last.times, samples.times]),
    )


def bridged(
    joined: Samples,
    at: NDArray[np.int64],
    missing: NDArray[np.int64],
    interval: float | None,
    before: int,
) -> Samples:
    """Samples put in after rows `at`, as many as are `missing`; the first `before` rows left out.

    Args:
        joined: the samples; `faults` are those of the rows that stay.
        at, missing: which gaps, and how many samples each lacks.
        interval: that increments last; None for rates, which last no time.
        before: 0 or 1.
    """
    assert joined.times is not None
    rows = np.repeat(at, missing)
    number = np.arange(len(rows)) - np.repeat(np.cumsum(missing) - missing, missing) + 1
    share = number / np.repeat(missing + 1, missing)
    begin, end = joined.values[rows], joined.values[rows + 1]
    values = begin + share[:, None] * (end - begin)
    length = joined.times[rows + 1] - joined.times[rows]
    if interval is not None:
        values *= (length / (np.repeat(missing + 1, missing) * interval))[:, None]
    times = joined.times[rows] + share * length
    flags = np.zeros(len(joined.times) - before, np.uint8)
    if joined.faults is not None:
        flags = joined.faults
    place = rows + 1 - before
    return Samples(
        np.insert(joined.values[before:], place, values, axis=0),
        np.insert(flags, place, 1),
        np.insert(joined.times[before:], place, times),
    )
