"""The band of frequencies that a fit is made for, and how heavily each counts."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal, getcontext, localcontext
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from math import ceil
from operator import itemgetter

from sculler_model.algorithms.decimals import exact


@dataclass(frozen=True)
class RotaryMode:
    """A rotary isolator mode, |1/(1 - r² + 2iζr)|², r = f/natural (Savage-98 section VI)."""

    natural_hz: Fraction
    damping: Fraction

    def power(self, hertz: Fraction) -> Fraction:
        """Squared response."""
        r = (hertz / self.natural_hz) ** 2
        return 1 / ((1 - r) ** 2 + 4 * self.damping**2 * r)


@dataclass(frozen=True)
class Band:
    """Where, and how heavily, the residual counts.

    Attributes:
        low_hz, high_hz: the band.
        points: (frequency, weight) joined by straight lines; none is weight 1.
        logarithmic: straight on log-log paper, as a vibration profile is drawn.
        mount: an isolator that a vibration passes before it shakes the sensor.
    """

    low_hz: Fraction
    high_hz: Fraction
    points: tuple[tuple[Fraction, Fraction], ...] = ()
    logarithmic: bool = False
    mount: RotaryMode | None = None

    def weight(self, hertz: Fraction) -> Decimal:
        """At a frequency inside the band."""
        weight = Decimal(1)
        at = bisect_left(self.points, hertz, key=itemgetter(0))
        if 0 < at < len(self.points) or (self.points and hertz == self.points[0][0]):
            (low, w0), (high, w1) = self.points[max(at - 1, 0)], self.points[max(at, 1)]
            if self.logarithmic:
                share = exact(hertz / low).ln() / _logarithm(high / low, getcontext().prec)
                weight = exact(w0) * (share * _logarithm(w1 / w0, getcontext().prec)).exp()
            else:
                share = exact((hertz - low) / (high - low))
                weight = exact(w0) + exact(w1 - w0) * share
        return weight * exact(self.mount.power(hertz)) if self.mount else weight

    def panels(self, widest: Fraction) -> Iterator[tuple[Fraction, Fraction]]:
        """The band in pieces no wider than `widest` (Hz) that break where the weight does."""
        inner = [f for f, _ in self.points if self.low_hz < f < self.high_hz]
        if self.mount and self.low_hz < self.mount.natural_hz < self.high_hz:
            inner.append(self.mount.natural_hz)
            widest = min(widest, self.mount.natural_hz * max(self.mount.damping, Fraction(1, 50)))
        edges = [self.low_hz, *sorted(set(inner)), self.high_hz]
        for low, high in pairwise(edges):
            count = ceil((high - low) / widest)
            step = (high - low) / count
            yield from ((low + i * step, low + (i + 1) * step) for i in range(count))


@lru_cache(maxsize=1024)
def _logarithm(value: Fraction, digits: int) -> Decimal:
    """To the digits of the context; a band's pieces ask for the same ones at each point."""
    with localcontext() as context:
        context.prec = digits
        return exact(value).ln()
