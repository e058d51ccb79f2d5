"""The result the core hands over each major interval, and the names its parts go by.

The order of `COLUMNS` is the order of the vectors CSV, of the Verilog result ports and of the
compact core's word stream.
"""

from __future__ import annotations

from typing import NamedTuple

Vec = tuple[int, int, int]

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

COMPONENTS = tuple(f"{vector}_{axis}" for vector in VECTORS for axis in AXES)

COLUMNS = ("major", "status", *COMPONENTS)

STATUS_SHORT_HISTORY = 1
"""Status bit 0: a non-zero tap or weight used in this interval reached before the first sample."""

STATUS_FAULT = 2
"""Status bit 1: a sample of this interval carried `fault`."""


class Result(NamedTuple):
    """One major interval's result: exact integer numerators (DESIGN section 3).

    `major` counts from 0 after reset; `status` is a bit set; each vector is (x, y, z) in the
    sensor's axes.
    """

    major: int
    status: int
    alpha: Vec
    coning_within: Vec
    coning_between: Vec
    nu: Vec
    sculling_within: Vec
    sculling_between: Vec

    def row(self) -> tuple[int, ...]:
        """The integers in the order of `COLUMNS`."""
        return (self.major, self.status, *(c for vector in self[2:] for c in vector))
