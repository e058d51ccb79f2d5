"""What both engines share: samples checked, how far a run has come, and the trace of the ports."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import Error, InputError
from sculler_model.golden import Ports, Timing, check_widths, result_ports
from sculler_sim.stimulus import Stimulus

Chunk = (
    tuple[NDArray[Any], NDArray[Any] | None]
    | tuple[NDArray[Any], NDArray[Any], NDArray[Any] | None, NDArray[Any] | None]
)
"""Consecutive samples: counts (N, 6), gyro then accelerometer, and faults (N,) or None for 0.

Where the core has channels: counts, channels (N,), faults and restarts (N,) or None for 0.
"""

RESET = None
"""In place of a chunk: reset the core here, once the results of the samples before are out."""


class CheckedChunk(NamedTuple):
    """The same from `check_chunks`: C-contiguous, every value legal.

    Attributes:
        counts, faults: as above.
        tags: (N,) channel * 2 + restart; empty where the core has one channel.
    """

    counts: NDArray[np.int32]
    faults: NDArray[np.uint8]
    tags: NDArray[np.int32]

    def rest(self, done: int) -> CheckedChunk:
        """What is left when so many samples are done."""
        return CheckedChunk(self.counts[done:], self.faults[done:], self.tags[done:])


class SimulationError(Error, RuntimeError):
    """The simulated core broke its contract: it stopped, or miscounted the words of a result.

    Examples:
        >>> import sculler
        >>> issubclass(sculler.SimulationError, RuntimeError)
        True
    """


def wrong_last(words: int, wanted: int) -> SimulationError:
    """The error of a stream whose `result_last` is not where it belongs, at that many words."""
    level = "low" if words == wanted else "high"
    return SimulationError(f"result_last is {level} with word {words} of {wanted} of a result")


@dataclass
class Progress:
    """What a run has done so far.

    Attributes:
        clocks: clocks run.
        samples: samples the core has taken.
        lost: samples that were given up before it had.
        since_reset: samples taken since the last reset.
        due: major intervals since then whose last sample was taken.
        results: results taken, to their last word.
        intervals_told: major intervals since the last reset up to the last one whose result was
            taken, results that the core dropped included.
        idle: clocks since a sample, a result or a word of one was last taken.
    """

    clocks: int = 0
    samples: int = 0
    lost: int = 0
    since_reset: int = 0
    results: int = 0
    intervals_told: int = 0
    idle: int = 0
    due: int = 0

    @property
    def drained(self) -> bool:
        """Whether every complete major interval's result has been taken."""
        return self.intervals_told >= self.due

    def check_alive(self, stimulus: Stimulus, timing: Timing) -> None:
        """Raise SimulationError if nothing has moved for much longer than the two explain."""
        if self.idle > 50_000 + 32 * stimulus.longest + 4 * timing.longest_wait:
            raise SimulationError(
                f"the core hangs: no sample and no result taken for {self.idle} clocks after"
                f" sample {self.samples}"
            )


def check_chunks(design: Design, chunks: Iterable[Chunk | None]) -> Iterator[CheckedChunk | None]:
    """The chunks as int32 counts and uint8 faults, every value checked; empty ones left out.

    `RESET` stays where it is.

    Raises:
        InputError: a chunk's shape or type is wrong or a count does not fit its port; the first
            such sample is named.
    """
    words = design.words
    allowed = [words.gyro] * 3 + [words.accel] * 3
    lo, hi = np.array([w.lo for w in allowed]), np.array([w.hi for w in allowed])
    first = 0
    for chunk in chunks:
        if chunk is RESET:
            yield RESET
            continue
        if len(chunk) == 2:
            counts, faults = chunk
            tags = _tags(design, first, len(counts), None, None)
        else:
            counts, channels, faults, restarts = chunk
            tags = _tags(design, first, len(counts), channels, restarts)
        counts = np.asarray(counts)
        if counts.ndim != 2 or counts.shape[1] != 6 or counts.dtype.kind not in "iu":
            raise InputError(
                f"samples from {first} on: {counts.dtype} counts of shape {counts.shape}, give"
                " integers of shape (N, 6)"
            )
        marks = np.zeros(len(counts), bool) if faults is None else np.asarray(faults)
        legal = marks.shape == (len(counts),)
        if not legal or (marks.dtype != bool and ((marks != 0) & (marks != 1)).any()):
            raise InputError(
                f"samples from {first} on: faults of shape {marks.shape}, give {len(counts)}"
                " of 0 or 1"
            )
        if not len(counts):
            continue
        least, most = _extremes(counts)
        if (least < lo).any() or (most > hi).any():
            row = int(((counts < lo) | (counts > hi)).any(axis=1).argmax())
            check_widths(words, first + row, counts[row].tolist())
        yield CheckedChunk(
            np.ascontiguousarray(counts, np.int32), np.ascontiguousarray(marks, np.uint8), tags
        )
        first += len(counts)


