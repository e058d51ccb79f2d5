"""The instants of samples and of major intervals: the one definition, for both kinds of sensor.

All instants are on the log's own clock.  With h the sample interval, t0 the log's zero (0 where the
log has no stamps) and samples and intervals counted from 0,

    increment sensor    sample k covers (t0 + k h, t0 + (k+1) h]; its stamp is the END of its step
    rate sensor         sample k is the rate at the instant t0 + k h, which is its stamp

A major interval ends where what its sums stand for ends: half its last minor interval after the
weights' centre of gravity.  For increments, and for rates with symmetric weights over both ends of
the interval (Newton-Cotes, Zeng Eq. 15), that is the stamp of the last sample.  Rates that are just
added up (weights 1 for n samples) stand for half a sample on either side of their instants, so
there the interval ends half a sample after the last stamp.

    interval i ends at    t0 + (i+1) n M h              increments
                          t0 + ((i+1) n M - 1) h        rates, Newton-Cotes weights
                          t0 + ((i+1) n M - 1/2) h      rates, plain sums

Compensation that aligns accelerometers with gyros works on samples of before: an interval then ends
`CompensationPlan.delay` samples earlier than that.  A filter in the sensor delays what it senses;
that belongs to the stamps and is not in here.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design


def sample_stamp(design: Design, sample: int) -> float:
    """The stamp (s) of a sample, counted from 0, on a clock that began with the log (t0 = 0).

    Args:
        design: gives kind and rate.
        sample: its number.
    """
    return (sample + _stamp_of_first(design)) / design.sensor.sample_rate_hz


def end_after_stamp(design: Design) -> float:
    """From the stamp of a major interval's last sample to the interval's end, s."""
    return float(_end_after_stamp(design)) / design.sensor.sample_rate_hz


def interval_end(design: Design, interval: int) -> float:
    """The end (s) of a major interval, counted from 0, on a clock that began with the log (t0 = 0).

    Args:
        design: the design.
        interval: its number; -1 gives the beginning of the first one.
    """
    return float(interval_ends(design, np.array([interval]))[0])


def interval_ends(design: Design, intervals: NDArray[np.int64]) -> NDArray[np.float64]:
    """The ends (s) of many major intervals, as `interval_end`.

    Args:
        design: the design.
        intervals: (R,) their numbers.

    Returns:
        (R,) s.
    """
    lead = float(_stamp_of_first(design) - 1 + _end_after_stamp(design))
    samples = (np.asarray(intervals, np.int64) + 1) * design.samples_per_major
    return (samples + lead).astype(np.float64) / design.sensor.sample_rate_hz


def _stamp_of_first(design: Design) -> int:
    """In samples."""
    return 1 if design.sensor.kind == "increment" else 0


def _end_after_stamp(design: Design) -> Fraction:
    """In samples."""
    weights = design.table.weights
    n, total = design.algorithm.samples, sum(weights)
    # the weights' centre before the last sample; what adds up to nothing has none
    moment = sum(d * w for d, w in enumerate(weights))
    centre = Fraction(moment, total) if total else Fraction(n - 1, 2)
    # an increment stands for the middle of its step, half a sample before its stamp
    middle = Fraction(-1, 2) if design.sensor.kind == "increment" else Fraction(0)
    plan = design.compensation_plan
    behind = 0 if plan is None else plan.delay
    return middle - centre + Fraction(n, 2) - behind
