"""A foreign log to the integer log the core reads."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import CHANNEL, LogWriter
from sculler.readers.mounting import Mounting
from sculler.readers.preparation import Watch, bounded, differenced, signed, unstamped
from sculler.readers.recording import Recording, Samples, Unit
from sculler.readers.resampling import resampled
from sculler.readers.running_sums import Differences
from sculler.readers.timing import Timing
from sculler.runs.channel_source import NOT_LOOKED_AT
from sculler.runs.conversion.channels import ChannelConversions, refuse_what_is_not_built
from sculler.runs.conversion.counts import Biases, Conversion
from sculler.runs.conversion.outcome import Outcome
from sculler.runs.conversion.plan import MAX_GAP, Plan
from sculler.words import Advance, silent
from sculler_model import inputs
from sculler_model.errors import ContradictionError, InputError
from sculler_model.outputs import replacing
from sculler_model.samples import Kind, Resampler


def convert_log(plan: Plan, output: Path, *, advance: Advance = silent) -> Outcome:
    """Bring a log's numbers to the design's counts and write them as an integer log.

    Args:
        plan: what to convert, and how.
        output: the log; it appears whole or not at all.
        advance: told the bytes that were read.

    Raises:
        ContradictionError: the plan asks for what does not go with the file's stamps or units.
        InputError: the file has a fault, or its numbers do not fit the design.
    """
    inputs.require_file(plan.log, "log")
    log_format = plan.found_format()
    mounting, biases = plan.mounting(log_format), plan.biases(log_format)
    with replacing(output) as temporary:
        kind = _ChannelPass if plan.design.channels > 1 else _Pass
        pass_ = kind(plan, log_format, mounting, biases, advance)
        pass_.write(temporary)
    return pass_.outcome(output)


class _Pass:
    """One pass over the samples: what happens to them, in order, and what is told of it."""

    def __init__(
        self, plan: Plan, log_format: str, mounting: Mounting, biases: Biases, advance: Advance
    ) -> None:
        self.plan, self.log_format = plan, log_format
        self.mounting, self.biases = mounting, biases
        self.undo = plan.undo()
        self.recording, self.differences = _prepared(plan, log_format, advance)
        design, recording = plan.design, self.recording
        self.given = _kind(plan, recording)
        self.watch = Watch(design, recording, self.differences is not None)
        self.chunks: Iterator[Samples] = self.watch(recording.chunks)
        self.timing = self._timing()
        if self.timing is not None:
            self.chunks = self.timing(self.chunks)
        self.resampler = _resampler(plan, self.given)
        if self.resampler is not None:
            interval = design.sample_interval
            self.chunks = resampled(self.chunks, self.resampler, interval, plan.steps)
        self.conversion = self._conversion()

    def _timing(self) -> Timing | None:
        """What looks at the stamps, if there are any."""
        plan = self.plan
        if self.recording.clock is not None:
            return Timing(
                plan.log,
                plan.design,
                self.recording,
                self.given,
                plan.gaps,
                plan.max_gap or MAX_GAP,
                plan.steps,
                plan.start,
                plan.stop,
            )
        resample, bridge = plan.steps == "resample", plan.gaps == "bridge"
        if bridge or resample or plan.start is not None or plan.stop is not None:
            raise ContradictionError(
                "--gaps bridge, --steps resample, --start and --stop need time stamps, give"
                " --time-column"
            )
        return None

    def _conversion(self) -> Conversion:
        plan, recording = self.plan, self.recording
        gyro, accel = (
            _unit(plan, unit, self.given, self.resampler)
            for unit in (recording.gyro, recording.accel)
        )
        reworked = plan.gaps == "bridge" or self.resampler is not None or self.undo is not None
        return Conversion(plan.log, plan.design, gyro, accel, self.mounting, self.biases, reworked)

    def write(self, path: Path) -> None:
        """Take all samples."""
        faults = self.recording.has_faults or self.plan.gaps == "bridge"
        clock = self.recording.clock
        to_instant = _to_instant(self.plan, self.given, self.resampler)
        with LogWriter(path, faults=faults, times=clock is not None) as writer:
            for chunk in self._in_si():
                times = None if chunk.times is None else chunk.times + to_instant
                try:
                    counts = self._counts(chunk)
                except InputError as error:
                    raise InputError("; ".join([str(error), *self.watch.sums()])) from error
                writer.write(counts, chunk.faults, times, 0.0 if clock is None else clock.origin)
        if not self.conversion.samples:
            raise InputError(
                f"{self.plan.log}: too few samples to make an increment of (or none from --start"
                " to --stop), give more"
            )

    def _in_si(self) -> Iterator[Samples]:
        """The samples; where errors are to be undone, in SI and without them."""
        if self.undo is None:
            yield from self.chunks
            return
        held = Samples(np.zeros((0, 6)))
        for chunk in chain(self.chunks, [None]):
            if chunk is not None:
                done = self.undo(self.conversion.si(chunk.values))
                held = _joined(held, chunk)
            else:
                done = self.undo.finish()
            marks, times = held.faults, held.times
            if len(done):
                yield Samples(
                    done,
                    None if marks is None else marks[: len(done)],
                    None if times is None else times[: len(done)],
                )
            held = Samples(
                held.values[len(done) :],
                None if marks is None else marks[len(done) :],
                None if times is None else times[len(done) :],
            )

    def _counts(self, chunk: Samples) -> NDArray[np.int64]:
        if self.undo is None:
            return self.conversion(chunk.values)
        return self.conversion.counted(chunk.values, chunk.values)

    def outcome(self, output: Path) -> Outcome:
        """What came of it."""
        return Outcome(
            self.plan,
            output,
            self.log_format,
            self.recording,
            self.conversion,
            self.mounting,
            self.biases,
            self.timing,
            self.differences,
            None if self.resampler is None else self.resampler.left_out,
            self.watch.warnings(),
        )


class _ChannelPass:
    """One pass over the samples of many channels, which stay in their order."""

    def __init__(
        self, plan: Plan, log_format: str, mounting: Mounting, biases: Biases, advance: Advance
    ) -> None:
        refuse_what_is_not_built(plan)
        self.plan, self.log_format = plan, log_format
        self.mounting, self.biases = mounting, biases
        self.recording, _ = _prepared(plan, log_format, advance)
        if not self.recording.has_channels:
            raise InputError(
                f"{plan.log}: column {CHANNEL} is missing, give CSV with it:"
                f" hardware.channels = {plan.design.channels}"
            )
        self.given = _kind(plan, self.recording)
        if _resampler(plan, self.given) is not None:
            raise ContradictionError(
                "rates at instants are not integrated for a design with channels, give --rates mean"
            )
        units = self.recording.gyro, self.recording.accel
        self.conversion = ChannelConversions(plan.log, plan.design, *units, mounting, biases)

    def write(self, path: Path) -> None:
        """Take all samples."""
        recording, clock = self.recording, self.recording.clock
        to_instant = _to_instant(self.plan, self.given, None)
        with LogWriter(
            path, recording.has_faults, clock is not None, True, recording.has_restarts
        ) as writer:
            for chunk in recording.chunks:
                times = None if chunk.times is None else chunk.times + to_instant
                writer.write(
                    self.conversion(chunk),
                    chunk.faults,
                    times,
                    0.0 if clock is None else clock.origin,
                    chunk.channels,
                    chunk.restarts,
                )

    def outcome(self, output: Path) -> Outcome:
        """What came of it."""
        doubts = [] if self.recording.clock is None else [NOT_LOOKED_AT]
        return Outcome(
            self.plan,
            output,
            self.log_format,
            self.recording,
            self.conversion,
            self.mounting,
            self.biases,
            doubts=doubts,
        )


def _joined(one: Samples, other: Samples) -> Samples:
    """Samples that follow each other; the first may be none."""
    if not len(one.values):
        return other
    assert (one.faults is None) == (other.faults is None)
    faults = None
    if one.faults is not None and other.faults is not None:
        faults = np.concatenate([one.faults, other.faults])
    times = None
    if one.times is not None and other.times is not None:
        times = np.concatenate([one.times, other.times])
    return Samples(np.concatenate([one.values, other.values]), faults, times)


def _prepared(
    plan: Plan, log_format: str, advance: Advance
) -> tuple[Recording, Differences | None]:
    """The recording, its signs and running sums undone, and what undid the sums."""
    recording = bounded(plan.log, plan.open(log_format, advance))
    recording = signed(recording, plan.layout.signs())
    differences = None
    if plan.sums is not None:
        differences = plan.sums.differences(plan.log, recording)
        recording = differenced(recording, differences)
    if plan.layout.time_column == "none":
        recording = unstamped(recording)
    return recording, differences


def _kind(plan: Plan, recording: Recording) -> Kind:
    """What the values are to be taken as: rates at instants, or increments over the steps."""
    own = plan.design.sensor.kind
    kinds = {unit.kind or own for unit in (recording.gyro, recording.accel)}
    if kinds == {"rate"} and (plan.rates == "instant" or own == "rate"):
        return "rate"
    if "rate" in kinds and plan.steps == "resample":
        raise ContradictionError(
            "--steps resample takes rates at instants, of the gyro and the accelerometer alike, or"
            " increments of both; leave it out"
        )
    if len(kinds) > 1 and plan.rates == "instant":
        raise ContradictionError(
            "rates of one sensor and increments of the other cannot be integrated alike, give"
            " --rates mean"
        )
    return "increment"


def _resampler(plan: Plan, given: Kind) -> Resampler | None:
    """What brings the samples to the increments or rates of the design; None if they are."""
    design, wanted = plan.design, plan.design.sensor.kind
    if plan.steps == "resample" or (given == "rate" and wanted == "increment"):
        return Resampler(design.sample_interval, given, wanted)
    return None


def _to_instant(plan: Plan, given: Kind, resampler: Resampler | None) -> float:
    """From the stamps to the instants of the design's samples, s.

    A mean over the interval that ends at a stamp is the rate in the interval's middle.
    """
    mean = plan.rates == "mean" if given == "rate" else resampler is None
    rate = plan.design.sensor.kind == "rate"
    return -0.5 * plan.design.sample_interval if mean and rate else 0.0


def _unit(plan: Plan, unit: Unit, given: Kind, resampler: Resampler | None) -> Unit:
    """The unit of the values as they come to the conversion."""
    if resampler is None:
        return unit
    kind = plan.design.sensor.kind
    done = "integrated by cubics" if given == "rate" else "resampled to even steps"
    if given == kind == "rate":
        done = "interpolated to even steps"
    return Unit(f"{unit.name}, {done}", unit.si, None if unit.kind is None else kind)
