"""Orders 3 and 4 leave less than order 2 in every cone that the samples can show."""

from __future__ import annotations

from math import pi, radians, sin

import pytest

from sculler_model.analysis.orders import HeldConing, left_by_order
from sculler_model.analysis.triple import ConingTurn
from sculler_model.design import Design

DENSE = Design.preset("stim300", family="uncompressed", samples=4)
FLOOR, VELOCITY_FLOOR = 1e-11, 1e-9
"""rad and m/s that counts of 32 bits leave."""


@pytest.mark.deep
@pytest.mark.parametrize("half_angle", [0.1, 1, 10, 45, 90])
def test_no_order_is_worse_than_two(half_angle: float) -> None:
    """Up to a tenth of the sample rate, turning by less than 2 rad in a major interval."""
    compared = 0
    for hertz in (1.003, 10.03, 50.15, 200.6):
        for turn, spin in ((0, 0), (300, 0), (0, 360)):
            motion = ConingTurn(
                radians(half_angle), hertz, radians(turn), radians(5), radians(spin)
            )
            turned = 2 * pi * hertz * sin(radians(half_angle)) * 0.002
            minors = [M for M in (1, 5) if turned * M < 2]
            if not minors:
                continue
            left = {
                (each.minors, each.order): each
                for each in left_by_order(DENSE, HeldConing(motion), minors, 0.2)
            }
            for M in minors:
                for order, much in ((3, 1.1 if hertz < 100 else 1.7), (4, 1.02)):
                    second, other = left[M, 2], left[M, order]
                    assert other.largest <= much * second.largest + FLOOR
                    assert other.velocity is not None
                    assert second.velocity is not None
                    assert other.velocity <= much * second.velocity + VELOCITY_FLOOR
                compared += 1
    assert compared >= 9


def test_errors_fall_with_the_powers_of_what_is_left() -> None:
    """Coning in a turn, at half the interval: T⁵, T⁷ and T⁹ are left of an interval."""
    motion = HeldConing(ConingTurn(radians(20), 10.0, radians(90), radians(30)))
    left = {
        (each.minors, each.order): each.largest
        for each in left_by_order(DENSE, motion, (5, 10), 0.2)
    }
    for order, least, most in ((2, 13, 20), (3, 40, 90), (4, 160, 350)):
        assert least < left[10, order] / left[5, order] < most
