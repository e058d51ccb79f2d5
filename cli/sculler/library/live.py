"""`LiveNavigator`: navigation states as major intervals complete, from counts or stream words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler.library.counts import CountsLike, as_marks, as_times, whole
from sculler.library.logs import Log
from sculler.library.models import FastModel, with_ends
from sculler.library.navigating import Begin, make_plan, require_place
from sculler.runs.navigation import NavigationRun
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.golden import WORD_BITS, from_words, words_per_column, words_per_result
from sculler_model.navigation import (
    Alignment,
    FineAlignment,
    NavHistory,
    NavState,
)
from sculler_model.samples import interval_end, interval_ends, sample_stamp

if TYPE_CHECKING:
    from typing_extensions import Unpack

BREAK = 0.75
"""Samples: a step of the stamps this much longer or shorter than a sample interval is a break."""


class LiveNavigator:
    """Carries attitude, velocity and position while samples or results come in.

    It is fed from one source, and gives the states that are new:

    - `feed`: counts, one sample or a burst; the exact sums are then made here;
    - `feed_words`: 16-bit words of a core with `handover = "stream"`, in bursts of any length;
    - `feed_vectors`: results of a core, however they came.

    The status of each result is handled as `sculler navigate` does: those of short history (bit 0)
    at the beginning or after a break are left out; faults, rails and lost samples (bits 1 to 3) are
    navigated with and told in `warnings`.  Over a break attitude and velocity are kept and the
    position goes on with the velocity, as `--breaks split` does; unlike there nothing is aligned
    anew, for nobody knows whether the vehicle stands.  A break inside the window of alignment
    begins the window anew.  Memory is bounded but for that window.

    Args:
        design: the sensor and the algorithm.
        sequence_bits: width of the counter given to `feed`, which wraps there.
        compiled: navigate through Numba, which is loaded (the very first time compiled) here, so
            that nothing stops in flight; else in Python, which is fast enough for one vehicle.
        begin: where the run begins and what carries it, the keywords of `navigate`: lat, lon
            (degrees), height (m), heading and others (degrees), vn, ve, vd (m/s), align (s), axes.
            A `height_reference` may grow: `add` a barometer's values to it as they come.

    Raises:
        InputError: an argument has a fault, the place is missing, or Numba where it is asked for.

    Examples:
        >>> import sculler
        >>> design = sculler.Design.preset("hg4930")
        >>> log = sculler.record(design, sculler.motion("rest"), 0.5)
        >>> live = sculler.LiveNavigator(design, lat=48, lon=11, height=500)
        >>> states = [len(live.feed(sample)) for sample in log.counts]
        >>> sum(states), f"{live.state.time:.2f}", live.warnings
        (13, '0.48', [])
    """

    def __init__(
        self,
        design: Design,
        *,
        sequence_bits: int = 32,
        compiled: bool = False,
        **begin: Unpack[Begin],
    ) -> None:
        require_place(begin)
        if begin.get("rest") is not None:
            raise InputError("rest: a live run cannot go back to take the bias out, leave it out")
        plan = make_plan(design, "live", begin)
        carrier = replace(plan.carrier, compiled=compiled)
        plan = replace(plan, carrier=carrier, split=True, realign=False)
        if compiled:  # loaded here and now
            anywhere = plan.given.state(0.0, None)
            carrier.begin(anywhere, design.major_interval, plan.damping(anywhere.h), plan.gravity)
        self.design = design
        self._new: list[NavHistory] = []
        self._run = NavigationRun(plan, self._new.append)
        self._source: str | None = None
        # counts
        self._model = FastModel(design)
        self._sequence_span = 1 << sequence_bits
        self._last_sequence: int | None = None
        self._last_stamp: float | None = None
        # without stamps: that of the first sample, and how many there were since
        self._clock, self._count = sample_stamp(design, 0), 0
        # words and results
        self._words: list[int] = []
        self._major = -1
        self._zero = 0.0  # s, the clock when the core was reset last
        self._end = interval_end(design, -1)
        self._silence: float | None = None

    @property
    def state(self) -> NavState | None:
        """The present state, at the end of the last interval; None before the run has begun."""
        return self._run.seen.end

    @property
    def aligned(self) -> Alignment | FineAlignment | None:
        """What the alignment found; None before its end, or where none was asked for."""
        return self._run.seen.fine or self._run.seen.alignment

    @property
    def breaks(self) -> list[dict[str, float | int | str]]:
        """The breaks so far: what showed each, how many seconds, and what became of it."""
        return self._run.seen.breaks

    @property
    def warnings(self) -> list[str]:
        """What to look at before trusting the states, a line each."""
        seen, found = self._run.seen, self.aligned
        told = [] if found is None else list(found.warnings)
        told += [
            f"a break of {each['seconds']:.6g} s ({each['what']}): {each['then']}"
            for each in seen.breaks
        ]
        return told + seen.status_warnings() + self._run.height_warnings

    def feed(
        self,
        counts: CountsLike,
        faults: ArrayLike | None = None,
        times: ArrayLike | None = None,
        sequence: ArrayLike | None = None,
    ) -> NavHistory:
        """Take the next samples, one or a burst.

        Args:
            counts: (N, 6), or (6,) for one sample, whole numbers in the sensor's LSB and axes: gyro
                x, y, z, accelerometer x, y, z; or a `Log` or a frame with all columns.
            faults: (N,) of 0 and 1, 1 where the sensor said that the sample is faulty.
            times: (N,) s, the sensor's stamps, good to less than `BREAK` of a sample interval; None
                to count the samples.  Where a step is not a sample interval the sums begin anew.
            sequence: (N,) a counter of samples; where it goes up by more than one samples are
                missing and the sums begin anew.

        Returns:
            The states that are new, at the ends of the intervals that completed; the first one of
            a run is that at its start.  Often none.

        Raises:
            InputError: a value has a fault, or the counter goes back without times; then nothing
                of them is taken.  Or stamps run back, or the navigator cannot follow.
        """
        self._only("samples")
        log = counts if isinstance(counts, Log) else Log.of(counts, faults, times, sequence)
        log = Log.of(
            log.counts,
            log.faults if faults is None else as_marks("faults", faults, len(log)),
            log.times if times is None else as_times(times, len(log)),
            log.sequence if sequence is None else sequence,
            design=self.design,
        )
        for part in self._unbroken(log):
            phase = self._model.leftover
            block = self._model.feed(part.counts, part.faults)
            self._run.feed(with_ends(self.design, block, part.times, phase))
        return self._told()

    def feed_words(self, words: ArrayLike) -> NavHistory:
        """Take the next words of a core's stream hand-over, in a burst of any length.

        Args:
            words: (N,) unsigned 16-bit words in the order they are sent, the least significant
                first (docs/reference/ports.md); what is left of a result is kept for the next.

        Returns:
            The states that are new, as `feed`.

        Raises:
            InputError: a word is no 16-bit word, the core was reset without `gap`, or the navigator
                cannot follow.
        """
        self._only("words")
        taken = whole("words", words).ravel()
        if len(taken) and (taken.min() < 0 or taken.max() >> WORD_BITS):
            raise InputError("words: one is outside 0 to 65535, give unsigned 16-bit words")
        self._words += taken.tolist()
        size = words_per_result(self.design)
        rows = []
        while len(self._words) >= size:
            rows.append(from_words(self.design, self._words[:size]))
            del self._words[:size]
        if rows:
            self._results(
                VectorBlock.from_rows(rows, self.design), WORD_BITS * words_per_column(self.design)
            )
        return self._told()

    def drop_words(self) -> int:
        """Forget the words of a result that is not whole, where the line lost some.

        Returns:
            How many there were.
        """
        dropped = len(self._words)
        self._words.clear()
        return dropped

    def feed_vectors(self, vectors: VectorBlock) -> NavHistory:
        """Take the next results of a core.

        Args:
            vectors: (R,) results; their times (s) count where they have them, else `major` does.

        Returns:
            The states that are new, as `feed`.

        Raises:
            InputError: they are of another design, the core was reset without `gap` and without
                times, or the navigator cannot follow.
        """
        self._only("results")
        if vectors.columns != self.design.columns:
            raise InputError(
                f"vectors: {len(vectors.columns)} columns where design {self.design.name} has"
                f" {len(self.design.columns)}, give its own vectors"
            )
        if vectors.times is None:
            self._results(vectors, None)
        else:
            self._run.feed(vectors)
        return self._told()

    def gap(self, seconds: float) -> None:
        """Say that the source was silent and begins anew: the next sample or result is the first.

        Args:
            seconds: from the end of the last sample or result to the beginning of the next.

        Raises:
            InputError: the time is negative or not finite.
        """
        if not 0 <= seconds < float("inf"):
            raise InputError(f"seconds: {seconds} is not allowed, give 0 or more")
        if self._source == "samples":
            self._model.reset()
            self._clock += seconds
            self._last_stamp = self._last_sequence = None
        self._silence = seconds
        self._words.clear()

    def _only(self, source: str) -> None:
        if self._source not in (None, source):
            raise InputError(f"fed with {self._source} before, go on with them and not {source}")
        self._source = source

    def _told(self) -> NavHistory:
        """The states since the last call."""
        parts = [part for part in self._new if len(part)]
        self._new.clear()
        return NavHistory.concatenate(parts) if parts else NavHistory.from_states([])

    def _unbroken(self, log: Log) -> Iterator[Log]:
        """Samples in parts without a break, all with stamps; the model begins anew before each."""
        T = self.design.sample_interval
        jumps = self._jumps(log)
        if log.times is None:
            number = self._count + np.arange(len(log)) + np.cumsum(jumps)
            self._count = int(number[-1]) + 1 if len(log) else self._count
            stamps = self._clock + number / self.design.sensor.sample_rate_hz
        else:
            stamps = log.times
            last = stamps[:1] - T if self._last_stamp is None else [self._last_stamp]
            steps = np.diff(np.concatenate([last, stamps]))
            jumps = jumps + (np.abs(steps - T) > BREAK * T)
        cuts = [0, *(np.flatnonzero(jumps[1:]) + 1).tolist(), len(log)]
        for first, end in pairwise(cuts):
            if first == end:
                continue
            if jumps[first]:
                self._model.reset()
            rows = slice(first, end)
            yield Log(
                log.counts[rows],
                None if log.faults is None else log.faults[rows],
                stamps[rows],
            )
        if len(log) and log.times is not None:
            self._last_stamp = float(stamps[-1])
            self._clock, self._count = self._last_stamp + T, 0

    def _jumps(self, log: Log) -> NDArray[np.int64]:
        """Before each sample how many are missing by the counter."""
        if log.sequence is None or not len(log):
            return np.zeros(len(log), np.int64)
        last = log.sequence[0] - 1 if self._last_sequence is None else self._last_sequence
        values = np.concatenate([[last], log.sequence])
        missing: NDArray[np.int64] = (np.diff(values) - 1) % self._sequence_span
        back = missing >= self._sequence_span // 2
        if back.any() and log.times is None:
            row = int(np.argmax(back))
            raise InputError(
                f"sequence: goes back from {values[row]} to {values[row + 1]}, and without times"
                " nobody knows how long that took; leave out samples that came twice, or say"
                " gap(seconds) before a sensor that began anew"
            )
        self._last_sequence = int(values[-1])
        return missing

    def _results(self, block: VectorBlock, major_bits: int | None) -> None:
        """Results whose instants `major` tells, on a clock that goes on over a reset."""
        for row in range(len(block)):
            major = int(block.major[row])
            if major_bits is not None:  # it came modulo 2 to these bits
                span = 1 << major_bits
                ahead = (major - self._major) % span
                if self._major >= span // 2 and ahead < span // 2:
                    major = self._major + ahead
            if self._silence is not None or major <= self._major:
                if self._silence is None:
                    raise InputError(
                        f"major falls back from {self._major} to {major}, the core was reset: say"
                        " how long that took by gap(seconds) before"
                    )
                self._zero = self._end + self._silence - interval_end(self.design, -1)
                self._silence = None
            self._major = major
            self._end = self._zero + float(interval_ends(self.design, np.array([major]))[0])
            self._run.feed(
                VectorBlock(
                    np.array([major]),
                    block.status[row : row + 1],
                    block.components[row : row + 1],
                    np.array([self._end]),
                )
            )
