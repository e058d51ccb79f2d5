"""A motion's samples behind any filter, and all that a sensor delivers of a motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import ceil, pi
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import Measured, Response
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.motion.curves import Array
from sculler_model.motion.earthbound import Motion
from sculler_model.motion.placed import as_felt
from sculler_model.motion.sampling import Sampled
from sculler_model.samples import Passing

_LEAST, _MOST, _MEASURED = 1 << 12, 1 << 20, 1 << 16
"""Fine steps of a filter's memory: at least, at most; and of a measured response, whose corners
have no end in time."""

_BLOCK = 1 << 17
"""Fine steps of a block."""

_TAIL = 1e-13
"""What of a filter's memory may be left out, of all of it."""


@dataclass(frozen=True)
class Filtered:
    """A motion as a sensor delivers it whose samples have passed a filter.

    A sample interval is cut into fine steps.  The weights of the fine steps are the Fourier
    transform of the response, which falls off smoothly where no motion has anything: from half to
    all of the fine steps' Nyquist frequency, which is eight times the samples' or more.  So a
    vibration comes out with the gain and the phase of F to some 1e-12.  Before time 0 everything
    stood as in the first fine step, if not said otherwise; beyond the end the motion goes on.
    Above the last frequency of a measured response it is as at the last.

    Attributes:
        motion: what the sensor feels.
        response: F, as a function of the phase a sample interval.
        kind: increments are filtered and summed up; a rate is the filter's value at its instant.
        interval: T, s.
        still: whether everything stood still before time 0; else the motion had been going on.
    """

    motion: Sampled
    response: Response
    kind: Literal["increment", "rate"]
    interval: float
    still: bool = True

    def chunks(self, samples: int, chunk: int | None = None) -> Iterator[Array]:
        """So many samples (N, 6) from time 0 on, block by block, in bounded memory.

        Raises:
            InputError: the filter remembers for too long.
        """
        chunk = chunk or max(1024, _BLOCK // self.per)
        for first in range(0, samples, chunk):
            yield self._samples(first, min(chunk, samples - first))

    def stretch(self, first: int, count: int) -> Array:
        """Samples (count, 6) from a number on, which may be negative.

        Raises:
            InputError: the filter remembers for too long.
        """
        block = max(1024, _BLOCK // self.per)
        ends = range(first, first + count, block)
        parts = [self._samples(at, min(block, first + count - at)) for at in ends]
        return np.concatenate([np.empty((0, 6)), *parts])

    @property
    def memory(self) -> tuple[float, float]:
        """How far the filter looks ahead and back, s.

        Raises:
            InputError: too far back.
        """
        weights, ahead = self._kernel
        step = self.interval / self.per
        return ahead * step, (len(weights) - 1 - ahead) * step

    @cached_property
    def per(self) -> int:
        """Fine steps of a sample interval."""
        return min(256, max(8, ceil(2 * self.motion.highest * self.interval / pi)))

    @cached_property
    def _kernel(self) -> tuple[Array, int]:
        """Weights, the newest step's first, and how many of them lie in the future."""
        measured = any(isinstance(stage, Measured) for stage in self.response.stages)
        size, known = _LEAST, np.empty(0, np.complex128)
        while True:
            known = self._response_at(size, known)
            weights = np.fft.irfft(_falling(known), size)
            outer = weights[3 * size // 8 : size - 3 * size // 8]
            if np.abs(outer).sum() <= _TAIL or (measured and size == _MEASURED):
                break
            if size == _MOST:
                seconds = size / self.per * self.interval / 2
                raise InputError(
                    f"sensor.filter: it remembers samples for more than {seconds:.3g} s, which is"
                    " too long, leave the slow stage out"
                )
            size *= 2
        half = size // 2
        weights = np.concatenate((weights[half:], weights[:half]))  # from -half to half - 1
        heavy = np.abs(weights)
        begin = int(np.searchsorted(np.cumsum(heavy), _TAIL))
        end = size - int(np.searchsorted(np.cumsum(heavy[::-1]), _TAIL))
        return weights[begin:end], half - begin

    def _response_at(self, size: int, known: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """F at the frequencies of a transform of so many fine steps; NaN where it has ended.

        Args:
            size: how many.
            known: F at every other one, or nothing.
        """
        found = np.empty(size // 2 + 1, np.complex128)
        found[::2][: len(known)] = known
        for place in range(1 if len(known) else 0, len(found), 2 if len(known) else 1):
            found[place] = self.response.value(2 * pi * place / size * self.per)
        return found

    def _samples(self, first: int, count: int) -> Array:
        """Samples (N, 6) from a number on."""
        weights, ahead = self._kernel
        per, begin = self.per, first * self.per - (len(weights) - 1 - ahead)
        long = count * per if self.kind == "increment" else (count - 1) * per + 1
        steps = self._steps(begin, long + len(weights) - 1)
        size = 1 << (len(steps) - 1).bit_length()
        spectrum = np.fft.rfft(steps, size, axis=0) * np.fft.rfft(weights, size)[:, None]
        passed = np.fft.irfft(spectrum, size, axis=0)[len(weights) - 1 : len(steps)]
        if self.kind == "rate":
            return passed[::per]
        summed: Array = passed.reshape(count, per, 6).sum(axis=1)
        return summed

    def _steps(self, begin: int, count: int) -> Array:
        """Fine increments, or rates at their instants, from a number on, which may be negative."""
        step = self.interval / self.per
        early = min(count, max(0, -begin)) if self.still else 0

        def of(number: int, many: int) -> Array:
            if self.kind == "increment":
                return self.motion.increments(many, step, number)
            return self.motion.rates(many, step, number, filtered=False)

        parts = [np.repeat(of(0, 1), early, axis=0)] if early else []
        if count > early:
            parts.append(of(begin + early, count - early))
        return np.concatenate(parts)


def _falling(response: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """A response up to the Nyquist frequency, held where it ended, and brought down to 0."""
    ended = np.isnan(response)
    held = np.where(ended, response[~ended][-1], response)
    part = np.clip(np.linspace(-1, 1, len(response)), 1e-9, 1 - 1e-9)
    with np.errstate(over="ignore"):
        return np.asarray(held / (1 + np.exp(1 / (1 - part) - 1 / part)))  # smooth


def delivered(
    motion: Motion, design: Design, samples: int, chunk: int | None = None
) -> Iterator[Array]:
    """What a design's sensor would deliver of a motion without noise and without rounding.

    Each sensor is in its place and at its time (`as_felt`), behind the sensor's filter.  A digital
    filter of increments that is clocked with the samples is run as it is (`Passing`), any other by
    its response (`Filtered`).

    Args:
        motion: from time 0 on.
        design: gives kind, rate, filter, lever arms and delay.
        samples: how many in all.
        chunk: samples of a block, at most.

    Yields:
        (N, 6): rad and m/s, or rad/s and m/s², as `Sampled.chunks`.
    """
    felt, passing, response = as_felt(motion, design), Passing(design), design.sensor_response
    kind, interval = design.sensor.kind, design.sample_interval
    if passing.left_out and response is not None:
        yield from Filtered(felt, response, kind, interval).chunks(samples, chunk)
        return
    for block in felt.chunks(kind, samples, interval, chunk):
        yield passing(block)
