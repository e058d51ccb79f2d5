"""Shapes that the parts share."""

from amaranth import Value, signed
from amaranth.lib import data

from sculler_model.design import Interval


def vector(interval: Interval) -> data.ArrayLayout:
    """Three signed components (x, y, z), each just wide enough for the interval."""
    return data.ArrayLayout(signed(interval.bits), 3)


def is_one_of(value: Value, choices: list[int]) -> Value:
    """1 where the value equals one of the choices."""
    return value.matches(*choices)
