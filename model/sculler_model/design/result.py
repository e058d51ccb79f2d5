"""The result the core hands over each major interval, and the names its parts go by.

Every design hands over the six `VECTORS`; after them one with `position = "high-resolution"` three
more, one with `order = 3` two more, and one with `order = 4` four.  `Design.vectors`,
`.components` and `.columns` say what a design has; the order of its columns is the order of the
vectors CSV, of the Verilog result ports and of the word stream.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from sculler_model.algorithms import Vec

AXES = ("x", "y", "z")

VECTORS = (
    "alpha",
    "coning_within",
    "coning_between",
    "nu",
    "sculling_within",
    "sculling_between",
)
"""The six accumulated vectors (also the field names of `WordLengths` that give their widths)."""

HIGH_RESOLUTION_VECTORS = ("s_alpha", "s_nu", "scrolling")
"""What `position = "high-resolution"` adds (fields of `WordLengths` too)."""

THIRD_ORDER_VECTORS = ("coning_third", "sculling_third")
"""What `order = 3` and `order = 4` add (fields of `WordLengths` too)."""

FOURTH_ORDER_VECTORS = ("coning_fourth", "sculling_fourth")
"""What `order = 4` adds after those."""


def components_of(vectors: Sequence[str]) -> tuple[str, ...]:
    """The names of all components of some vectors."""
    return tuple(f"{vector}_{axis}" for vector in vectors for axis in AXES)


def columns_of(vectors: Sequence[str]) -> tuple[str, ...]:
    """The columns of a result that consists of some vectors."""
    return ("major", "status", *components_of(vectors))


COMPONENTS = components_of(VECTORS)
"""The components of the six vectors."""

COLUMNS = columns_of(VECTORS)
"""The columns of a design without high-resolution position, the first ones of any design."""

HIGH_RESOLUTION_COLUMNS = columns_of((*VECTORS, *HIGH_RESOLUTION_VECTORS))
"""The columns of a design with it."""

THIRD_ORDER_COLUMNS = columns_of((*VECTORS, *THIRD_ORDER_VECTORS))
"""The columns of a design with `order = 3`."""

FOURTH_ORDER_COLUMNS = columns_of((*VECTORS, *THIRD_ORDER_VECTORS, *FOURTH_ORDER_VECTORS))
"""The columns of a design with `order = 4`."""

EVERY_COLUMNS = (COLUMNS, THIRD_ORDER_COLUMNS, HIGH_RESOLUTION_COLUMNS, FOURTH_ORDER_COLUMNS)
"""All that results can have, the fewest first; no two are of one length."""

STATUS_SHORT_HISTORY = 1
"""Status bit 0: what this interval used reached before the first sample: a non-zero tap or weight,
or high-resolution position, which uses the sample before the interval."""

STATUS_FAULT = 2
"""Status bit 1: a sample of this interval carried `fault`."""

STATUS_RAIL = 4
"""Status bit 2: a count of this interval stood at its rail, the most negative or the most positive
value of its width, so what the sensor felt may have been more."""

STATUS_LOST = 8
"""Status bit 3: a sample was offered and not taken since the last result's last sample was taken,
so this interval is longer than its samples say."""

STATUS_UPSET = 16
"""Status bit 4, of hardened cores: an upset was seen (`hardware.hardening`); the result may be
wrong."""

STATUS_BITS = 4
"""Width of the status of a core that is not hardened; `Design.status_bits` is that of a design."""


class Result(NamedTuple):
    """One major interval's result: exact integer numerators (docs/explanation/theory.md).

    Each vector is (x, y, z) in the sensor's axes.  `s_alpha`, `s_nu` and `scrolling` are there
    where the design has high-resolution position (`algorithms.scrolling`), those of third and
    fourth order where it has that `order` (`algorithms.higher_order`), else None.

    Attributes:
        major: counts from 0 after reset.
        status: a bit set, see the `STATUS_` names.
        alpha, nu: sums of gyro and accelerometer counts, over the table's `sum_denominator` Dw.
        coning_within, sculling_within: over its `denominator` Dc, counts².
        coning_between, sculling_between: over 2 Dw², counts².
        s_alpha, s_nu: running integrals of alpha and nu, over 12, counts times samples.
        scrolling: over 4320, counts² times samples.
        coning_third, sculling_third: over `Composition.third`, counts³.
        coning_fourth, sculling_fourth: over `Composition.fourth`, counts⁴.
    """

    major: int
    status: int
    alpha: Vec
    coning_within: Vec
    coning_between: Vec
    nu: Vec
    sculling_within: Vec
    sculling_between: Vec
    s_alpha: Vec | None = None
    s_nu: Vec | None = None
    scrolling: Vec | None = None
    coning_third: Vec | None = None
    sculling_third: Vec | None = None
    coning_fourth: Vec | None = None
    sculling_fourth: Vec | None = None

    def row(self) -> tuple[int, ...]:
        """The integers in the order of the design's columns."""
        vectors = (vector for vector in self[2:] if vector is not None)
        return (self.major, self.status, *(c for vector in vectors for c in vector))
