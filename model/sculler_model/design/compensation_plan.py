"""What stands before the core where a design has [compensation], in exact integers.

    y_i(t) = Σ factor · x_source(t - lag) + Σ factor · x_first(t - lag) x_second(t - lag) + offset_i

(C1) with x the six counts of the sensor, gyro x, y, z and then accelerometer x, y, z, and y the six
samples that the core takes.  A count of y is worth 1/D of a count of x, so everything that is
linear is in the factors: matrices, g-sensitivity, the filter of a delay and what an angular
acceleration does at a lever arm; the products are of gyros, for what turning does there.  Counts
before the first one after reset are zero, as in the core.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

from sculler_model.design.interval import ZERO_RANGE, Interval, range_of_sum

SOURCES = 6
"""Counts of a sample, and outputs."""


class Term(NamedTuple):
    """A count times an integer.

    Attributes:
        source: which count, 0 to 5: gyro x, y, z, accelerometer x, y, z.
        lag: how many samples before the newest.
        factor: over D; not 0.
    """

    source: int
    lag: int
    factor: int


class ProductTerm(NamedTuple):
    """The product of two counts times an integer.

    Attributes:
        first, second: which counts, 0 to 2, gyros; the same twice for a square.
        lag: how many samples before the newest.
        factor: over D; not 0.
    """

    first: int
    second: int
    lag: int
    factor: int


@dataclass(frozen=True)
class CompensationPlan:
    """Six integer sums over one denominator, or over one for each sensor.

    Attributes:
        denominator: D, of the gyros' outputs.
        accel_denominator: of the accelerometers'.
        outputs: the terms of each output.
        offsets: what each has besides, over D.
        delay: how many samples the outputs stand behind the newest count.
        products: the products of each output.
    """

    denominator: int
    accel_denominator: int
    outputs: tuple[tuple[Term, ...], ...]
    offsets: tuple[int, ...]
    delay: int
    products: tuple[tuple[ProductTerm, ...], ...] = ((),) * SOURCES

    @property
    def denominators(self) -> tuple[int, int]:
        """Of gyros' and of accelerometers' outputs."""
        return self.denominator, self.accel_denominator

    @property
    def has_products(self) -> bool:
        """Whether counts are multiplied with each other."""
        return any(self.products)

    @property
    def reach(self) -> int:
        """How many samples before the newest the oldest one lies that is used."""
        single = (term.lag for terms in self.outputs for term in terms)
        double = (term.lag for terms in self.products for term in terms)
        return max(chain(single, double), default=0)

    def ranges(self, gyro: Interval, accel: Interval) -> tuple[Interval, Interval]:
        """Of the outputs for gyros and for accelerometers, over all sequences of counts, and 0.

        A sum on the way to an output, with or without its offset, lies between the ends too.

        Args:
            gyro, accel: of a count.
        """
        spans = []
        square = Interval(0, max(gyro.lo**2, gyro.hi**2))
        for terms, products, offset in zip(self.outputs, self.products, self.offsets, strict=True):
            total = range_of_sum(
                (gyro if term.source < SOURCES // 2 else accel).scaled(term.factor)
                for term in terms
            ) + range_of_sum(
                (square if term.first == term.second else gyro * gyro).scaled(term.factor)
                for term in products
            )
            spans.append(total | total + Interval(offset, offset) | ZERO_RANGE)
        first, second = spans[: SOURCES // 2], spans[SOURCES // 2 :]
        return first[0] | first[1] | first[2], second[0] | second[1] | second[2]

    def as_json(self) -> dict[str, object]:
        """As plain data: D, the delay in samples; of each output its terms, products and offset."""
        return {
            "denominator": self.denominator,
            "accel_denominator": self.accel_denominator,
            "delay_samples": self.delay,
            "terms": [[list(term) for term in terms] for terms in self.outputs],
            "products": [[list(term) for term in terms] for terms in self.products],
            "offsets": list(self.offsets),
        }
