"""Samples between samples: Lagrange's polynomial as exact rational taps."""

from __future__ import annotations

from fractions import Fraction
from math import floor, prod


def fractional_delay(advance: Fraction, taps: int) -> dict[int, Fraction]:
    """The sample at `advance` as a sum of weighted samples at whole numbers.

        x(advance) = Σ w_o x(o),    w_o = Π_{q≠o} (advance - q)/(o - q)

    over as many o and q about `advance`, half of them on either side.  The weights sum to 1, and
    polynomials of a degree below `taps` come out exactly.  Increments and rates alike: of
    increments the running sum is interpolated, which is the same sum of neighbours.

    Args:
        advance: in sample intervals, to either side.
        taps: how many samples, an even number; where `advance` is whole, it is one.

    Returns:
        Weights that are not zero, by o.
    """
    whole = floor(advance)
    share = advance - whole
    if not share:
        return {whole: Fraction(1)}
    offsets = range(1 - taps // 2, 1 + taps // 2)
    return {
        whole + o: prod((Fraction(share - q, o - q) for q in offsets if q != o), start=Fraction(1))
        for o in offsets
    }
