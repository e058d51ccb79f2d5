"""Breaks in a log: where its stamps or its counter say that samples are missing.

A break is refused, since whatever runs across it is wrong from there on; or the log is split there
and the core begins anew: `major` from 0, no history.  `time_s` is judged by `stamps`, so that
jitter is no break.  `sequence` must go up by one; it may wrap where a counter of 8, 16 or 32 bits
does, signed or not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import chain
from typing import Any, Literal

import numpy as np

from sculler.checks.stamps import Shift, ShiftFinder, wrong_rate
from sculler.formats.log import Chunk
from sculler.formats.tables import counting
from sculler_model.design import Design
from sculler_model.errors import InputError

Policy = Literal["refuse", "split"]

LISTED = 100
"""Breaks kept one by one; the rest are counted only."""

_WIDTHS = (8, 16, 32)  # bits of counters
_SAME = 8  # samples: a shift of the stamps this near a jump of the counter is the same break


@dataclass(frozen=True)
class Break:
    """Where a log does not go on as it should.

    Attributes:
        sample: number of the first sample after it, from 0.
        line: of that sample in the log; of a binary file the row, from 1.
        time_s: stamp of the last sample before it; None where the log has no stamps.
        missing: samples that are not there; None where it cannot be told.
        what: in words.
        unit: `line` or `row`.
    """

    sample: int
    line: int
    time_s: float | None
    missing: int | None
    what: str
    unit: str = "line"

    def describe(self) -> str:
        """The place and what is there."""
        return f"{self.unit} {self.line}: {self.what}"


class BreakFinder:
    """Cuts the samples of a log at its breaks.

    Args:
        design: its sample interval is what stamps are held against.
        name: of the log, for messages.
        policy: refuse breaks, or split the log there.

    Attributes:
        count: breaks found.
        breaks: the first of them.
        wraps: how often the counter wrapped, by its width in bits.
    """

    def __init__(self, design: Design, name: str, policy: Policy = "refuse") -> None:
        self._design, self._name, self._policy = design, name, policy
        self._rows = counting(name)
        self._stamps = ShiftFinder(design.sample_interval)
        self._read = self._given = 0  # samples
        self._waiting: list[Chunk] = []  # those read and not given
        self._last_sequence: int | None = None
        self._jumps: list[Break] = []  # of the counter, still to be given
        self._last_break = -1 - _SAME  # its sample
        self._rate_checked = False
        self.count = 0
        self.breaks: list[Break] = []
        self.wraps: dict[int, int] = {}

    def __call__(self, chunks: Iterator[Chunk]) -> Iterator[Chunk | Break]:
        """The same samples in other chunks, and each break before the samples that follow it.

        Samples with stamps are held back until it is known whether one of them is out of place.

        Raises:
            InputError: there is a break and it is not to be split at, or the stamps show another
                sample rate; the line is named.
        """
        for chunk in chain(chunks, [None]):
            if chunk is None and not self._waiting:
                return
            if chunk is not None and chunk.times is None and chunk.sequence is None:
                yield chunk
                continue
            if chunk is not None:
                self._waiting.append(chunk)
                self._jumps += self._counter(chunk)
                self._read += len(chunk.counts)
            shifts, decided = self._shifts(chunk, self._waiting[0].times is not None)
            yield from self._cut(self._merged(shifts, decided), decided)

    def _counter(self, chunk: Chunk) -> list[Break]:
        """Where the counter of the next samples does not go up by one."""
        if chunk.sequence is None or not len(chunk.sequence):
            return []
        last = chunk.sequence[0] - 1 if self._last_sequence is None else self._last_sequence
        values = np.concatenate([[last], chunk.sequence])
        self._last_sequence = int(values[-1])
        steps = np.diff(values)
        wrong = steps != 1
        for bits in _WIDTHS:
            for highest in ((1 << bits) - 1, (1 << bits - 1) - 1):
                wraps = wrong & (values[:-1] == highest) & (steps == 1 - (1 << bits))
                if wraps.any():
                    self.wraps[bits] = self.wraps.get(bits, 0) + int(wraps.sum())
                    wrong &= ~wraps
        found = []
        for at in np.flatnonzero(wrong).tolist():
            before, after = int(values[at]), int(values[at + 1])
            missing = after - before - 1 if after > before else None
            what = f"sequence goes from {before} to {after}"
            time = None
            if chunk.times is not None:
                time = float(chunk.times[at - 1]) if at else self._time_before()
            found.append(self._break(self._read + at, time, missing, what))
        return found

    def _time_before(self) -> float | None:
        """Stamp of the last sample before the chunk that was appended last."""
        if len(self._waiting) < 2:
            return None
        times = self._waiting[-2].times
        return None if times is None or not len(times) else float(times[-1])

    def _shifts(self, chunk: Chunk | None, stamped: bool) -> tuple[list[Break], int]:
        """The shifts of the stamps that can be told, and up to which sample they can be."""
        if not stamped:
            return [], self._read
        times = np.empty(0) if chunk is None or chunk.times is None else chunk.times
        shifts = self._stamps(times, last=chunk is None)
        decided = self._stamps.decided
        if not self._rate_checked and decided > 1:
            self._rate_checked = True
            self._require_rate(shifts, decided)
        T = self._design.sample_interval
        return [
            self._break(shift.sample, shift.time, shift.missing, _words(shift, T))
            for shift in shifts
        ], decided

    def _require_rate(self, shifts: list[Shift], decided: int) -> None:
        times = [chunk.times for chunk in self._waiting if chunk.times is not None]
        T = self._design.sample_interval
        rate = wrong_rate(np.concatenate(times)[:decided], shifts, T)
        if rate is not None:
            raise InputError(
                f"{self._name}: time_s shows {rate:.6g} Hz but sensor.sample_rate_hz ="
                f" {1 / T:.6g}, take the log's own design (or sculler convert --steps resample)"
            )

    def _break(self, sample: int, time: float | None, missing: int | None, what: str) -> Break:
        if missing is not None and missing > 0:
            what += f", {missing:,} sample{'s are' if missing > 1 else ' is'} missing"
        rows = self._rows
        return Break(sample, sample + rows.first, time, missing, what, rows.unit)

    def _merged(self, shifts: list[Break], decided: int) -> list[Break]:
        """Shifts and jumps before sample `decided`, in order; what both show is one break."""
        jumps = [jump for jump in self._jumps if jump.sample < decided]
        self._jumps = self._jumps[len(jumps) :]
        near = np.array([jump.sample for jump in (*jumps, *self._jumps)], np.int64)
        near = np.append(near, self._last_break)
        alone = [shift for shift in shifts if np.abs(near - shift.sample).min() > _SAME]
        return sorted([*jumps, *alone], key=lambda each: each.sample)

    def _cut(self, breaks: list[Break], decided: int) -> Iterator[Chunk | Break]:
        """What waits, up to sample `decided`, cut at the breaks."""
        whole = _joined(self._waiting)
        begin = self._given
        for each in breaks:
            self._note(each)
            if each.sample > self._given:
                yield whole.part(slice(self._given - begin, each.sample - begin))
            self._given = each.sample
            yield each
        if decided > self._given:
            yield whole.part(slice(self._given - begin, decided - begin))
            self._given = decided
        rest = whole.part(slice(self._given - begin, None))
        self._waiting = [rest] if len(rest.counts) else []

    def _note(self, each: Break) -> None:
        if self._policy == "refuse":
            raise InputError(
                f"{self._name}: {each.describe()}; give --breaks split to begin anew there"
                + (", or fill gaps with sculler convert --gaps bridge" if each.missing else "")
            )
        self.count += 1
        self._last_break = each.sample
        if len(self.breaks) < LISTED:
            self.breaks.append(each)

    def as_json(self) -> dict[str, Any]:
        """As plain data."""
        return {
            "break_count": self.count,
            "breaks": [asdict(each) for each in self.breaks],
            "sequence_wraps": {f"{bits} bits": times for bits, times in self.wraps.items()},
        }

    def warnings(self, shown: int = 10) -> list[str]:
        """Each break, the first of many."""
        told = [
            f"{each.describe()}: the core began anew there, major from 0"
            for each in self.breaks[:shown]
        ]
        if self.count > shown:
            told.append(f"{self.count - shown:,} more breaks, the core began anew at each")
        return told


def _words(shift: Shift, interval: float) -> str:
    """A shift of the stamps in words."""
    to = shift.time + shift.seconds
    if shift.missing > 0:
        steps = f"from {shift.time:.15g} to {to:.15g}"
        return f"time_s goes {steps} where the interval is {interval:.6g} s"
    if shift.seconds < 0:
        return f"time_s goes back from {shift.time:.15g} to {to:.15g}"
    many = f"{-shift.missing:,} sample{'s' if shift.missing < -1 else ''} too many for the time"
    stands = "repeats the stamp before" if shift.seconds == 0 else "falls behind"
    return f"time_s {stands} ({shift.time:.15g}), {many}"


def _joined(chunks: list[Chunk]) -> Chunk:
    if len(chunks) == 1:
        return chunks[0]
    counts, *others = zip(*chunks, strict=True)
    joined = [None if column[0] is None else np.concatenate(column) for column in others]
    return Chunk(np.concatenate(counts), *joined)
