"""What no sensor does: counts that stand still, at their rails, at zero, and lone spikes.

The detectors only tell; they refuse nothing, since an ideal log may stand still too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.samples.quantiser import INPUT_COLUMNS
from sculler_model.samples.screening import RAILS, RUNS, SPIKES, compiled

Samples = NDArray[Any]
"""(N, 6) samples in counts."""

FindingKind = Literal["zero", "frozen", "stuck", "rail", "spike"]

BLOCK = 1 << 13
"""Samples looked at together."""

WORTH_COMPILING, WORTH_WHEN_LOADED = 1 << 20, 1 << 17
"""Samples from which on compiled loops look at them first; and where Numba is in use already."""

LISTED = 100
"""Findings of a kind kept one by one; the rest are counted only."""

_LONG = 1.0  # s
_MANY = 100  # samples
_FROZEN = 5.0  # s; an ideal log at rest may stand still, but its remainders move it in the end
_SPIKE = 1000  # times the rest
_WIDTH = 4  # samples on either side of a spike that may belong to it: interpolation spreads it
_KEPT = 1 << 10  # samples looked at again with the next ones
_AROUND = 64  # samples on either side of a spike that it is held against
_SPIKES = 4  # of a column in a block; more are no lone spikes
_NOISE = 4.0  # counts: second difference from which noise must show in every sample


@dataclass(frozen=True)
class Finding:
    """Something no sensor does.

    Attributes:
        kind: `zero`: all six counts are 0; `frozen`: all six stand still; `stuck`: one does while
            noise moves others; `rail`: a count is at its most negative or most positive; `spike`:
            a count is a thousand times the rest.
        first: number of the first sample.
        samples: how many: the length of a run, or all that stand at the rail.
        column: name of the count; None for all six.
        value: the count; None where there are several.
        time: stamp of the first sample, s; None where it is not known.
    """

    kind: FindingKind
    first: int
    samples: int
    column: str | None
    value: float | None
    time: float | None


class Plausibility:
    """Looks through the samples of a log, streaming.

    * All six counts 0 for a second and 100 samples: gravity alone forbids it.
    * All six the same for five seconds and 100 samples.
    * One count the same for a second and 100 samples, while another of the same sensor shows noise;
      or any other does, and the one itself showed noise before.  Noise has third differences larger
      than its second ones (by the medians), and these more than four counts: no smooth motion has.
    * A count at its rail.
    * A count a thousand times further from the middle than all others of its column within 64
      samples, four on either side left out.

    Args:
        design: gives widths and rate.
        rails: look for counts at their rails; not where what is looked at are no counts yet.
    """

    def __init__(self, design: Design, rails: bool = True) -> None:
        words = design.words
        allowed = [words.gyro] * 3 + [words.accel] * 3
        self._ends = np.array([[each.lo for each in allowed], [each.hi for each in allowed]])
        self._lo = np.array([each.lo for each in allowed], np.float64)
        self._hi = np.array([each.hi for each in allowed], np.float64)
        rate = design.sensor.sample_rate_hz
        self._look_at_rails = rails
        self._long = max(_MANY, round(_LONG * rate))
        self._frozen = max(_MANY, round(_FROZEN * rate))
        self._waiting: list[tuple[Samples, NDArray[np.float64] | None]] = []
        self._rows: Samples = np.zeros((0, 6), np.int64)  # the last ones looked at
        self._memory = self._rows  # where those that are looked at together lie
        self._turned: Samples | None = None
        self._times: NDArray[np.float64] | None = None
        self._first = 0  # number of the first of them
        self._since = np.zeros(7, np.int64)  # where the runs of each column, and of all, began
        self._since_times: list[float | None] = [None] * 7
        self._noisy = np.zeros(6, np.bool_)  # columns that have shown noise
        self.findings: list[Finding] = []
        self.counts: dict[FindingKind, int] = {}
        self._rail_samples = np.zeros(6, np.int64)
        self._rail_first: list[Finding | None] = [None] * 6
        self._spiked: set[tuple[int, int]] = set()

    def __call__(self, counts: Samples, times: NDArray[np.float64] | None = None) -> None:
        """Look at the next samples.

        Args:
            counts: (N, 6), in counts (whole or not).
            times: (N,) stamps, s.
        """
        self._waiting.append((counts, times))
        if sum(len(each) for each, _ in self._waiting) >= BLOCK:
            self._look(last=False)

    def finish(self) -> list[Finding]:
        """All findings in order, once no more samples come."""
        self._look(last=True)
        for finding, samples in zip(self._rail_first, self._rail_samples.tolist(), strict=True):
            if finding is not None:
                self._add(replace(finding, samples=samples))
        return sorted(self.findings, key=lambda each: each.first)

    def _add(self, finding: Finding) -> None:
        self.counts[finding.kind] = self.counts.get(finding.kind, 0) + 1
        if self.counts[finding.kind] <= LISTED:
            self.findings.append(finding)

    def _look(self, last: bool) -> None:
        """Look at what waits."""
        new = [each for each, _ in self._waiting]
        stamps = [times for _, times in self._waiting]
        self._waiting = []
        kept = len(self._rows)
        rows = self._joined(new)
        if not len(rows):
            return
        times = self._times
        if stamps and stamps[0] is not None:
            known = [each for each in stamps if each is not None]
            times = np.concatenate([*([] if times is None else [times]), *known])
        self._rows, self._times, self._turned = rows, times, None
        closely = self._screened(kept)
        if len(rows) > kept:
            if self._look_at_rails and closely & RAILS:
                self._rails(kept)
            if closely & RUNS:
                self._runs(kept)
            self._see_noise()
        if last:
            for column, since in enumerate(self._since.tolist()):
                if self._first + len(rows) - since >= self._long:
                    self._judge(column, since - self._first, len(rows))
        if closely & SPIKES:
            self._spikes(len(rows) if last else len(rows) - _AROUND)
        keep = min(_KEPT, len(rows))
        self._first += len(rows) - keep
        self._rows = rows[len(rows) - keep :].copy()
        self._times = None if times is None else times[len(rows) - keep :]

    def _joined(self, new: list[Samples]) -> Samples:
        """The rows at hand and the new ones, in memory that the next ones get too."""
        rows = [self._rows, *new]
        count, kind = sum(map(len, rows)), np.result_type(*rows)
        if len(self._memory) < count or self._memory.dtype != kind:
            self._memory = np.empty((count, 6), kind)
        return np.concatenate(rows, out=self._memory[:count])

    def _compiled(self) -> tuple[Callable[..., int], Callable[..., None]] | None:
        """The quick look; None for few samples, for which a compiler is not worth loading."""
        if self._rows.dtype != np.int64:
            return None
        least = WORTH_COMPILING
        if "numba" in sys.modules:
            least = min(least, WORTH_WHEN_LOADED)
        return compiled() if self._first >= least else None

    def _screened(self, new: int) -> int:
        """What must be looked at closely; runs are followed here where none of them is long."""
        quick = self._compiled()
        if quick is None or not new:
            return RAILS | RUNS | SPIKES
        begins = self._since - self._first
        found = quick[0](self._rows, new, begins, self._long, self._ends, _SPIKE / 2)
        if not found & RUNS:
            for column in np.flatnonzero(begins != self._since - self._first).tolist():
                self._since_times[column] = self._time(int(begins[column]))
            self._since = begins + self._first
        return found if len(self._rows) >= 4 * _WIDTH else found & ~SPIKES

    def _see_noise(self) -> None:
        """Which columns have shown noise."""
        if self._noisy.all():
            return
        quick = self._compiled()
        if quick is None:
            self._noisy |= _noise(self._rows)
        elif len(self._rows) >= _MANY:
            quick[1](self._rows[-_KEPT:], _NOISE, self._noisy)

    @property
    def _columns(self) -> Samples:
        """The rows turned, along which numpy is quick."""
        if self._turned is None:
            self._turned = np.ascontiguousarray(self._rows.T)
        return self._turned

    def _time(self, row: int) -> float | None:
        return None if self._times is None else float(self._times[row])

    def _rails(self, new: int) -> None:
        columns = self._columns[:, new:]
        low, high = columns.min(axis=1), columns.max(axis=1)
        for column in np.flatnonzero((low <= self._lo) | (high >= self._hi)).tolist():
            values = columns[column]
            at = np.flatnonzero((values <= self._lo[column]) | (values >= self._hi[column]))
            self._rail_samples[column] += len(at)
            if self._rail_first[column] is None:
                row = new + int(at[0])
                self._rail_first[column] = self._at("rail", row, 1, column)

    def _runs(self, new: int) -> None:
        """Runs that end among the new rows."""
        begin = max(new, 1)
        if not new:
            self._since_times = [self._time(0)] * 7
        changed = np.empty((7, len(self._rows) - begin), np.bool_)
        columns = self._columns
        np.not_equal(columns[:, begin:], columns[:, begin - 1 : -1], out=changed[:6])
        np.any(changed[:6], axis=0, out=changed[6])
        for column in range(7):
            ends = begin + np.flatnonzero(changed[column])  # rows that begin a new run
            if not len(ends):
                continue
            starts = np.concatenate([[self._since[column] - self._first], ends[:-1]])
            for run in np.flatnonzero(ends - starts >= self._long).tolist():
                self._judge(column, int(starts[run]), int(ends[run]))
            self._since[column] = self._first + int(ends[-1])
            self._since_times[column] = self._time(int(ends[-1]))

    def _judge(self, column: int, start: int, stop: int) -> None:
        """A run from row `start` (< 0: before those at hand) to row `stop` - 1."""
        run = self._rows[max(start, 0) : stop]
        time = self._time(start) if start >= 0 else self._since_times[column]
        first, samples = self._first + start, stop - start
        if column == 6:
            zero = not run[-1].any()
            if zero or samples >= self._frozen:
                kind: FindingKind = "zero" if zero else "frozen"
                self._add(Finding(kind, first, samples, None, None, time))
            return
        noise = _noise(run)
        same_sensor = np.arange(6) // 3 == column // 3
        if (noise & same_sensor).any() or (noise.any() and self._noisy[column]):
            name, value = INPUT_COLUMNS[column], float(run[-1, column])
            self._add(Finding("stuck", first, samples, name, value, time))

    def _at(self, kind: FindingKind, row: int, samples: int, column: int) -> Finding:
        """A finding of one column that begins at a row."""
        value, name = float(self._rows[row, column]), INPUT_COLUMNS[column]
        return Finding(kind, self._first + row, samples, name, value, self._time(row))

    def _spikes(self, end: int) -> None:
        """Spikes before row `end`, those told already left out."""
        columns = self._columns
        count = columns.shape[1]
        if count < 4 * _WIDTH:
            return
        steps = np.diff(columns, axis=1)
        np.abs(steps, out=steps)
        largest = steps.max(axis=1)
        suspects = largest > min(100, count / 8) * steps.mean(axis=1)
        for column in np.flatnonzero(suspects & (largest > _SPIKE / 2)).tolist():
            values = columns[column].astype(np.float64)
            padded = np.pad(values, _WIDTH + 1, mode="reflect")
            before, after = padded[:count], padded[2 * (_WIDTH + 1) :]
            out = np.minimum(np.abs(values - before), np.abs(values - after))
            for _ in range(_SPIKES):
                at = int(np.argmax(out))
                out[max(at - _WIDTH, 0) : at + _WIDTH + 1] = 0
                place = (column, self._first + at)
                if at < end and place not in self._spiked and _stands_out(values, at):
                    self._spiked.add(place)
                    self._add(self._at("spike", at, 1, column))


def _stands_out(values: NDArray[np.float64], at: int) -> bool:
    """Whether a value is a thousand times further from the middle than those around it."""
    first = max(at - _AROUND, 0)
    around = values[first : at + _AROUND + 1]
    off = np.abs(around - np.median(around))
    size = float(off[at - first])
    off[max(at - first - _WIDTH, 0) : at - first + _WIDTH + 1] = 0
    return size > _SPIKE * max(float(off.max()), 1.0)


def _noise(rows: Samples) -> NDArray[np.bool_]:
    """(6,) which columns show noise."""
    if len(rows) < _MANY:
        return np.zeros(6, np.bool_)
    second = np.diff(rows[-_KEPT:].astype(np.float64), n=2, axis=0)
    size, next_size = (np.median(np.abs(d), axis=0) for d in (second, np.diff(second, axis=0)))
    noisy: NDArray[np.bool_] = (size > _NOISE) & (next_size > size)
    return noisy


def in_words(
    findings: list[Finding],
    counts: dict[FindingKind, int],
    place: Callable[[int], str] = "sample {}".format,
    shown: int = 10,
) -> list[str]:
    """Findings in words, the first of many of a kind.

    Args:
        findings, counts: of `Plausibility`.
        place: names the place of a sample, given its number.
        shown: findings of a kind to list.
    """
    lines: list[str] = []
    seen: dict[FindingKind, int] = {}
    for each in findings:
        seen[each.kind] = seen.get(each.kind, 0) + 1
        if seen[each.kind] <= shown:
            lines.append(_words(each, place))
    for kind, count in counts.items():
        if count > shown:
            lines.append(f"{count - shown:,} more findings like these ({kind})")
    return lines


def _words(found: Finding, place: Callable[[int], str]) -> str:
    value = "" if found.value is None else f"{found.value:.9g}"
    time = "" if found.time is None else f" ({found.time:.15g} s)"
    at = f"{place(found.first)}{time}"
    run = f"from {at} on for {found.samples:,} samples"
    if found.kind == "zero":
        return f"all six counts are 0 {run}: was the sensor off?"
    if found.kind == "frozen":
        return f"all six counts stand still {run}: does the sensor still give new ones?"
    if found.kind == "stuck":
        return (
            f"{found.column} stands still at {value} {run}, while noise moves others: is it stuck?"
        )
    if found.kind == "rail":
        many = f"{found.samples:,} samples" if found.samples > 1 else "1 sample"
        return (
            f"{found.column} stands at its rail in {many}, first at {at} ({value}): the sensor's"
            " range was exceeded"
        )
    return f"{found.column} is {value} at {at}, more than a thousand times the rest: a spike?"
