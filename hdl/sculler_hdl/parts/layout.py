"""Shapes that the parts share."""

from amaranth import Value, signed
from amaranth.lib import data

from sculler_model.wordlength import Interval


def vector(interval: Interval) -> data.ArrayLayout:
    """Three signed components (x, y, z), each just wide enough for the interval."""
    return data.ArrayLayout(signed(interval.bits), 3)


FLAGS = data.StructLayout(
    {
        "valid": 1,
        "start": 1,
        "tapped": 1,
        "minor_end": 1,
        "major_end": 1,
        "short": 1,
        "fault": 1,
    }
)
"""What travels down the pipeline beside a sample.

valid: a sample stands here; start: it is the first of its major interval; tapped: its phase has a
non-zero tap row; minor_end, major_end: it is the last of its minor, major interval; short: a tap
or weight in use reached before the first sample; fault: the sensor's own mark.  The other flags
mean nothing where valid is 0, except that both ends are 0 there too.
"""


def is_one_of(value: Value, choices: list[int]) -> Value:
    """1 where the value equals one of the choices."""
    return value.matches(*choices)
