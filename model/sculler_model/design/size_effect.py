"""What an accelerometer feels more for its place: exact coefficients of gyro counts.

At r from the point that is navigated it feels, along its own axis i, over a sample interval T,

    (ω_end - ω_begin)_j t_j / T + ω G ω,    t·ω = (ω × r)_i,    ω G ω = (ω × (ω × r))_i       (S1)

The rate at a sample's ends comes of six samples about each (exact for polynomials of fifth degree),
so their difference of seven:

    60 (ω_end - ω_begin) = s(k+3) - 9 s(k+2) + 45 s(k+1) - 45 s(k-1) + 9 s(k-2) - s(k-3)      (S2)

with s the mean rates.  In the second term ω is the sample's mean rate.  What that leaves out is
the mean of the square of the rate's change within a sample, ω̇ G ω̇ T²/12: a share (ΩT)²/12 of what a
vibration at Ω has.

With s = M (x - b), M the inverse of the gyros' matrix and b their bias, both are polynomials of the
counts x: the first is linear, the second has products, and by the bias terms that are linear, and a
constant.
"""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from sculler_model.design.matrices import Matrix, Row, dot, product, scaled, transposed

REACH = 3
"""Samples on either side that (S2) asks for."""

_CHANGE = {3: 1, 2: -9, 1: 45, -1: -45, -2: 9, -3: -1}


class SizeEffect(NamedTuple):
    """Of one accelerometer, in its counts.

    Attributes:
        linear: of each gyro's count the weights of the sample o samples later, by o.
        products: of the sample's own counts, by the two gyros, the first not after the second.
        constant: besides.
    """

    linear: dict[int, dict[int, Fraction]]
    products: dict[tuple[int, int], Fraction]
    constant: Fraction


def size_effect(
    axis: int, arm: Row, inverse: Matrix, bias: Row, units: tuple[Fraction, Fraction], T: Fraction
) -> SizeEffect:
    """(S1) of one accelerometer as a polynomial of counts.

    Args:
        axis: which it is, 0 to 2.
        arm: r, m.
        inverse, bias: M and b of the gyros, b in counts.
        units: what a count of a gyro and of an accelerometer is worth, rad/s and m/s².
        T: the sample interval, s.
    """
    gyro, accel = units
    after, last = (axis + 1) % 3, (axis + 2) % 3
    turned = [Fraction(0)] * 3  # t
    turned[after], turned[last] = arm[last], -arm[after]
    change = [dot(turned, column) * gyro / accel / T for column in transposed(inverse)]

    form = [[-arm[axis] * (i == j) for j in range(3)] for i in range(3)]  # G
    for j in range(3):
        form[axis][j] += arm[j] / 2
        form[j][axis] += arm[j] / 2
    x, y, z = ((row[0], row[1], row[2]) for row in form)
    square = product(transposed(inverse), product((x, y, z), inverse))
    square = scaled(square, [gyro * gyro / accel] * 3)
    return SizeEffect(
        {
            j: {o: change[j] * w / 60 for o, w in _CHANGE.items()} | {0: -2 * dot(square[j], bias)}
            for j in range(3)
        },
        {(i, j): square[i][j] * (1 if i == j else 2) for i in range(3) for j in range(i, 3)},
        sum((bias[j] * dot(square[j], bias) for j in range(3)), Fraction(0)),
    )
