"""What a recording's time stamps say: the sample rate, unequal steps, gaps; and what to do then."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sculler.checks.stamps import Shift, ShiftFinder, wrong_rate
from sculler.readers.bridging import bridged, concatenated, last_time, part, with_last
from sculler.readers.recording import Recording, Samples
from sculler.readers.rollover import Unwrapper
from sculler.readers.timing_report import Gap, TimingReport
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.samples import Kind

Gaps = Literal["refuse", "bridge", "ignore"]
Steps = Literal["even", "resample"]

_TOLERANCE = 0.01  # of the interval: beyond this steps are unequal
_STRAY = 0.75  # intervals: a stamp further from its place is passed over
_EVEN = 0.05  # intervals: stamps this near to even steps are in their places
_FOLLOW = 0.1  # of a stamp's distance from its place, by which the next places follow
_LISTED = 100  # gaps kept one by one; the rest are counted only


class Timing:
    """Checks the stamps of consecutive samples, and bridges gaps.

    A gap is a lasting shift of the stamps (`sculler.checks.stamps`); what evens out is jitter.
    With even steps a stamp that is more than three quarters of an interval from its place is passed
    over, and the place taken.

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
        steps: whether samples are one interval apart whatever their stamps say.
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
        steps: Steps,
        start: float | None = None,
        stop: float | None = None,
    ) -> None:
        self._path, self._T = path, design.sample_interval
        self._clock, self._given = recording.clock, given
        self._gaps, self._max_gap, self._steps = gaps, max_gap, steps
        self._start, self._stop = start, stop
        unit = "s" if recording.clock is None else recording.clock.unit
        self._unwrapped = Unwrapper(unit, self._T)
        self._finder = ShiftFinder(self._T)
        self._waiting: list[Samples] = []  # taken, and not yet told whether a gap lies there
        self._last: Samples | None = None  # the last sample given, its stamp as it was given
        self._last_stamp = 0.0  # the same, as the file has it
        self._place: float | None = None  # of the next sample, with even steps
        self._uneven = False  # whether a stamp was not in its place so far
        self._begin = 0.0  # first stamp taken, on the scale of the samples' times
        self.report = TimingReport(rollovers=self._unwrapped.found)

    def __call__(self, chunks: Iterator[Samples]) -> Iterator[Samples]:
        """The samples, those before `start` and after `stop` left out, gaps bridged.

        Raises:
            InputError: time goes back for good, the first samples show another sample rate, or
                there is a gap that is not to be bridged; to resample, any stamp that does not grow.
        """
        for chunk in chain(chunks, [None]):
            if chunk is not None:
                assert chunk.times is not None
                chunk = self._within(chunk._replace(times=self._unwrapped(chunk.times)))
                if not len(chunk.values):
                    continue
                if self._steps == "resample":
                    self._require_growth(chunk, chunks)
                self._waiting.append(chunk)
            if not self._waiting:
                return
            times = np.empty(0) if chunk is None or chunk.times is None else chunk.times
            shifts = self._finder(times, last=chunk is None)
            waiting = concatenated(self._waiting)
            count = self._finder.decided - self.report.samples
            if not count:
                self._waiting = [waiting]
                continue
            if not self.report.samples:
                self._require_rate(waiting, shifts, count)
            self._waiting = [part(waiting, count, None)] if count < len(waiting.values) else []
            yield self._given_on(part(waiting, 0, count), shifts)

    def _require_growth(self, chunk: Samples, rest: Iterator[Samples]) -> None:
        """Whether the stamps grow; if not, the rest is read to count those that do not."""
        before = self._waiting[-1] if self._waiting else self._last
        number = self.report.samples + sum(len(each.values) for each in self._waiting)
        wrong, first, told = 0, None, ""
        for samples in chain([chunk], rest):
            assert samples.times is not None
            times = samples.times
            if samples is not chunk:
                samples = self._within(samples._replace(times=self._unwrapped(times)))
                times = times if samples.times is None else samples.times
            if before is not None and before.times is not None:
                times = np.concatenate([before.times[-1:], times])
            bad = np.flatnonzero(np.diff(times) <= 0)
            if first is None and not len(bad):
                return
            if first is None:
                at = int(bad[0])
                first = number + at + (0 if before is not None else 1)
                told = _step_back(times[at], times[at + 1], self._absolute(float(times[at])))
            wrong += len(bad)
            before = samples if len(samples.values) else before
        more = f" ({wrong:,} such samples in all)" if wrong > 1 else ""
        raise InputError(
            f"{self._path}: sample {first}: time does not grow, it {told}{more}; give --steps even"
            " to take samples as one interval apart, or --time-column none"
        )

    def _require_rate(self, samples: Samples, shifts: list[Shift], count: int) -> None:
        """Whether the first steps are the design's, on the average: jitter and gaps are allowed."""
        assert samples.times is not None
        rate = wrong_rate(samples.times[:count], shifts, self._T)
        if rate is not None:
            raise InputError(
                f"{self._path}: the time column shows {rate:.6g} Hz but"
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

    def _given_on(self, samples: Samples, shifts: list[Shift]) -> Samples:
        """The next samples, with bridges over the gaps among them."""
        assert samples.times is not None
        report, T = self.report, self._T
        first = report.samples  # number of the first of them
        if not first:
            self._begin = float(samples.times[0])
            report.start = self._absolute(self._begin)
        stamps = samples.times if not first else np.append(self._last_stamp, samples.times)
        before = len(stamps) - len(samples.times)
        gaps = [shift for shift in shifts if shift.missing > 0]
        self._note_stamps(samples, stamps, gaps, first)
        for shift in shifts:
            self._require_forward(shift)
        at = np.array([gap.sample - first + before - 1 for gap in gaps], np.int64)
        missing = np.array([gap.missing for gap in gaps], np.int64)
        for shift in gaps:
            gap = Gap(shift.sample, self._absolute(shift.time), shift.seconds, shift.missing)
            self._require_bridge(gap)
            if len(report.gaps) < _LISTED:
                report.gaps.append(gap)
        report.gap_count += len(gaps)
        report.missing += int(missing.sum())
        report.too_many += sum(-shift.missing for shift in shifts if shift.missing < 0)
        report.samples += len(samples.values)
        report.span = float(stamps[-1]) - self._begin
        if self._steps == "even":
            samples = samples._replace(times=self._placed(samples.times, at + 1 - before, first))
        joined = with_last(self._last, samples)
        self._last = Samples(samples.values[-1:], None, last_time(samples))
        self._last_stamp = float(stamps[-1])
        if self._gaps != "bridge" or not len(gaps):
            return samples
        return bridged(joined, at, missing, T if self._given == "increment" else None, before)

    def _note_stamps(
        self, samples: Samples, stamps: NDArray[np.float64], gaps: list[Shift], first: int
    ) -> None:
        """Count what the steps are; `stamps` has that of the sample before, if there is one."""
        report = self.report
        steps = np.diff(stamps)
        before = len(stamps) - len(samples.values)
        plain = np.delete(steps, [gap.sample - first + before - 1 for gap in gaps])
        if len(plain):
            report.longest_step = max(report.longest_step, float(plain.max()))
            report.shortest_step = min(report.shortest_step, float(plain.min()))
            report.unequal += int((np.abs(plain / self._T - 1) > _TOLERANCE).sum())
        report.repeated += int((steps <= 0).sum())
        values = samples.values
        if before and self._last is not None:
            values = np.concatenate([self._last.values, values])
        same = (values[1:] == values[:-1]).all(axis=1)
        report.twice += int((same & (steps == 0)).sum())

    def _placed(
        self, times: NDArray[np.float64], gaps: NDArray[np.int64], first: int
    ) -> NDArray[np.float64]:
        """The stamps, each that strays replaced by its place.

        Places are one interval apart, and follow the stamps that do not stray slowly.

        Args:
            times: (N,) stamps.
            gaps: numbers among them of the first samples after gaps.
            first: number of the first of them.
        """
        T = self._T
        if self._place is None:
            self._place = float(times[0])
        if not self._uneven:
            steps = np.diff(times, prepend=self._place - T if not first else self._last_stamp)
            steps[gaps] = T
            if (np.abs(steps - T) <= _EVEN * T).all():
                self._place = float(times[-1]) + T
                return times
            self._uneven = True
        after_gap = set(gaps.tolist())
        placed: list[float] = times.tolist()
        place, allowed = self._place, _STRAY * T
        for at, stamp in enumerate(placed):
            off = stamp - place
            if at in after_gap and off > 0:
                place = stamp
            elif -allowed <= off <= allowed:
                place += _FOLLOW * off
            else:
                if self.report.first_passed_over is None:
                    self.report.first_passed_over = first + at
                self.report.passed_over += 1
                placed[at] = place
            place += T
        self._place = place
        return np.array(placed)

    def _require_forward(self, shift: Shift) -> None:
        """Whether time does not go back for good, in a log that is not split there."""
        if shift.seconds >= 0 or shift.missing > 0:
            return
        raise InputError(
            f"{self._path}: sample {shift.sample}: time does not grow, it goes back by"
            f" {-shift.seconds:.6g} s for good (after {self._absolute(shift.time):.6f} s), as where"
            " a clock was set or two logs are in one; cut the log there, or give --time-column none"
            " to go by the sample rate"
        )

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


def _step_back(before: float, after: float, at: float) -> str:
    what = "repeats the stamp before" if after == before else f"goes back by {before - after:.6g} s"
    return f"{what} ({at:.9f} s)"
