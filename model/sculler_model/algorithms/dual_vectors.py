"""Dual vectors of exact integers: an angle and a velocity that go through the same algebra.

A rigid motion that begins at the body's frame is the exponential of such a pair, and their bracket
is the product below (Clifford's dual numbers, ε² = 0, with angle + ε velocity).  So whatever
is true of rotation vectors in the cross product is true of both in this one: coning becomes
sculling, term by term, at every order (Roscoe's equivalency, Yang Eq. 3-4, for all orders).
"""

from __future__ import annotations

from typing import NamedTuple

from sculler_model.algorithms.integer_vectors import ZERO, Vec, cross, times, vector_sum


class Dual(NamedTuple):
    """An angle and a velocity, both in counts, or products of such.

    Attributes:
        angle: of the gyros.
        velocity: of the accelerometers, or of degree one in them.
    """

    angle: Vec
    velocity: Vec


DUAL_ZERO = Dual(ZERO, ZERO)


def dual_cross(a: Dual, b: Dual) -> Dual:
    """(a + εu) × (b + εv) = a×b + ε (a×v + u×b)."""
    return Dual(
        cross(a.angle, b.angle),
        vector_sum(cross(a.angle, b.velocity), cross(a.velocity, b.angle)),
    )


def dual_times(factor: int, a: Dual) -> Dual:
    """factor * a."""
    return Dual(times(factor, a.angle), times(factor, a.velocity))


def dual_sum(*duals: Dual) -> Dual:
    """Sum of dual vectors."""
    return Dual(
        vector_sum(ZERO, *(a.angle for a in duals)),
        vector_sum(ZERO, *(a.velocity for a in duals)),
    )
