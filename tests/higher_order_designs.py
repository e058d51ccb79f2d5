"""Designs of third and fourth order."""

from __future__ import annotations

from typing import Any

from sculler_model.design import Design
from strategies import make_design


def higher(
    name: str,
    samples: int,
    history: int,
    minors: int,
    bits: tuple[int, int],
    order: int,
    family: str = "frequency-taylor",
    hardware: dict[str, Any] | None = None,
    **table: Any,
) -> Design:
    """A design of n samples, p history, M minors, (gyro, accel) bits and this order."""
    return make_design(
        *(name, samples, history, minors, bits, family),
        options={"order": order},
        hardware={"core": "compact"} | (hardware or {}),
        **table,
    )


_ALL = [
    # a single sample: nothing inside a minor interval, all between
    higher("one_sample", 1, 1, 5, (8, 9), 4),
    higher("two_samples", 2, 1, 3, (16, 12), 4, "time-taylor"),
    # one minor interval: nothing between, all inside
    higher("three_alone", 3, 0, 1, (11, 20), 4, "uncompressed"),
    higher("third_order", 4, 0, 5, (24, 24), 3, "uncompressed"),
    higher("fourth_order", 4, 0, 5, (24, 24), 4, "uncompressed"),
    higher("compressed", 5, 2, 2, (13, 8), 3),
    # 32-bit counts, and taps in other phases than the last alone
    higher("wide", 4, 0, 2, (32, 32), 4),
    higher("dense", 3, 0, 4, (11, 20), 4, denominator=7, taps=[[0, -3, 0, 5], [], [1, 0, -2]]),
]

HIGHER_ORDER: dict[str, Design] = {design.name: design for design in _ALL}
"""By name: n 1-5, p 0-2, M 1-5, widths 8-32, all on the compact core."""
