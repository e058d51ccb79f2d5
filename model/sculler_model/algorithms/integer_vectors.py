"""Vectors of three exact integers.

`cross` is here for integers, which never round or wrap, and in `frames` for floats and arrays: the
same formula, so that each reads as on its page.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import index
from typing import SupportsIndex

from sculler_model.errors import InputError

Vec = tuple[int, int, int]
"""(x, y, z) in the sensor's axes."""


def whole_numbers(name: str, vector: Sequence[SupportsIndex]) -> Vec:
    """Three whole numbers as Python's own, which cannot wrap; numpy's, of any width, can.

    Raises:
        InputError: it is not three whole numbers.
    """
    try:
        x, y, z = map(index, vector)
    except (TypeError, ValueError):
        raise InputError(
            f"{name}: {str(vector)[:40]} is not allowed, give three whole numbers"
        ) from None
    return (x, y, z)


def cross(a: Vec, b: Vec) -> Vec:
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def vector_sum(*vectors: Vec) -> Vec:
    """Sum of vectors."""
    x, y, z = (sum(component) for component in zip(*vectors, strict=True))
    return (x, y, z)


def times(factor: int, a: Vec) -> Vec:
    """factor * a."""
    return (factor * a[0], factor * a[1], factor * a[2])


ZERO: Vec = (0, 0, 0)
