"""What a recording's time stamps say: the sample rate, unequal steps, gaps; and what to do then."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sculler.readers import Recording, Samples
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.sampling import Kind, Resampler

Gaps = Literal["refuse", "bridge", "ignore"]
Steps = Literal["even", "resample"]

_TOLERANCE = 0.01  # of the interval: clocks are better than this, wrong rates are worse
_JITTER = 0.5  # intervals by which the first and the last stamp may stray
_GAP = 1.5  # intervals: beyond this a sample is missing
_LISTED = 100  # gaps kept one by one; the rest are counted only


@dataclass(frozen=True)
class Gap:
    """A step that is longer than 1.5 intervals.

    Attributes:
        sample: number of the first sample after it, in the file from 0 (or from --start on).
        time: of the last sample before it, s of the file's clock.
        seconds: from that sample to the next.
        missing: samples that are not there.
    """

    sample: int
    time: float
    seconds: float
    missing: int


@dataclass
class TimingReport:
    """What the stamps showed.

    Attributes:
        samples: samples of the file that were taken.
        start: first stamp, s of the file's clock.
        span: from there to the last stamp, s.
        longest_step, shortest_step: between samples with no gap between, s.
        unequal: steps that differ by more than 1 % from the interval, gaps left out.
        gap_count, missing: gaps, and samples missing in them, in all.
        gaps: the first of them.
    """

    samples: int = 0
    start: float = 0.0
    span: float = 0.0
    longest_step: float = 0.0
    shortest_step: float = np.inf
    unequal: int = 0
    gap_count: int = 0
    missing: int = 0
    gaps: list[Gap] = field(default_factory=list)

    @property
    def rate(self) -> float | None:
        """Mean sample rate, Hz, samples missing in gaps counted; None with fewer than two."""
        if self.samples < 2:
            return None
        return (self.samples - 1 + self.missing) / self.span


class Timing:
    """Checks the stamps of consecutive samples, and bridges gaps.

    A bridge has a sample for every one that is missing, its values on the straight line from the
    last sample before the gap to the first after it, and `fault` set.  For rates this is the linear
    interpolation; the increments of an increment log are taken to last one interval each, so that
    those of the gap are lost, and are made up in the same way.

    Args:
        path: for messages.
        design: its sample rate is what the stamps should show.
        recording: gives the clock.
        given: what its values are.
        gaps: refuse them, bridge them, or pass over them.
        max_gap: refuse to bridge a longer one, s.
        start, stop: take the samples between these only, s of the file's clock; a stamp half an
            interval from them counts as on them.  An increment whose interval ends at `start`
            lies before it, a rate there is the first of all.
    """

    def __init__(
        self,
        path: Path,
        design: Design,
        recording: Recording,
        given: Kind,
        gaps: Gaps,
        max_gap: float,
        start: float | None = None,
        stop: float | None = None,
    ) -> None:
        self._path, self._T = path, design.sample_interval
        self._clock, self._given = recording.clock, given
        self._gaps, self._max_gap = gaps, max_gap
        self._start, self._stop = start, stop
        self._last: Samples | None = None
        self._read = 0
        self._begin = 0.0  # first stamp taken, on the scale of the samples' times
        self.report = TimingReport()

    def __call__(self, samples: Samples) -> Samples:
        """The next samples, those before `start` and after `stop` left out, gaps bridged.

        Raises:
            InputError: time does not grow, the first samples show another sample rate, or there is
                a gap that is not to be bridged.
        """
        assert samples.times is not None
        times = samples.times
        if self._last is not None and self._last.times is not None:
            times = np.concatenate([self._last.times, times])
        self._require_growth(times, self._read - (len(times) - len(samples.times)))
        if not self._read and len(times) > 1:
            self._require_rate(np.diff(times))
        self._read += len(samples.times)
        last_read = Samples(samples.values[-1:], None, samples.times[-1:])
        samples = self._within(samples)
        if samples.times is not None and len(samples.times):
            # what lies before the start is no neighbour
            joined = samples if not self.report.samples else _join(self._last, samples)
            samples = self._step(joined, samples)
        self._last = last_read
        return samples

    def _require_growth(self, times: NDArray[np.float64], first: int) -> None:
        steps = np.diff(times)
        if not (steps <= 0).any():
            return
        at = int(np.argmax(steps <= 0))
        what = "repeats the stamp before" if steps[at] == 0 else f"goes back by {-steps[at]:.6g} s"
        raise InputError(
            f"{self._path}: sample {first + at + 1}: time does not grow, it {what}"
            f" ({self._absolute(times[at]):.9f} s); take the sample out or mend the stamps"
        )

    def _require_rate(self, steps: NDArray[np.float64]) -> None:
        """Whether the first steps are the design's, on the average: jitter and gaps are allowed."""
        count = max(float(np.rint(steps / np.median(steps)).sum()), 1.0)  # gaps are many intervals
        usual = float(steps.sum()) / count
        if abs(usual / self._T - 1) > _TOLERANCE + _JITTER / count:
            raise InputError(
                f"{self._path}: the time column shows {1 / usual:.6g} Hz but"
                f" sensor.sample_rate_hz = {1 / self._T:.6g}, change one of them (or --time-unit)"
            )

    def _absolute(self, since: float) -> float:
        return since + (0.0 if self._clock is None else self._clock.origin)

    def _within(self, samples: Samples) -> Samples:
        """The samples from `start` to `stop`."""
        assert samples.times is not None
        if self._start is None and self._stop is None:
            return samples
        origin, half = self._absolute(0.0), 0.5 * self._T
        keep = np.ones(len(samples.times), np.bool_)
        if self._start is not None:
            sign = 1 if self._given == "increment" else -1
            keep &= samples.times > self._start - origin + sign * half
        if self._stop is not None:
            keep &= samples.times < self._stop - origin + half
        faults = None if samples.faults is None else samples.faults[keep]
        return Samples(samples.values[keep], faults, samples.times[keep])

    def _step(self, joined: Samples, samples: Samples) -> Samples:
        """The samples, with bridges; `joined` has the sample before them too."""
        assert joined.times is not None
        report, T = self.report, self._T
        if not report.samples:
            self._begin = float(joined.times[0])
            report.start = self._absolute(self._begin)
        before = len(joined.times) - len(samples.values)
        steps = np.diff(joined.times)
        at = np.flatnonzero(steps > _GAP * T)
        missing = np.rint(steps[at] / T).astype(np.int64) - 1
        plain = np.delete(steps, at)
        if len(plain):
            report.longest_step = max(report.longest_step, float(plain.max()))
            report.shortest_step = min(report.shortest_step, float(plain.min()))
            report.unequal += int((np.abs(plain / T - 1) > _TOLERANCE).sum())
        for row, count in zip(at.tolist(), missing.tolist(), strict=True):
            gap = Gap(
                report.samples - before + row + 1,
                self._absolute(float(joined.times[row])),
                float(steps[row]),
                count,
            )
            self._require_bridge(gap)
            if len(report.gaps) < _LISTED:
                report.gaps.append(gap)
        report.gap_count += len(at)
        report.missing += int(missing.sum())
        report.samples += len(samples.values)
        report.span = float(joined.times[-1]) - self._begin
        if self._gaps != "bridge" or not len(at):
            return samples
        return _bridged(joined, at, missing, T if self._given == "increment" else None, before)

    def _require_bridge(self, gap: Gap) -> None:
        where = (
            f"{self._path}: sample {gap.sample}: a gap of {gap.seconds:.6g} s after"
            f" {gap.time:.6f} s ({gap.missing} samples missing)"
        )
        if self._gaps == "refuse":
            raise InputError(f"{where}, give --gaps bridge to fill such gaps (or cut the log)")
        if self._gaps == "bridge" and gap.seconds > self._max_gap:
            raise InputError(
                f"{where} is longer than --max-gap {self._max_gap:g}, give more or cut the log with"
                " --start and --stop"
            )


def _join(last: Samples | None, samples: Samples) -> Samples:
    """The last sample before, and the samples; faults left to the latter."""
    if last is None or last.times is None or samples.times is None:
        return samples
    return Samples(
        np.concatenate([last.values, samples.values]),
        samples.faults,
        np.concatenate([last.times, samples.times]),
    )


def _bridged(
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