def _tags(
    design: Design,
    first: int,
    samples: int,
    channels: NDArray[Any] | None,
    restarts: NDArray[Any] | None,
) -> NDArray[np.int32]:
    """`CheckedChunk.tags` of samples, of which the first has this number.

    Raises:
        InputError: there are no channels where the core has some, or the other way round; or one is
            not there.
    """
    if (channels is not None) != (design.channels > 1):
        given = "no channels" if channels is None else "channels"
        raise InputError(
            f"samples from {first} on: {given}, but hardware.channels = {design.channels}"
        )
    if channels is None:
        return np.zeros(0, np.int32)
    whose = np.asarray(channels)
    again = np.zeros(samples, np.int32) if restarts is None else np.asarray(restarts) != 0
    if whose.shape != (samples,) or whose.dtype.kind not in "iu" or again.shape != (samples,):
        raise InputError(f"samples from {first} on: give {samples} channels and restarts")
    wrong = (whose < 0) | (whose >= design.channels)
    if wrong.any():
        at = int(np.argmax(wrong))
        raise InputError(
            f"sample {first + at}: channel {whose[at]} is not there, give 0 to"
            f" {design.channels - 1}"
        )
    return np.ascontiguousarray(2 * whose.astype(np.int32) + again, np.int32)


def _extremes(counts: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Least and greatest of each column, (6,): many rows beside each other, for long vectors."""
    wide = counts[: len(counts) // _ROWS * _ROWS].reshape(-1, 6 * _ROWS)
    rest = counts[len(wide) * _ROWS :]
    if not len(wide):
        return rest.min(axis=0), rest.max(axis=0)
    least, most = (edge(axis=0).reshape(-1, 6) for edge in (wide.min, wide.max))
    return np.vstack([least, rest]).min(axis=0), np.vstack([most, rest]).max(axis=0)


_ROWS = 64


@dataclass(frozen=True)
class PortTrace:
    """The output ports on consecutive clocks from clock 0.

    Attributes:
        sample_ready, result_valid: (clocks,) of 0 and 1.
        result: (clocks, ports) Python integers as in `Ports.result`, signed as the ports are.
        counters: (clocks, 2) `samples_lost`, and `results_dropped` or 0.
        ports: names of the result ports, `sculler_model.golden.result_ports`.
    """

    sample_ready: NDArray[np.uint8]
    result_valid: NDArray[np.uint8]
    result: NDArray[np.object_]
    counters: NDArray[np.uint16]
    ports: tuple[str, ...]

    @classmethod
    def from_ports(cls, design: Design, shown: list[Ports]) -> PortTrace:
        """Collect what the ports showed clock by clock."""
        names = result_ports(design)
        return cls(
            np.array([ports.sample_ready for ports in shown], np.uint8),
            np.array([ports.result_valid for ports in shown], np.uint8),
            np.array([ports.result for ports in shown], object).reshape(-1, len(names)),
            np.array(
                [(ports.samples_lost, ports.results_dropped) for ports in shown], np.uint16
            ).reshape(-1, 2),
            names,
        )

    def __len__(self) -> int:
        return len(self.sample_ready)

    def first_difference(self, other: PortTrace) -> tuple[int, str, int, int] | None:
        """First unequal port as (clock, port, ours, theirs), or None; compares common clocks."""
        common = min(len(self), len(other))
        names = ("sample_ready", "result_valid", *(f"result_{port}" for port in self.ports))
        names += ("samples_lost", "results_dropped")
        ours, theirs = (
            np.column_stack(
                [each[:common] for each in (t.sample_ready, t.result_valid, t.result, t.counters)]
            )
            for t in (self, other)
        )
        unequal = np.argwhere(ours != theirs)
        if not len(unequal):
            return None
        clock, port = (int(i) for i in unequal[0])
        return clock, names[port], int(ours[clock, port]), int(theirs[clock, port])
