"""What a study's motion looks like behind the filter of a design's sensor.

The samples are those of `motion.Filtered`.  A filter delays: a sample of slow motion is what the
body did `delay` earlier, and so its stamp is (docs/explanation/navigation.md).  Truths here are
taken so much earlier.  What else a filter does, above all that it attenuates, is left in the error.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import Measured
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.motion import Filtered, Sampled

Array = NDArray[np.float64]


class Felt(Sampled):
    """What perfect sensors feel, as a function of time.

    Args:
        felt: (N, 6) rad/s and m/s² at times (N,), s, negative ones too.
        highest: a bound on the frequencies in it, rad/s.
        gone: its integrals from time 0 on, (N, 6) rad and m/s; by quadrature if left out.
    """

    def __init__(
        self,
        felt: Callable[[Array], Array],
        highest: float,
        gone: Callable[[Array], Array] | None = None,
    ) -> None:
        self._felt, self._highest, self._gone = felt, highest, gone

    def sensed(self, t: Array) -> Array:
        """See `Sampled`."""
        return self._felt(t)

    @property
    def highest(self) -> float:
        """See `Sampled`."""
        return self._highest

    def increments(self, samples: int, interval: float, first: int = 0) -> Array:
        """See `Sampled`."""
        if self._gone is None:
            return super().increments(samples, interval, first)
        number = np.arange(first, first + samples + 1, dtype=np.float64)
        return np.diff(self._gone(number * interval), axis=0)


def known_hz(design: Design) -> float:
    """Up to which frequency a design's samples tell anything, Hz.

    That is the Nyquist limit, or the end of a measured response of the sensor's.
    """
    response, limit = design.sensor_response, design.sensor.sample_rate_hz / 2
    stages = () if response is None else response.stages
    ends = [float(stage.frequencies[-1]) for stage in stages if isinstance(stage, Measured)]
    return min([limit, *ends])


def require_known(design: Design, hertz: float, what: str) -> None:
    """See that the sensor's filter is known at a frequency.

    Args:
        design: its sensor may have a filter.
        hertz: Hz.
        what: has it.

    Raises:
        InputError: a measured response ends below it.
    """
    end = known_hz(design)
    if end < min(hertz, design.sensor.sample_rate_hz / 2):
        raise InputError(
            f"{what}: {hertz:g} Hz is above the end of the sensor's measured response, {end:g} Hz,"
            " give the response to higher frequencies, or a lower frequency"
        )


def delay(design: Design) -> float:
    """How late the samples are, s: how much earlier the truth is that they are held against."""
    response = design.sensor_response
    return 0.0 if response is None else response.delay * design.sample_interval


def reach(design: Design, felt: Felt) -> tuple[int, float]:
    """Where a motion that begins at time 0 shows.

    Returns:
        How many samples before that time know of it, and how long (s) its end is still in them.

    Raises:
        InputError: the sensor's filter remembers for too long.
    """
    if design.sensor_response is None:
        return 0, 0.0
    ahead, back = _behind(design, felt).memory
    return ceil(ahead / design.sample_interval), back


def passed(design: Design, felt: Felt, first: int, count: int) -> Array:
    """Samples (count, 6) behind the filter of a design's sensor, from a number on.

    Args:
        design: its sensor has a filter.
        felt: the motion.
        first: an increment's sample is over ``first T`` to ``(first + 1) T``, a rate's at
            ``first T``; it may be negative.
        count: how many.

    Raises:
        InputError: the filter remembers for too long.
    """
    return _behind(design, felt).stretch(first, count)


def _behind(design: Design, felt: Felt) -> Filtered:
    response = design.sensor_response
    assert response is not None
    return Filtered(felt, response, design.sensor.kind, design.sample_interval, still=False)
