"""Order 4 leaves less than order 2 in every cone that the samples can show."""

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
def test_order_four_is_never_worse_than_two(half_angle: float) -> None:
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
                second, fourth = left[M, 2], left[M, 4]
                assert fourth.largest <= 1.02 * second.largest + FLOOR
                assert fourth.velocity is not None
                assert second.velocity is not None
                assert fourth.velocity <= 1.02 * second.velocity + VELOCITY_FLOOR
                compared += 1
    assert compared >= 9


def test_errors_fall_with_the_fourth_and_the_sixth_power_of_the_interval() -> None:
    """Coning in a turn, at half the interval: 16 and 64 times less."""
    motion = HeldConing(ConingTurn(radians(20), 10.0, radians(90), radians(30)))
    left = {
        (each.minors, each.order): each.largest
        for each in left_by_order(DENSE, motion, (5, 10), 0.2)
    }
    assert 13 < left[10, 2] / left[5, 2] < 20
    assert 50 < left[10, 4] / left[5, 4] < 85
