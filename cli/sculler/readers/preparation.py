"""What is done to a recording before its stamps are looked at."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import COUNTS
from sculler.readers.recording import Recording, Samples, si_of_unit
from sculler.readers.running_sums import Differences, SumsSuspicion
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.samples import Plausibility, in_words

LARGEST, LONGEST = 1e30, 1e12
"""What no sensor gives in any unit, and no recording lasts (s): bytes of something else."""


def bounded(path: Path, recording: Recording) -> Recording:
    """The recording, refused where its numbers cannot be readings.

    Args:
        path: for the message.
        recording: as a reader gives it.

    Raises (as its samples are drawn):
        InputError: a value or a time is out of all bounds.
    """

    def chunks() -> Iterator[Samples]:
        first = 0
        for chunk in recording.chunks:
            tables: list[tuple[NDArray[np.float64], float, Sequence[str]]]
            tables = [(chunk.values, LARGEST, COUNTS)]
            if chunk.times is not None:
                tables.append((chunk.times[:, None], LONGEST, ("time (s from the first)",)))
            for table, most, names in tables:
                if table.size and max(table.max(), -table.min()) > most:
                    row, at = (int(i) for i in np.argwhere(np.abs(table) > most)[0])
                    raise InputError(
                        f"{path}: sample {first + row}: {names[at]} is {table[row, at]:.3g}, which"
                        " no sensor gives; check --format and the columns"
                    )
            first += len(chunk.values)
            yield chunk

    return replace(recording, chunks=chunks())


def signed(recording: Recording, signs: Sequence[float]) -> Recording:
    """The recording with each of its six columns times its sign."""
    if all(sign > 0 for sign in signs):
        return recording
    factors = np.array(signs)
    chunks = (chunk._replace(values=chunk.values * factors) for chunk in recording.chunks)
    turned = [name for name, sign in zip(COUNTS, signs, strict=True) if sign < 0]
    notes = {**recording.notes, "signs": f"negative of the column: {', '.join(turned)}"}
    return replace(recording, chunks=chunks, notes=notes)


def differenced(recording: Recording, differences: Differences) -> Recording:
    """Increments from a recording of running sums."""
    return replace(recording, chunks=differences(recording.chunks))


def unstamped(recording: Recording) -> Recording:
    """The recording without its stamps."""
    chunks = (chunk._replace(times=None) for chunk in recording.chunks)
    notes = {topic: note for topic, note in recording.notes.items() if topic != "time stamps"}
    return replace(recording, chunks=chunks, clock=None, notes=notes)


class Watch:
    """Looks at the numbers of a recording as they pass, sample for sample as the file has them.

    Args:
        design: gives scales and widths.
        recording: gives units and clock.
        sums: the numbers are running sums no more.
    """

    def __init__(self, design: Design, recording: Recording, sums: bool) -> None:
        self._recording = recording
        sensors = (("gyro", recording.gyro), ("accel", recording.accel))
        lsbs = (design.sensor.gyro.lsb, design.sensor.accel.lsb)
        si = [si_of_unit(design, sensor, unit) for sensor, unit in sensors]
        self._counts = np.repeat([each / lsb for each, lsb in zip(si, lsbs, strict=True)], 3)
        self._accel = si[1]
        own = recording.gyro.si is None and recording.accel.si is None
        self._plausibility = Plausibility(design, rails=own)
        self._sums = None
        kinds = {recording.gyro.kind, recording.accel.kind}
        if design.sensor.kind == "increment" and "rate" not in kinds and not sums:
            self._sums = SumsSuspicion(STANDARD_GRAVITY * design.sample_interval)

    def __call__(self, chunks: Iterator[Samples]) -> Iterator[Samples]:
        """The same chunks."""
        for chunk in chunks:
            clock, times = self._recording.clock, chunk.times
            if clock is not None and times is not None:
                times = times + clock.origin
            self._plausibility(chunk.values * self._counts, times)
            if self._sums is not None and len(chunk.values):
                self._sums(chunk.values, chunk.values[:, 3:] * self._accel)
            yield chunk

    def sums(self) -> list[str]:
        """Whether the numbers look like running sums so far."""
        return [] if self._sums is None else self._sums.told()

    def warnings(self) -> list[str]:
        """What was found, once all samples have passed."""
        found = self._plausibility.finish()
        return [*self.sums(), *in_words(found, self._plausibility.counts)]
